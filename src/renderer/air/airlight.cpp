#include "renderer/air/airlight.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "core/color.h"
#include "core/numeric.h"
#include "parallel/loops.h"
#include "renderer/air/ambient_columns.h"
#include "renderer/air/volume_view.h"
#include "renderer/lights/light_points.h"

namespace render2mpeg::renderer {
namespace {

constexpr float no_end = std::numeric_limits<float>::infinity();

/// Pixels between the rays of the lattice. chosen: 4; edges of shafts are found anew where they show.
constexpr int lattice = 4;
constexpr int cells_across = tile_size / lattice;

/// A lattice cell in whose middle the corners' mean is off by more than this share of the tolerance gets a ray for each
/// pixel; it is not looked at where corners differ by less than that. chosen: a half; not tuned.
constexpr float part_of_tolerance = 0.5f;

/// The tolerance, as a share of light, of a first look, and where there is none.
constexpr float rough_tolerance = 0.1f, reference_tolerance = 0.005f;

/// Shadow rays of a lamp along a ray to begin with: of the eye's, and of mirrors'. chosen: 16, one packet; halves of it
/// where less is seen.
constexpr int eye_cells = 16, mirror_cells = 8;

/// Distances at which light is known, each so many times the one before. chosen: 1.04; between two light counts as
/// linear.
constexpr float ladder = 1.04f;
constexpr int to_infinity = 1 << 20, lowest_rung = -2000, highest_rung = 2000;

int rung_below(float distance) {
    if (std::isinf(distance)) return to_infinity;
    static const float inverse = 1.0f / std::log(ladder);
    const float rung = std::floor(std::log(std::max(distance, 1e-30f)) * inverse);
    return rung >= static_cast<float>(highest_rung) ? to_infinity : std::max(static_cast<int>(rung), lowest_rung);
}
float distance_of(int rung) {
    return rung == to_infinity ? no_end : std::pow(ladder, static_cast<float>(rung));
}

using Rungs = std::vector<int>;

void add_rungs(float distance, Rungs& rungs) {
    const int below = rung_below(distance);
    rungs.push_back(below);
    if (below != to_infinity) rungs.push_back(below + 1);
}

void make_unique(Rungs& rungs) {
    std::sort(rungs.begin(), rungs.end());
    rungs.erase(std::unique(rungs.begin(), rungs.end()), rungs.end());
}

/// Light of the air from the eye on, at some rungs.
struct Column {
    Rungs rungs;
    std::vector<glm::vec3> light;

    /// At a rung that it has.
    glm::vec3 at(int rung) const {
        const auto found = std::lower_bound(rungs.begin(), rungs.end(), rung);
        return light[static_cast<std::size_t>(found - rungs.begin())];
    }
    glm::vec3 at_distance(float distance) const {
        const int below = rung_below(distance);
        if (below == to_infinity) return at(below);
        const float low = distance_of(below), high = distance_of(below + 1);
        const float t = std::clamp((distance - low) / (high - low), 0.0f, 1.0f);
        const glm::vec3 a = at(below), b = at(below + 1);
        return a + t * (b - a);
    }
};

class Airlight {
  public:
    Airlight(const PosedScene& posed_scene, std::span<const LightPoint> lamps, Bodies bodies,
             const AmbientColumns* ambient, const core::ToleranceMap* tolerance, const Frame& seen)
        : camera_(posed_scene.posed().camera),
          scene_{*posed_scene.air(), posed_scene.tracer(), bodies},
          lamps_(lamps),
          ambient_(ambient),
          tolerance_(tolerance),
          seen_(seen),
          across_((seen.visible.width() + lattice - 1) / lattice + 1),
          down_((seen.visible.height() + lattice - 1) / lattice + 1) {
        const glm::vec3 a = camera_.ray_through({0.5f * static_cast<float>(seen.visible.width()), 0.0f}).direction;
        const glm::vec3 b = camera_.ray_through({0.5f * static_cast<float>(seen.visible.width()), 1.0f}).direction;
        half_pixel_ = 0.5f * glm::length(a - b);
    }

    /// Light of all pixels of these, by pixel of the picture.
    void add(const std::vector<SeenAir>& air, const core::Plane<std::uint8_t>* only, core::Plane<glm::vec3>& out,
             core::Plane<glm::vec3>* beyond);
    std::uint64_t rays() const { return rays_; }

