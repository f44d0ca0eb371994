#include "renderer/air/volume_lighting.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <unordered_set>
#include <vector>

#include "core/color.h"
#include "core/numeric.h"
#include "parallel/loops.h"
#include "renderer/air/lamp_ways.h"
#include "renderer/air/scattering_system.h"
#include "renderer/air/smooth_air.h"
#include "renderer/base/stream.h"
#include "renderer/lights/light_points.h"

namespace render2mpeg::renderer {
namespace {

constexpr float never = std::numeric_limits<float>::infinity();

/// Samples of a lamp's way and cells of all other light that a volume has at most, about: their spacing is the least
/// power of two of voxels. chosen: half a million ways, a second of CPU; 6,000 cells, whose equations take 60 MB.
constexpr std::size_t most_ways = std::size_t{1} << 19, most_ambient_cells = 6000;

/// Lamps that have ways of their own: those that send most to the middle of the volume. chosen: 16. Others are looked
/// for at cells, and count as from all sides.
constexpr std::size_t most_lamps = 16;

/// Directions that a cell looks along. chosen: 64.
constexpr std::size_t cell_directions = 64;

/// Rays end where less than this is left.
constexpr float least_left = 1e-5f;

/// Steps between cells, in cells.
constexpr float step_of_cell = 0.5f;

/// Calls visit(place) from low to high until it returns true; whether it did.
template <class Visit>
bool any_of_box(glm::ivec3 low, glm::ivec3 high, Visit visit) {
    for (int z = low.z; z <= high.z; ++z)
        for (int y = low.y; y <= high.y; ++y)
            for (int x = low.x; x <= high.x; ++x)
                if (visit(glm::ivec3(x, y, z))) return true;
    return false;
}

/// Whether interpolation within the medium asks for a sample.
bool is_needed(const VolumeField& field, glm::ivec3 sample, int spacing) {
    const glm::ivec3 low = (sample - 1) * spacing, high = (sample + 1) * spacing;
    return any_of_box(low >> 3, (high - 1) >> 3, [&](glm::ivec3 b) { return field.range(b).any; }) &&
           any_of_box(low, high, [&](glm::ivec3 v) { return field.holds(v); });
}

/// Samples about these bricks, about where several lie in a brick, else the corners of all boxes that hold any.
double samples_about(const std::vector<glm::ivec3>& bricks, int spacing) {
    if (spacing < 8) return static_cast<double>(bricks.size()) * std::pow(8.0 / spacing, 3);
    std::unordered_set<std::uint64_t> corners;
    const int side = spacing / 8;
    const auto floored = [&](int brick) { return (brick - ((brick % side) + side) % side) / side; };
    for (const glm::ivec3& brick : bricks)
        for (int c = 0; c < 8; ++c) {
            std::uint64_t key = 0;
            for (int k = 0; k < 3; ++k)
                key = key << 21 | (static_cast<std::uint64_t>(floored(brick[k]) + (c >> k & 1)) & 0x1fffff);
            corners.insert(key);
        }
    return static_cast<double>(corners.size());
}

int spacing_for(const VolumeField& field, std::size_t most) {
    std::vector<glm::ivec3> bricks;
    field.each_brick([&](glm::ivec3 brick) { bricks.push_back(brick); });
    int spacing = 1;
    constexpr int widest = 1 << 20;
    while (spacing < widest && samples_about(bricks, spacing) > static_cast<double>(most)) spacing *= 2;
    return spacing;
}

/// Samples of a lattice that are needed.
template <class T>
std::vector<glm::ivec3> samples_of(const core::SparseGrid<T>& lattice, const VolumeField& field, int spacing) {
    using Grid = core::SparseGrid<T>;
    std::vector<glm::ivec3> bricks, all;
    lattice.each([&](glm::ivec3 brick, const typename Grid::Brick&) { bricks.push_back(brick); });
    std::vector<std::vector<glm::ivec3>> samples(bricks.size());
    parallel::for_each(bricks.size(), [&](std::size_t b) {
        for (int k = 0; k < Grid::brick_voxels; ++k)
            if (const glm::ivec3 sample = Grid::voxel(bricks[b], k); is_needed(field, sample, spacing))
                samples[b].push_back(sample);
    });
    for (const std::vector<glm::ivec3>& of_brick : samples) all.insert(all.end(), of_brick.begin(), of_brick.end());
    return all;
}

/// Samples of all light but the lamps', and the mean medium about each.
struct Cells {
    int spacing = 1;
    std::size_t first = 0;                  ///< number of the first among those of all volumes
    core::SparseGrid<std::int32_t> number;  ///< of a sample, from 1 in each volume; 0: none
    std::vector<glm::ivec3> samples;
    std::vector<float> extinction;  ///< by similarity, luminance, by world unit
    std::vector<glm::vec3> emission, albedo;

