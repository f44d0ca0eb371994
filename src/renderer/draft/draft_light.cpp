// Spatio-temporal upsampling [Herzog2010, 8.3]. Changed: the lattice's points are gathered by cuts instead of being
// pixels of a smaller picture; a pixel's partner in the frame before is tested by object and depth; how much light
// changes is judged at lit points alone, where a new value and an old one are there.
#include "renderer/draft/draft_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/color.h"
#include "core/numeric.h"
#include "parallel/loops.h"
#include "renderer/cut/gather_groups.h"
#include "renderer/cut/gatherer.h"

namespace render2mpeg::renderer {
namespace {

/// Lights that are gathered for every pixel. [Herzog2010, 8.4]: those whose shadows one looks at; chosen: 4.
constexpr std::size_t most_sharp_lights = 4;

/// Points of a tile that are gathered by themselves, since no lit point about them is in the least alike. chosen: 32,
/// two packets. To gather all that the four nearest are unlike took a third of the time for light in Sponza, and gained
/// 0.07 dB.
constexpr std::size_t most_alone = 32;

/// Lit points that a pixel's light may stand for. chosen: 16, as many as a window has pixels.
constexpr float most_weight = 16.0f;

/// No value of a change: nothing is known of before.
constexpr float no_change_known = 2.0f;

/// How much depth may differ between a pixel and its partner in the frame before, as a share.
constexpr float same_depth = 0.02f;

PointTolerance tolerance_of(const DraftFrame& frame, const GatherPoint& p, int x, int y) {
    const core::Tolerance& t = frame.tolerance.pixels.at(x, y);
    const float part = core::luminance(p.weight);
    return {{std::max(t.absolute, 0.0f) * part, std::max(t.relative, 0.0f), t.background * part},
            std::max(core::luminance(frame.ungathered.all().at(x, y)), 0.0f) * part};
}

/// Gathers some points of a frame.
class PointGatherer {
  public:
    explicit PointGatherer(const DraftFrame& frame) : frame_(frame), gatherer_(frame.light_trees, frame.tracer) {}

    /// All light but the sharp lights' for up to sixteen points; `found(i, light)` for each.
    template <class Found>
    void gather(std::span<const PointRef> points, int set, const CutLimits& limits, ShadeCounts& counts,
                const Found& found) {
        load(points, set);
        gatherer_.gather(lanes_, tolerance_, limits, gathered_);
        counts.add(gathered_, points.size());
        for (std::size_t i = 0; i < points.size(); ++i)
            found(i, point_light(gathered_, static_cast<int>(i), point(points[i])));
    }
    /// The sharp lights' alone.
    template <class Found>
    void gather_sharp(std::span<const PointRef> points, ShadeCounts& counts, const Found& found) {
        load(points, 0);
        gatherer_.gather_exact(lanes_, Shadow::sharp, &tolerance_, {}, gathered_);
        counts.shadow_rays += gathered_.shadow_rays;
        for (std::size_t i = 0; i < points.size(); ++i)
            found(i, point_light(gathered_, static_cast<int>(i), point(points[i])));
    }

  private:
    const GatherPoint& point(const PointRef& p) const { return frame_.seen.tiles[p.tile][p.index]; }
    void load(std::span<const PointRef> points, int set) {
        const GatherPoint* pointers[lane_count];
        for (std::size_t i = 0; i < lane_count; ++i) {
            const PointRef& ref = points[std::min(i, points.size() - 1)];
            const GatherPoint& p = point(ref);
            if (i < points.size()) pointers[i] = &p;
            const glm::ivec2 at = frame_.seen.place_of(ref.tile, p.pixel);
            tolerance_.set(static_cast<int>(i), tolerance_of(frame_, p, at.x, at.y));
        }
        fill(lanes_, std::span<const GatherPoint* const>(pointers, points.size()));
        lanes_.set = set;
    }