  private:
    using Spans = std::vector<const AirSpan*>;
    using CellSpans = std::array<Spans, static_cast<std::size_t>(cells_across* cells_across)>;

    CellSpans cells_of(const SeenAir& air, std::size_t tile, const core::Plane<std::uint8_t>* only) const;
    Column column(glm::vec2 position, Rungs rungs, std::uint64_t& rays) const;
    void add_cell(glm::ivec2 first, const Spans& spans, core::Plane<glm::vec3>& out, std::uint64_t& rays) const;
    float allowed(glm::ivec2 pixel, float luminance) const;
    bool is_smooth(glm::ivec2 first, const std::array<const Column*, 4>& corners, const Rungs& rungs,
                   std::uint64_t& rays) const;
    void add_finely(glm::ivec2 first, const Spans& spans, core::Plane<glm::vec3>& out, std::uint64_t& rays) const;
    glm::vec3 light_of(const AirPath& path, std::uint64_t& rays) const;
    const Column& corner(int x, int y) const { return columns_[static_cast<std::size_t>(y * across_ + x)]; }

    const scene::Camera& camera_;
    AirScene scene_;
    std::span<const LightPoint> lamps_;
    const AmbientColumns* ambient_;        ///< null: there is none
    const core::ToleranceMap* tolerance_;  ///< null: of a first look
    const Frame& seen_;
    int across_, down_;  ///< lattice points
    float half_pixel_;   ///< at distance 1
    std::vector<Column> columns_;
    std::uint64_t rays_ = 0;
};

/// The spans of a tile by its lattice cells.
Airlight::CellSpans Airlight::cells_of(const SeenAir& air, std::size_t tile,
                                       const core::Plane<std::uint8_t>* only) const {
    CellSpans cells;
    const glm::ivec2 first = seen_.corner_of(tile);
    for (const AirSpan& span : air.straight) {
        const int x = span.pixel % tile_size, y = span.pixel / tile_size;
        if (only != nullptr && only->at(first.x + x, first.y + y) == 0) continue;
        cells[static_cast<std::size_t>(y / lattice * cells_across + x / lattice)].push_back(&span);
    }
    return cells;
}

/// All lamps' light along the eye's ray through a position of the picture.
Column Airlight::column(glm::vec2 position, Rungs rungs, std::uint64_t& rays) const {
    Column column;
    column.light.assign(rungs.size(), glm::vec3(0));
    column.rungs = std::move(rungs);
    if (column.rungs.empty()) return column;
    const scene::Ray eye = camera_.ray_through(position);
    const float cosine = glm::dot(eye.direction, camera_.depth_axis(eye.direction));
    const float near = core::divide_or(std::max(camera_.lens().near, 0.0f), cosine, 0.0f);
    std::vector<float> ends;
    for (const int rung : column.rungs) ends.push_back(distance_of(rung));
    const AirRay ray{eye.origin + near * eye.direction, eye.direction, ends, half_pixel_};
    for (const LightPoint& lamp : lamps_) rays += add_scattered(scene_, lamp, ray, eye_cells, column.light.data());
    return column;
}

/// Tolerance of the light of air in a pixel.
float Airlight::allowed(glm::ivec2 pixel, float luminance) const {
    if (tolerance_ == nullptr) return rough_tolerance * luminance;
    if (tolerance_->is_reference()) return reference_tolerance * luminance;
    pixel = glm::min(pixel, glm::ivec2(seen_.visible.width(), seen_.visible.height()) - 1);
    return tolerance_->pixels.at(pixel.x, pixel.y).allows(luminance);
}

/// Whether light within a cell is interpolated well enough between its corners.
bool Airlight::is_smooth(glm::ivec2 first, const std::array<const Column*, 4>& corners, const Rungs& rungs,
                         std::uint64_t& rays) const {
    const glm::ivec2 pixel = first + lattice / 2;
    bool alike = true;
    for (const int rung : rungs) {
        float least = no_end, most = 0;
        for (const Column* column : corners) {
            const float light = core::luminance(column->at(rung));
            least = std::min(least, light);
            most = std::max(most, light);
        }
        alike = alike && most - least <= part_of_tolerance * allowed(pixel, least);
    }
    if (alike) return true;
    const Column middle = column(glm::vec2(first) + 0.5f * lattice, rungs, rays);
    return std::all_of(rungs.begin(), rungs.end(), [&](int rung) {
        glm::vec3 mean(0);
        for (const Column* column : corners) mean += 0.25f * column->at(rung);
        const glm::vec3 off = glm::abs(middle.at(rung) - mean);
        return core::luminance(off) <= part_of_tolerance * allowed(pixel, core::luminance(middle.at(rung)));
    });
}

void Airlight::add_cell(glm::ivec2 first, const Spans& spans, core::Plane<glm::vec3>& out, std::uint64_t& rays) const {
    if (spans.empty()) return;
    Rungs rungs;
    for (const AirSpan* span : spans) add_rungs(span->distance, rungs);
    make_unique(rungs);
    const int cx = first.x / lattice, cy = first.y / lattice;
    const std::array<const Column*, 4> corners{&corner(cx, cy), &corner(cx + 1, cy), &corner(cx, cy + 1),
                                               &corner(cx + 1, cy + 1)};
    if (!is_smooth(first, corners, rungs, rays)) {
        add_finely(first, spans, out, rays);
        return;
    }
    for (const AirSpan* span : spans) {
        const int x = span->pixel % lattice, y = span->pixel / tile_size % lattice;
        const float u = (static_cast<float>(x) + 0.5f) / lattice, v = (static_cast<float>(y) + 0.5f) / lattice;
        glm::vec3 light[4];
        for (std::size_t k = 0; k < 4; ++k) light[k] = corners[k]->at_distance(span->distance);
        out.at(first.x + x, first.y + y) +=
            span->weight * glm::mix(glm::mix(light[0], light[1], u), glm::mix(light[2], light[3], u), v);
    }
}

/// By a ray through each pixel.
void Airlight::add_finely(glm::ivec2 first, const Spans& spans, core::Plane<glm::vec3>& out,
                          std::uint64_t& rays) const {
    for (std::size_t from = 0; from < spans.size();) {
        std::size_t to = from;
        Rungs rungs;
        for (; to < spans.size() && spans[to]->pixel == spans[from]->pixel; ++to) add_rungs(spans[to]->distance, rungs);
        make_unique(rungs);
        const glm::ivec2 p = first + glm::ivec2(spans[from]->pixel % lattice, spans[from]->pixel / tile_size % lattice);
        const Column own = column(glm::vec2(p) + 0.5f, std::move(rungs), rays);
        for (; from < to; ++from) out.at(p.x, p.y) += spans[from]->weight * own.at_distance(spans[from]->distance);
    }
}

glm::vec3 Airlight::light_of(const AirPath& path, std::uint64_t& rays) const {
    glm::vec3 light = ambient_ != nullptr ? ambient_->along(path) : glm::vec3(0);
    const float end[1] = {path.distance};
    const AirRay ray{path.origin, path.direction, end, half_pixel_};
    for (const LightPoint& lamp : lamps_) rays += add_scattered(scene_, lamp, ray, mirror_cells, &light);
    return light;
}

void Airlight::add(const std::vector<SeenAir>& air, const core::Plane<std::uint8_t>* only, core::Plane<glm::vec3>& out,
                   core::Plane<glm::vec3>* beyond) {
    // Which distances the lattice is asked for,
    std::vector<CellSpans> cells(air.size());
    parallel::for_each(air.size(), [&](std::size_t t) { cells[t] = cells_of(air[t], t, only); });
    const auto spans_at = [&](int cx, int cy) -> const Spans* {
        const int tx = cx / cells_across, ty = cy / cells_across;
        const std::size_t t = static_cast<std::size_t>(ty * seen_.tiles_across() + tx);
        if (cx < 0 || cy < 0 || tx >= seen_.tiles_across() || t >= cells.size()) return nullptr;
        return &cells[t][static_cast<std::size_t>(cy % cells_across * cells_across + cx % cells_across)];
    };
    // its light,
    columns_.assign(static_cast<std::size_t>(across_ * down_), {});
    std::vector<std::uint64_t> row_rays(static_cast<std::size_t>(down_), 0), tile_rays(air.size(), 0);
    parallel::for_each(static_cast<std::size_t>(down_), [&](std::size_t row) {
        const int y = static_cast<int>(row);
        for (int x = 0; x < across_; ++x) {
            Rungs rungs;
            for (const glm::ivec2 d : {glm::ivec2(-1, -1), glm::ivec2(0, -1), glm::ivec2(-1, 0), glm::ivec2(0, 0)})
                if (const Spans* spans = spans_at(x + d.x, y + d.y))
                    for (const AirSpan* span : *spans) add_rungs(span->distance, rungs);
            make_unique(rungs);
            columns_[row * static_cast<std::size_t>(across_) + static_cast<std::size_t>(x)] =
                column(static_cast<float>(lattice) * glm::vec2(x, y), std::move(rungs), row_rays[row]);
        }
    });
    // and that of the pixels.
    parallel::for_each(air.size(), [&](std::size_t t) {
        const glm::ivec2 first = seen_.corner_of(t);
        for (int c = 0; c < cells_across * cells_across; ++c)
            add_cell(first + lattice * glm::ivec2(c % cells_across, c / cells_across),
                     cells[t][static_cast<std::size_t>(c)], out, tile_rays[t]);
        for (const AirSpan& span : air[t].straight) {
            const glm::ivec2 p = seen_.place_of(t, span.pixel);
            if (ambient_ != nullptr && (only == nullptr || only->at(p.x, p.y) != 0))
                out.at(p.x, p.y) += span.weight * ambient_->light(p, span.distance);
        }
        for (const AirPath& path : air[t].beyond) {
            const glm::ivec2 p = seen_.place_of(t, path.pixel);
            if (only != nullptr && only->at(p.x, p.y) == 0) continue;
            const glm::vec3 light = path.weight * light_of(path, tile_rays[t]);
            out.at(p.x, p.y) += light;
            if (beyond != nullptr && !beyond->empty()) beyond->at(p.x, p.y) += light;
        }
    });
    for (const std::uint64_t r : row_rays) rays_ += r;
    for (const std::uint64_t r : tile_rays) rays_ += r;
}

/// Returns the shadow rays.
std::uint64_t add_fog(const AirInstant& instant, const core::ToleranceMap* tolerance, const Frame& seen,
                      EffectLight& light) {
    const PosedScene& posed_scene = instant.posed_scene;
    const std::vector<LightPoint> points = points_beyond_rays(instant);
    const std::vector<LightPoint> lamps = air_lamps(points, instant.light_trees);
    std::optional<AmbientColumns> columns;
    if (!posed_scene.air()->lit_fog().empty()) columns.emplace(posed_scene, seen);
    Airlight airlight(posed_scene, lamps, instant.light_trees.bodies, columns ? &*columns : nullptr, tolerance, seen);
    airlight.add(seen.air, nullptr, light.all, &light.specular);
    if (!light.exposed.empty()) airlight.add(seen.exposure->air, &seen.exposure->exposed, light.exposed, nullptr);
    return airlight.rays();
}

}  // namespace

std::vector<LightPoint> points_beyond_rays(const AirInstant& instant) {
    return instant.gather != nullptr ? beyond_rays(instant.points, brightest_of_rays(instant.posed_scene.sky()))
                                     : instant.points;
}

std::uint64_t add_airlight(const AirInstant& instant, const core::ToleranceMap* tolerance, const Frame& seen,
                           UngatheredLight& sum) {
    if (seen.air.empty()) return 0;
    const PosedScene& posed_scene = instant.posed_scene;
    const core::Plane<glm::vec3> black(seen.visible.width(), seen.visible.height(), glm::vec3(0));
    EffectLight light{black, {}, {}};
    if (!seen.emitted_specular.empty()) light.specular = black;
    if (seen.exposure && !seen.exposure->air.empty()) light.exposed = black;
    std::uint64_t rays = 0;
    if (posed_scene.air()->fog() != nullptr) rays = add_fog(instant, tolerance, seen, light);
    if (!posed_scene.air()->volumes().empty()) add_volumes_seen(posed_scene, seen, light);
    sum.add_air(std::move(light));
    return rays;
}

}  // namespace render2mpeg::renderer