    /// Calls visit(cell, weight) for the cells about a place of the lattice.
    template <class Visit>
    void about(glm::vec3 place, Visit visit) const {
        const glm::vec3 floor = glm::floor(place), t = place - floor;
        for (int c = 0; c < 8; ++c) {
            const glm::ivec3 turn(c & 1, c >> 1 & 1, c >> 2);
            const std::int32_t cell = number.at(glm::ivec3(floor) + turn);
            const glm::vec3 w = glm::mix(1.0f - t, t, glm::vec3(turn));
            if (cell > 0) visit(static_cast<std::size_t>(cell - 1), w.x * w.y * w.z);
        }
    }
};

/// Light of one volume among all of the air: `find_ways` of all comes first, then `own_light` of all.
class OneVolume {
  public:
    OneVolume(const AirInstant& instant, std::size_t index)
        : instant_(instant),
          air_(*instant.posed_scene.air()),
          index_(index),
          medium_(air_.volumes()[index]),
          field_(medium_.field()) {}

    /// Cells, numbered from `first` on. Returns how many.
    std::size_t find_cells(std::size_t first);
    /// Ways to those lamps that send most.
    void find_ways(std::span<const LightPoint> lamps);
    /// Writes mean radiance at its cells to `own`, of all volumes' cells, that nothing in a medium has scattered but
    /// lamps' light once, and the equations of the rest: all of it on the same rays, so that what leaves and what comes
    /// sum up to 1.
    void own_light(std::span<const OneVolume> all, const SmoothAirLight& smooth, std::vector<glm::vec3>& own,
                   ScatteringSystem& system);
    /// With the light of all volumes' cells. Adds its rays to `rays`.
    VolumeLight with(const std::vector<glm::vec3>& light, std::uint64_t& rays);

    bool scatters() const { return medium_.scatters(); }
    const Cells& cells() const { return cells_; }

  private:
    struct Looks;
    struct Shares;
    struct Span;

    float strength(const LightPoint& lamp) const;
    glm::vec3 place_of(std::size_t cell) const {
        return medium_.to_world(static_cast<float>(cells_.spacing) * glm::vec3(cells_.samples[cell]));
    }
    /// Mean radiance of lamps with ways.
    glm::vec3 lamps_at(std::size_t cell) const {
        return light_.lamps_mean(medium_, static_cast<float>(cells_.spacing) * glm::vec3(cells_.samples[cell]));
    }
    Looks look_from();
    Span span_of(const RayQuery& ray, float end) const;
    glm::vec3 along(std::span<const OneVolume> all, const RayQuery& ray, const FinalGather::Seen& seen,
                    Shares& shares) const;