    const DraftFrame& frame_;
    Gatherer gatherer_;
    GatherLanes lanes_;
    GroupTolerance tolerance_;
    GatheredLight gathered_;
};

SmoothLight smooth(const PointLight& light, glm::vec3 lobe) {
    SmoothLight result{light.direct + light.indirect, glm::vec3(0)};
    for (int k = 0; k < 3; ++k) result.glossy[k] = core::divide_or(light.glossy[k], lobe[k], 0.0f);
    return result;
}

/// How strong a light is where the camera looks.
float strength_at(const ExactLight& exact, std::span<const glm::vec3> places) {
    float sum = 0;
    for (const glm::vec3& place : places) {
        const glm::vec3 to = exact.light.position - place;
        const float distance2 = exact.type == LightType::directional ? 1.0f : std::max(glm::dot(to, to), 1e-6f);
        sum += std::min(core::luminance(exact.light.intensity) / distance2, 1e6f);
    }
    return sum;
}

/// Lights for every pixel, taken out of the trees while the lattice is lit.
class SharpLights {
  public:
    SharpLights(LightTrees& trees, std::span<const glm::vec3> places)
        : trees_(trees), exact_(trees.exact), lamps_(trees.lamps) {
        std::vector<std::pair<float, std::size_t>> by_strength;
        for (std::size_t i = 0; i < exact_.size(); ++i) by_strength.emplace_back(-strength_at(exact_[i], places), i);
        std::stable_sort(by_strength.begin(), by_strength.end(),
                         [](const auto& a, const auto& b) { return a.first < b.first; });
        for (std::size_t k = 0; k < by_strength.size(); ++k)
            (k < most_sharp_lights ? sharp_exact_ : other_exact_).push_back(exact_[by_strength[k].second]);
        for (const auto& lamp : lamps_) (lamp->sharp ? sharp_lamps_ : other_lamps_).push_back(lamp);
    }
    ~SharpLights() {
        trees_.exact = std::move(exact_);
        trees_.lamps = std::move(lamps_);
    }
    SharpLights(const SharpLights&) = delete;
    SharpLights& operator=(const SharpLights&) = delete;

    bool none() const { return sharp_exact_.empty() && sharp_lamps_.empty(); }
    void leave_others() {
        trees_.exact = other_exact_;
        trees_.lamps = other_lamps_;
    }
    void leave_sharp() {
        trees_.exact = sharp_exact_;
        trees_.lamps = sharp_lamps_;
    }