    const AirInstant& instant_;
    const Air& air_;
    std::size_t index_;
    const VolumeMedium& medium_;
    const VolumeField& field_;
    Cells cells_;
    std::vector<LightPoint> other_lamps_;  ///< without ways
    VolumeLight light_;
    std::uint64_t rays_ = 0;
};

/// What cells see at the ends of their rays.
struct OneVolume::Looks {
    std::vector<RayQuery> rays;
    std::vector<FinalGather::Seen> seen;
};

/// Luminance of irradiance at the middle, if nothing is in the way.
float OneVolume::strength(const LightPoint& lamp) const {
    if (lamp.is_far()) return core::luminance(lamp.intensity);
    const glm::vec3 middle = medium_.to_world(8.0f * (glm::vec3(field_.low()) + 0.5f * glm::vec3(field_.size())));
    const glm::vec3 way = middle - lamp.position;
    return core::divide_or(core::luminance(lamp.intensity), glm::dot(way, way), never);
}

void OneVolume::find_ways(std::span<const LightPoint> lamps) {
    if (!scatters() || lamps.empty()) return;
    std::vector<LightPoint> nearest(lamps.begin(), lamps.end());
    std::stable_sort(nearest.begin(), nearest.end(),
                     [&](const LightPoint& a, const LightPoint& b) { return strength(a) > strength(b); });
    if (nearest.size() > most_lamps) {
        other_lamps_.assign(nearest.begin() + most_lamps, nearest.end());
        nearest.resize(most_lamps);
    }
    light_.lamp_spacing = spacing_for(field_, most_ways);
    const auto empty = VolumeLight::lattice<LampWay>(field_, light_.lamp_spacing);
    const std::vector<glm::ivec3> samples = samples_of(empty, field_, light_.lamp_spacing);
    for (const LightPoint& lamp : nearest) {
        VolumeLamp found{lamp, empty};
        parallel::for_ranges(samples.size(), 64, [&](std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i)
                found.ways.set(samples[i], way_of_light(instant_, lamp,
                                                        medium_.to_world(static_cast<float>(light_.lamp_spacing) *
                                                                         glm::vec3(samples[i]))));
        });
        rays_ += samples.size();
        light_.lamps.push_back(std::move(found));
    }
}

std::size_t OneVolume::find_cells(std::size_t first) {
    const int spacing = spacing_for(field_, most_ambient_cells);
    Cells& cells = cells_;
    cells.spacing = spacing;
    cells.first = first;
    cells.number = VolumeLight::lattice<std::int32_t>(field_, spacing);
    cells.samples = samples_of(cells.number, field_, spacing);
    const std::size_t count = cells.samples.size();
    for (std::size_t i = 0; i < count; ++i) cells.number.set(cells.samples[i], static_cast<std::int32_t>(i + 1));
    cells.extinction.assign(count, 0);
    cells.emission.assign(count, glm::vec3(0));
    cells.albedo.assign(count, glm::vec3(0));
    // Voxels share themselves out among the cells about them.
    const float inverse = 1.0f / static_cast<float>(spacing), part = inverse * inverse * inverse;
    const float g = medium_.anisotropy();
    field_.each_brick([&](glm::ivec3 brick) {
        for (int k = 0; k < core::SparseGrid<float>::brick_voxels; ++k) {
            const glm::vec3 place(core::SparseGrid<float>::voxel(brick, k));
            const MediumPoint point = medium_.at(place);
            const float taken = core::luminance(point.extinction) * similar(g, core::luminance(medium_.albedo(place)));
            if (!(taken > 0.0f) && point.emission == glm::vec3(0)) continue;
            cells.about(inverse * place, [&](std::size_t cell, float weight) {
                cells.extinction[cell] += part * weight * taken;
                cells.emission[cell] += part * weight * point.emission;
            });
        }
    });
    for (std::size_t i = 0; i < count; ++i) {
        const glm::vec3 albedo = medium_.albedo(static_cast<float>(spacing) * glm::vec3(cells.samples[i]));
        const float forward = std::max(g, 0.0f);
        cells.albedo[i] = albedo * (1.0f - forward) / glm::max(1.0f - forward * albedo, glm::vec3(1e-6f));
    }
    return count;
}

/// Rays of all cells.
OneVolume::Looks OneVolume::look_from() {
    Looks looks;
    looks.rays.reserve(cells_.samples.size() * cell_directions);
    const Stream numbers(Purpose::rays_of_volumes, {.index = index_});
    for (std::size_t cell = 0; cell < cells_.samples.size(); ++cell) {
        const glm::ivec3 sample = cells_.samples[cell];
        const Stream own = numbers
                               .at(static_cast<std::uint64_t>(static_cast<std::uint32_t>(sample.x)) << 32 |
                                   static_cast<std::uint32_t>(sample.y))
                               .at(static_cast<std::uint32_t>(sample.z));
        add_even_rays(place_of(cell), cell_directions, own, looks.rays);
    }
    looks.seen = seen_at_ends(instant_, looks.rays, numbers, true);
    rays_ += looks.rays.size();
    return looks;
}

/// Shares of a cell's rays that others scatter to it.
struct OneVolume::Shares {
    /// A volume about a place of the ray.
    struct Medium {
        const Span* span;
        float whole, extinction;
        glm::vec3 albedo;
    };
    std::vector<Medium> medium;  ///< scratch
    ScatteringSystem::Sums cells;
};

/// Part of a ray that lies within a volume's lattice, and how it goes there.
struct OneVolume::Span {
    const OneVolume* volume;
    float in, out;
    glm::vec3 from, turn;  ///< at distance 0, and by unit of way, lattice

    bool meets() const { return in < out; }
    glm::vec3 place(float distance) const { return from + distance * turn; }
    float step() const { return step_of_cell / glm::length(turn); }
};

OneVolume::Span OneVolume::span_of(const RayQuery& ray, float end) const {
    const auto spacing = static_cast<float>(cells_.spacing);
    const glm::vec3 low = glm::vec3(8 * cells_.number.low()),
                    high = glm::vec3(8 * (cells_.number.low() + cells_.number.size()) - 1);
    Span span{this, 0, cells_.samples.empty() ? 0.0f : end, medium_.to_index(ray.origin) / spacing,
              medium_.vector_to_index(ray.direction) / spacing};
    for (int c = 0; c < 3; ++c) {
        const float turn = span.turn[c];
        if (turn == 0.0f) {
            if (span.from[c] < low[c] || span.from[c] > high[c]) span.out = 0;
            continue;
        }
        const float a = (low[c] - span.from[c]) / turn, b = (high[c] - span.from[c]) / turn;
        span.in = std::max(span.in, std::min(a, b));
        span.out = std::min(span.out, std::max(a, b));
    }
    return span;
}

/// Radiance along a ray from a cell that nothing in a medium has scattered but lamps' light once.
glm::vec3 OneVolume::along(std::span<const OneVolume> all, const RayQuery& ray, const FinalGather::Seen& seen,
                           Shares& shares) const {
    std::vector<Span> spans;
    std::vector<float> borders;
    for (const OneVolume& volume : all)
        if (const Span span = volume.span_of(ray, seen.distance); span.meets()) {
            spans.push_back(span);
            borders.insert(borders.end(), {span.in, span.out});
        }
    std::sort(borders.begin(), borders.end());
    glm::vec3 light(0);
    float left = 1;
    for (std::size_t k = 1; k < borders.size(); ++k) {
        const float begin = borders[k - 1], way = borders[k] - begin;
        float step = never;
        for (const Span& s : spans)
            if (s.in <= begin && s.out > begin) step = std::min(step, s.step());
        if (std::isinf(step)) continue;
        const auto steps = static_cast<int>(std::ceil(std::min(way / step, 1e5f)));
        const float length = steps > 0 ? way / static_cast<float>(steps) : 0.0f;
        for (int i = 0; i < steps && left > 0.0f; ++i) {
            const float at = begin + (static_cast<float>(i) + 0.5f) * length;
            shares.medium.clear();
            float extinction = 0;
            glm::vec3 emission(0);
            for (const Span& s : spans)
                if (s.in <= begin && s.out > begin) {
                    const Cells& cells = s.volume->cells_;
                    Shares::Medium m{&s, 0, 0, glm::vec3(0)};
                    cells.about(s.place(at), [&](std::size_t c, float w) {
                        m.whole += w;
                        m.extinction += w * cells.extinction[c];
                        m.albedo += w * cells.albedo[c];
                        emission += w * cells.emission[c];
                    });
                    extinction += m.extinction;
                    shares.medium.push_back(m);
                }
            // What is left in the end is scattered there as well: nothing gets lost.
            const float taken = length * extinction;
            const float lost = left * std::exp(-taken) > least_left ? -std::expm1(-taken) : 1.0f;
            light += left * (taken > 1e-4f ? lost / extinction : length) * emission;
            for (const Shares::Medium& m : shares.medium) {
                if (!(m.extinction > 0.0f)) continue;
                const OneVolume& v = *m.span->volume;
                const float share = left * lost * (m.extinction / extinction) / m.whole;
                const glm::vec3 place = m.span->place(at);
                light +=
                    share * m.albedo * v.light_.lamps_mean(v.medium_, static_cast<float>(v.cells_.spacing) * place);
                v.cells_.about(place, [&](std::size_t c, float w) { shares.cells.add(v.cells_.first + c, share * w); });
            }
            left *= 1.0f - lost;
        }
    }
    return light + left * std::exp(-air_.fog_of_light(ray.origin, ray.direction, seen.distance)) * seen.light;
}

void OneVolume::own_light(std::span<const OneVolume> all, const SmoothAirLight& smooth, std::vector<glm::vec3>& own,
                          ScatteringSystem& system) {
    if (!scatters()) return;
    constexpr float part = 1.0f / static_cast<float>(cell_directions);
    const std::size_t count = cells_.samples.size();
    const Looks looks = look_from();
    std::vector<glm::vec3> places;
    for (std::size_t cell = 0; cell < count; ++cell) places.push_back(place_of(cell));
    std::vector<float> known(count);
    parallel::for_ranges(count, 32, [&](std::size_t first, std::size_t last) {
        Shares shares{{}, ScatteringSystem::Sums(own.size())};
        for (std::size_t cell = first; cell < last; ++cell) {
            glm::vec3 light = mean_of_lamps(instant_, other_lamps_, places[cell], medium_.voxel());
            for (std::size_t ray = cell * cell_directions; ray < (cell + 1) * cell_directions; ++ray)
                light += part * along(all, looks.rays[ray], looks.seen[ray], shares);
            shares.cells.move_to(system.row(cells_.first + cell), part);
            own[cells_.first + cell] = core::is_finite(light) ? light : glm::vec3(0);
            known[cell] = core::luminance(own[cells_.first + cell] + lamps_at(cell));
        }
    });
    rays_ += smooth.add(instant_.posed_scene.tracer(), places, known, std::span(own).subspan(cells_.first, count));
}

VolumeLight OneVolume::with(const std::vector<glm::vec3>& light, std::uint64_t& rays) {
    if (!scatters()) return {};
    light_.ambient_spacing = cells_.spacing;
    light_.ambient = VolumeLight::lattice<glm::vec3>(field_, cells_.spacing);
    for (std::size_t i = 0; i < cells_.samples.size(); ++i)
        light_.ambient.set(cells_.samples[i], light[cells_.first + i]);
    rays += rays_;
    return std::move(light_);
}

}  // namespace