  private:
    LightTrees& trees_;
    std::vector<ExactLight> exact_, sharp_exact_, other_exact_;
    std::vector<std::shared_ptr<const AreaLamp>> lamps_, sharp_lamps_, other_lamps_;
};

/// Places that are seen, a few, spread over the picture.
std::vector<glm::vec3> seen_places(const Frame& seen) {
    std::vector<glm::vec3> places;
    for (std::size_t t = 0; t < seen.tiles.size(); t += 1 + seen.tiles.size() / 64)
        if (!seen.tiles[t].empty()) places.push_back(seen.tiles[t].front().point.position);
    return places;
}

/// Phase of surfaces that motion does not carry along.
constexpr glm::ivec2 fixed_phase{2, 2};

Lattice lattice_of(std::int64_t n, const DraftFrame& frame) {
    const auto [phase, windows] = lit_pixels_of(n, frame.motion != nullptr);
    return Lattice(frame.seen.visible.width(), frame.seen.visible.height(), phase, windows);
}

bool is_lit(const Lattices& lattices, const Frame& seen, std::size_t tile, const GatherPoint& p) {
    const glm::ivec2 at = seen.place_of(tile, p.pixel);
    return lattices.of(p, seen.visible.kind.at(at.x, at.y)).is_lit(at.x, at.y);
}

/// Gathers the points that tiles want, `wants(t, wanted)`, in areas of 4x4 tiles so that packets are full; `take(ref,
/// light)` for each of them, one after the other, in the same order in every run.
template <class Wants, class Take>
void gather_by_areas(const DraftFrame& frame, const CutLimits& limits, ShadeCounts& counts, const Wants& wants,
                     const Take& take) {
    const Frame& seen = frame.seen;
    const int across = seen.tiles_across(), down = static_cast<int>(seen.tiles.size()) / std::max(across, 1);
    const int areas_across = (across + area_tiles - 1) / area_tiles, areas_down = (down + area_tiles - 1) / area_tiles;
    struct Area {
        std::vector<std::pair<PointRef, PointLight>> found;
        ShadeCounts counts;
    };
    std::vector<Area> areas(static_cast<std::size_t>(areas_across) * static_cast<std::size_t>(areas_down));
    parallel::for_each(areas.size(), [&](std::size_t a) {
        const int left = static_cast<int>(a) % areas_across * area_tiles,
                  top = static_cast<int>(a) / areas_across * area_tiles;
        std::vector<PointRef> wanted;
        for (int row = top; row < std::min(top + area_tiles, down); ++row)
            for (int column = left; column < std::min(left + area_tiles, across); ++column)
                wants(static_cast<std::uint32_t>(row * across + column), wanted);
        if (wanted.empty()) return;
        PointGatherer gatherer(frame);
        for (const RequestGroup& group : group_requests(seen, wanted, frame.eye))
            gatherer.gather(
                group.points, group.set, limits, areas[a].counts,
                [&](std::size_t i, const PointLight& light) { areas[a].found.emplace_back(group.points[i], light); });
    });
    for (const Area& area : areas) {
        counts.add(area.counts);
        for (const auto& [ref, light] : area.found) take(ref, light);
    }
}

void light_lattices(const DraftFrame& frame, const CutLimits& limits, Lattices& lattices, ShadeCounts& counts) {
    const Frame& seen = frame.seen;
    const auto wants = [&](std::uint32_t t, std::vector<PointRef>& wanted) {
        for (std::uint32_t i = 0; i < seen.tiles[t].size(); ++i)
            if (is_lit(lattices, seen, t, seen.tiles[t][i])) wanted.push_back({t, i});
    };
    gather_by_areas(frame, limits, counts, wants, [&](const PointRef& ref, const PointLight& light) {
        const GatherPoint& p = seen.tiles[ref.tile][ref.index];
        const glm::ivec2 at = seen.place_of(ref.tile, p.pixel);
        lattices.of(p, seen.visible.kind.at(at.x, at.y))
            .add(at.x, at.y,
                 {p.point.position, p.point.geometric_normal, p.point.address.object, p.path,
                  smooth(light, lobe_reflectance(p))});
    });
}

/// Adds the sharp lights' light to all points of a tile.
void add_sharp(const DraftFrame& frame, std::size_t t, std::vector<PointLight>& light, ShadeCounts& counts) {
    PointGatherer gatherer(frame);
    for (const GatherGroup& group : group_points(frame.seen.tiles[t], frame.eye, 1)) {
        std::array<PointRef, lane_count> refs;
        for (std::size_t i = 0; i < group.points.size(); ++i)
            refs[i] = {static_cast<std::uint32_t>(t), group.points[i]};
        gatherer.gather_sharp({refs.data(), group.points.size()}, counts, [&](std::size_t i, const PointLight& found) {
            light[group.points[i]].direct += found.direct;
            light[group.points[i]].glossy += found.glossy;
        });
    }
}

}  // namespace

void DraftLight::forget() {
    count_ = 0;
    visible_ = {};
    kept_ = {};
}

DraftLight::Kept DraftLight::carried(const DraftFrame& frame, int x, int y) const {
    Kept result;
    if (frame.motion == nullptr || kept_.empty()) return result;
    const core::PixelClass kind = frame.motion->kind.at(x, y);
    if (kind != core::PixelClass::surface) return result;
    const glm::vec2 there = glm::vec2(x, y) + frame.motion->vector.at(x, y);
    const float left = std::floor(there.x), top = std::floor(there.y);
    if (!(left >= -1 && top >= -1 && left < static_cast<float>(kept_.width()) &&
          top < static_cast<float>(kept_.height())))
        return result;
    const float depth = frame.motion->depth_in_reference.at(x, y);
    float shares = 0;
    for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i) {
            const int px = static_cast<int>(left) + i, py = static_cast<int>(top) + j;
            if (px < 0 || py < 0 || px >= kept_.width() || py >= kept_.height()) continue;
            const float share = (1.0f - std::abs(there.x - static_cast<float>(px))) *
                                (1.0f - std::abs(there.y - static_cast<float>(py)));
            const Kept& kept = kept_.at(px, py);
            if (share <= 0 || kept.weight <= 0 ||
                visible_.address.at(px, py).object != frame.seen.visible.address.at(x, y).object ||
                !(std::abs(visible_.depth.at(px, py) - depth) <= same_depth * depth))
                continue;
            shares += share;
            result.light.irradiance += share * kept.light.irradiance;
            result.light.glossy += share * kept.light.glossy;
            result.weight += share * kept.weight;
        }
    // chosen: a quarter; with less the partner is another one's neighbour.
    if (shares < 0.25f) return {};
    result.light.irradiance /= shares;
    result.light.glossy /= shares;
    return result;
}

float DraftLight::change_at(const DraftFrame& frame, const Lattice& lattice, glm::ivec2 window,
                            const core::Plane<Kept>& before) const {
    const glm::ivec2 at = lattice.pixel_of(window);
    const Kept& old = before.at(at.x, at.y);
    if (old.weight <= 0) return no_change_known;
    for (const LitSample& sample : lattice.samples(window)) {
        if (sample.object != frame.seen.visible.address.at(at.x, at.y).object) continue;
        const float now = core::luminance(sample.light.irradiance) + core::luminance(sample.light.glossy),
                    then = core::luminance(old.light.irradiance) + core::luminance(old.light.glossy);
        return core::divide_or(now - then, std::max(now, then), 0.0f);
    }
    return no_change_known;
}