std::vector<VolumeLight> light_within_volumes(const AirInstant& instant, std::uint64_t& rays) {
    const std::vector<LightPoint> points = points_beyond_rays(instant);
    std::vector<LightPoint> lamps = air_lamps(points, instant.light_trees);
    // Cells see flames themselves.
    std::erase_if(lamps, [](const LightPoint& lamp) { return lamp.is_of_flame(); });
    const SmoothAirLight smooth(instant.light_trees, points, true);
    std::vector<OneVolume> volumes;
    for (std::size_t i = 0; i < instant.posed_scene.air()->volumes().size(); ++i) volumes.emplace_back(instant, i);
    std::vector<VolumeLight> lights(volumes.size());
    if (std::none_of(volumes.begin(), volumes.end(), [](const OneVolume& v) { return v.scatters(); })) return lights;
    std::size_t count = 0;
    for (OneVolume& volume : volumes) {
        volume.find_ways(lamps);
        count += volume.find_cells(count);
    }
    std::vector<glm::vec3> own(count, glm::vec3(0)), albedo;
    ScatteringSystem system(count);
    for (OneVolume& volume : volumes) {
        volume.own_light(volumes, smooth, own, system);
        albedo.insert(albedo.end(), volume.cells().albedo.begin(), volume.cells().albedo.end());
    }
    const std::vector<glm::vec3> all = system.solve(own, albedo);
    for (std::size_t i = 0; i < volumes.size(); ++i) lights[i] = volumes[i].with(all, rays);
    return lights;
}

}  // namespace render2mpeg::renderer