core::Plane<float> DraftLight::trust(const DraftFrame& frame, const Lattice& lattice,
                                     const core::Plane<Kept>& before) const {
    core::Plane<float> changes(lattice.across(), lattice.down());
    for (int y = 0; y < changes.height(); ++y)
        for (int x = 0; x < changes.width(); ++x) changes.at(x, y) = change_at(frame, lattice, {x, y}, before);
    core::Plane<float> trust(changes.width(), changes.height());
    for (int y = 0; y < changes.height(); ++y)
        for (int x = 0; x < changes.width(); ++x) {
            float sum = 0, weights = 0;
            for (int j = std::max(y - 1, 0); j <= std::min(y + 1, changes.height() - 1); ++j)
                for (int i = std::max(x - 1, 0); i <= std::min(x + 1, changes.width() - 1); ++i) {
                    if (changes.at(i, j) == no_change_known) continue;
                    const float weight = (i == x ? 2.0f : 1.0f) * (j == y ? 2.0f : 1.0f);
                    sum += weight * changes.at(i, j);
                    weights += weight;
                }
            const float rest = 1.0f - std::abs(core::divide_or(sum, weights, 0.0f));
            trust.at(x, y) = rest * rest;
        }
    return trust;
}

void DraftLight::interpolate(const DraftFrame& frame, const Lattices& lattices, const core::Plane<Kept>& before,
                             const core::Plane<float>& trust, std::size_t t, DraftTile& tile,
                             core::Plane<Kept>& kept) const {
    const GatherTile& points = frame.seen.tiles[t];
    tile.light.resize(points.size());
    int last_main = -1;  // pixel whose main surface was met
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        const GatherPoint& p = points[i];
        const glm::ivec2 at = frame.seen.place_of(t, p.pixel);
        const bool main = !p.reached_by_specular() && last_main != p.pixel &&
                          p.point.address.object == frame.seen.visible.address.at(at.x, at.y).object;
        if (main) last_main = p.pixel;
        const Kept& known = before.at(at.x, at.y);
        const glm::ivec2 window = glm::min(at / lattice_step, glm::ivec2(trust.width() - 1, trust.height() - 1));
        const float old = main ? trust.at(window.x, window.y) * known.weight : 0.0f;
        const bool carries_on = old > 0;
        const float distance = glm::length(p.point.position - frame.eye);
        const Lattice& lattice = lattices.of(p, frame.seen.visible.kind.at(at.x, at.y));
        Lattice::Interpolated found = lattice.at(at, p, carries_on, distance);
        if (found.weight <= 0 && !carries_on) found = lattice.at_from_afar(at, p, distance);
        auto [light, weight, is_empty] = found;
        if (carries_on) {
            const float sum = weight + old;
            light.irradiance = (weight * light.irradiance + old * known.light.irradiance) / sum;
            light.glossy = (weight * light.glossy + old * known.light.glossy) / sum;
            weight = sum;
        } else if (is_empty && tile.alone.size() < most_alone) {
            tile.alone.push_back({static_cast<std::uint32_t>(t), i});
            continue;
        }
        if (main) kept.at(at.x, at.y) = {light, std::min(weight, most_weight)};
        tile.light[i].direct = light.irradiance;
        tile.light[i].glossy = light.glossy * lobe_reflectance(p);
    }
}

FrameLight DraftLight::light(const DraftFrame& frame, const CutLimits& limits, ShadeCounts& counts) {
    const Frame& seen = frame.seen;
    const int width = seen.visible.width(), height = seen.visible.height();
    SharpLights sharp(frame.parted, seen_places(seen));

    // Light the lattice,
    sharp.leave_others();
    Lattices lattices{lattice_of(count_, frame), Lattice(width, height, fixed_phase)};
    light_lattices(frame, limits, lattices, counts);

    // find the carried light of each pixel, and where it changes,
    core::Plane<Kept> before(width, height), kept(width, height);
    parallel::for_each(static_cast<std::size_t>(height), [&](std::size_t row) {
        for (int x = 0; x < width; ++x) before.at(x, static_cast<int>(row)) = carried(frame, x, static_cast<int>(row));
    });
    const core::Plane<float> trusted = trust(frame, lattices.straight, before);

    // interpolate, and gather points unlike all lit ones,
    std::vector<DraftTile> tiles(seen.tiles.size());
    parallel::for_each(tiles.size(),
                       [&](std::size_t t) { interpolate(frame, lattices, before, trusted, t, tiles[t], kept); });
    gather_by_areas(
        frame, limits, counts,
        [&](std::uint32_t t, std::vector<PointRef>& wanted) {
            wanted.insert(wanted.end(), tiles[t].alone.begin(), tiles[t].alone.end());
        },
        [&](const PointRef& ref, const PointLight& light) { tiles[ref.tile].light[ref.index] = light; });

    // and light every point by the sharp lights.
    if (!sharp.none()) {
        sharp.leave_sharp();
        parallel::for_each(tiles.size(), [&](std::size_t t) {
            if (!tiles[t].light.empty()) add_sharp(frame, t, tiles[t].light, tiles[t].counts);
        });
    }
    FrameLight light;
    for (DraftTile& tile : tiles) {
        counts.add(tile.counts);
        light.push_back(std::move(tile.light));
    }
    visible_ = seen.visible;
    kept_ = std::move(kept);
    ++count_;
    return light;
}

}  // namespace render2mpeg::renderer
