#include "renderer/cut/steep_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "core/color.h"
#include "core/error.h"
#include "core/numeric.h"
#include "parallel/loops.h"

namespace render2mpeg::renderer {
namespace {

/// Neighbours lie on one flat surface if their normals differ by less than this, and neither lies off the other's plane
/// by more than `flat_plane` of their distance. chosen: 2.5 degrees, and 0.05: parts of a point keep its normal.
constexpr float flat_normal = 0.999f, flat_plane = 0.05f;

/// By which share of light's bend over three pixels that of a pixel may differ from that of one place in it. chosen:
/// 0.25 of 0.25, 0.5 and 1: a box like cornell loses 1.94, 1.94 and 1.97 dB at quantiser 4 (2.86 unsplit), for 1.05,
/// 1.2 and 1.6 times the CPU time.
constexpr float bend_to_error = 0.25f;

/// Parts of a point, and of one whose light may be off by `much` times its tolerance, if it has as many places.
/// chosen: the box like cornell loses 1.94 dB with 4 everywhere and 1.52 dB with 16 from 4 times on.
constexpr std::uint32_t few_parts = 4, many_parts = 16;
constexpr float much = 4.0f;

/// A reference has no tolerances. chosen: 1 %; not tuned.
constexpr float reference_share = 0.01f;

/// Finds the points of pixels.
class PixelPoints {
  public:
    PixelPoints(const Seen& seen, const FrameLight& light)
        : seen_(seen), light_(light), first_(seen.visible.width(), seen.visible.height(), none) {
        const int across = seen.tiles_across();
        for (std::size_t t = 0; t < seen.tiles.size(); ++t) {
            const GatherTile& tile = seen.tiles[t];
            const glm::ivec2 corner =
                tile_size * glm::ivec2(static_cast<int>(t) % across, static_cast<int>(t) / across);
            for (std::size_t i = tile.size(); i-- > 0;)
                first_.at(corner.x + tile[i].pixel % tile_size, corner.y + tile[i].pixel / tile_size) =
                    static_cast<std::uint32_t>(i);
        }
    }

    /// By how much the diffuse light of a point, of a pixel at (x, y), may differ from its pixel's surface; luminance.
    /// On either axis it bends over three pixels, or differs from the one neighbour that shows the surface.
    float bend(const GatherPoint& p, const PointLight& light, int x, int y) const {
        const float here = luminance(p, light);
        float largest = 0;
        for (const glm::ivec2 step : {glm::ivec2(1, 0), glm::ivec2(0, 1)}) {
            float sides[2];
            int count = 0;
            for (const int side : {-1, 1}) {
                const PointLight* l = neighbour(p, x + side * step.x, y + side * step.y);
                if (l != nullptr) sides[count++] = luminance(p, *l) - here;
            }
            if (count > 0) largest = std::max(largest, std::abs(count == 2 ? sides[0] + sides[1] : sides[0]));
        }
        return bend_to_error * largest;
    }

  private:
    static constexpr std::uint32_t none = 0xffffffffu;

    /// Of light that reaches a surface as dull as the point's.
    static float luminance(const GatherPoint& p, const PointLight& l) {
        return core::luminance(p.weight * p.point.bsdf.diffuse * (l.direct + l.indirect));
    }

    /// Light of the first point of a pixel that lies on the same flat surface; null: none does. Parts keep the normal
    /// and the direction to the eye, so that surfaces that turn within two pixels stay whole.
    const PointLight* neighbour(const GatherPoint& p, int x, int y) const {
        if (x < 0 || y < 0 || x >= seen_.visible.width() || y >= seen_.visible.height()) return nullptr;
        const std::uint32_t first = first_.at(x, y);
        if (first == none) return nullptr;
        const std::size_t t = static_cast<std::size_t>(y / tile_size) * static_cast<std::size_t>(seen_.tiles_across()) +
                              static_cast<std::size_t>(x / tile_size);
        const GatherTile& tile = seen_.tiles[t];
        for (std::size_t i = first; i < tile.size() && tile[i].pixel == tile[first].pixel; ++i)
            if (is_flat(p, tile[i])) return &light_[t][i];
        return nullptr;
    }

    static bool is_flat(const GatherPoint& a, const GatherPoint& b) {
        if (a.point.address.object != b.point.address.object || a.point.back_side != b.point.back_side) return false;
        if (a.way != b.way || glm::dot(a.point.shading_normal, b.point.shading_normal) < flat_normal) return false;
        const glm::vec3 apart = b.point.position - a.point.position;
        const float off = std::max(std::abs(glm::dot(apart, a.point.geometric_normal)),
                                   std::abs(glm::dot(apart, b.point.geometric_normal)));
        return off <= flat_plane * glm::length(apart) + a.point.position_error + b.point.position_error;
    }

    const Seen& seen_;
    const FrameLight& light_;
    core::Plane<std::uint32_t> first_;
};

/// All places of a point, its own first.
std::vector<glm::vec3> places_of(const GatherPoint& p) {
    std::vector<glm::vec3> places(1, p.point.position);
    places.insert(places.end(), p.elsewhere.begin(), p.elsewhere.begin() + p.others);
    if (p.more_places) places.insert(places.end(), p.more_places->begin(), p.more_places->end());
    return places;
}

/// The first `count` places of a point as points of their own, each with those of the others that are nearest to it.
std::vector<GatherPoint> parts_of(const GatherPoint& whole, std::uint32_t count) {
    const std::vector<glm::vec3> places = places_of(whole);
    std::vector<std::vector<glm::vec3>> others(count);
    for (std::size_t i = count; i < places.size(); ++i) {
        const auto distance = [&](glm::vec3 place) { return glm::dot(place - places[i], place - places[i]); };
        const auto nearest = std::min_element(places.begin(), places.begin() + count,
                                              [&](glm::vec3 a, glm::vec3 b) { return distance(a) < distance(b); });
        others[static_cast<std::size_t>(nearest - places.begin())].push_back(places[i]);
    }
    std::vector<GatherPoint> parts(count, whole);
    for (std::size_t k = 0; k < count; ++k) {
        GatherPoint& part = parts[k];
        part.point.position = places[k];
        if (k > 0) part.point.smooth.lift = glm::vec3(0);  // Other places are lifted already.
        part.weight *= static_cast<float>(1 + others[k].size()) / static_cast<float>(places.size());
        const std::size_t near = std::min<std::size_t>(others[k].size(), most_other_places);
        std::copy_n(others[k].begin(), near, part.elsewhere.begin());
        part.others = static_cast<std::uint8_t>(near);
        part.more_places = nullptr;
        if (others[k].size() > near)
            part.more_places = std::make_shared<const std::vector<glm::vec3>>(
                others[k].begin() + static_cast<std::ptrdiff_t>(near), others[k].end());
    }
    return parts;
}

/// Whether parts that were lit for one point serve another.
bool serves(const SplitPoint& known, const SplitPoint& p) {
    const PointLight &a = known.light, &b = p.light;
    return known.count == p.count && known.position == p.position && known.elsewhere == p.elsewhere &&
           known.allowed <= p.allowed && a.direct == b.direct && a.indirect == b.indirect && a.glossy == b.glossy;
}

/// That of a point that was split; null: it was not.
const SplitPoint* find_split(const std::vector<SplitPoint>& splits, std::uint32_t index) {
    const auto found = std::lower_bound(splits.begin(), splits.end(), index,
                                        [](const SplitPoint& s, std::uint32_t i) { return s.index < i; });
    return found != splits.end() && found->index == index ? &*found : nullptr;
}

/// How many parts a point is split into, whose light may be off by so many times its tolerance; 0: it is not.
std::uint32_t parts_for(const GatherPoint& p, float off) {
    if (!(off > 1.0f)) return 0;
    const auto places = static_cast<std::uint32_t>(1 + p.others + (p.more_places ? p.more_places->size() : 0));
    return std::min(places, off > much ? many_parts : few_parts);
}

/// Leaves each pixel of `fresh` the part of its tolerance, and of what it shows without gathering, that its parts have
/// of its weight in `seen`.
void part_tolerances(const Seen& seen, Seen& fresh, core::ToleranceMap& tolerance) {
    const int across = seen.tiles_across();
    for (std::size_t t = 0; t < fresh.tiles.size(); ++t) {
        if (fresh.tiles[t].empty()) continue;
        std::array<float, tile_size * tile_size> whole{}, part{};
        for (const GatherPoint& p : seen.tiles[t]) whole[p.pixel] += core::luminance(p.weight);
        for (const GatherPoint& p : fresh.tiles[t]) part[p.pixel] += core::luminance(p.weight);
        const int x0 = static_cast<int>(t) % across * tile_size, y0 = static_cast<int>(t) / across * tile_size;
        for (std::size_t k = 0; k < part.size(); ++k) {
            if (!(part[k] > 0.0f)) continue;
            const int x = x0 + static_cast<int>(k) % tile_size, y = y0 + static_cast<int>(k) / tile_size;
            const float share = std::min(core::divide_or(part[k], whole[k], 1.0f), 1.0f);
            fresh.emitted.at(x, y) *= share;
            if (tolerance.is_reference()) continue;
            tolerance.pixels.at(x, y).absolute *= share;
            tolerance.pixels.at(x, y).background *= share;
        }
    }
}

}  // namespace

/// Marks what is to be split; returns the parts whose light is not known, by tile.
std::vector<GatherTile> SteepLight::find(const LightingContext& frame, const FrameLight& light, std::int64_t lit_frame,
                                         const core::Radiance& radiance) {
    const Seen& seen = frame.seen;
    const auto across = static_cast<std::size_t>(seen.tiles_across());
    const std::vector<std::vector<SplitPoint>> before = lit_frame == lit_frame_ && tiles_.size() == seen.tiles.size()
                                                            ? std::move(tiles_)
                                                            : std::vector<std::vector<SplitPoint>>(seen.tiles.size());
    tiles_.assign(seen.tiles.size(), {});
    lit_frame_ = lit_frame;
    std::vector<GatherTile> parts(seen.tiles.size());
    const PixelPoints points(seen, light);
    parallel::for_each(seen.tiles.size(), [&](std::size_t t) {
        for (std::uint32_t i = 0; i < seen.tiles[t].size(); ++i) {
            const GatherPoint& p = seen.tiles[t][i];
            if (p.others == 0) continue;
            const int x = static_cast<int>(t % across) * tile_size + p.pixel % tile_size,
                      y = static_cast<int>(t / across) * tile_size + p.pixel / tile_size;
            const float shown = core::luminance(radiance.combined.at(x, y));
            const float allowed = frame.tolerance.is_reference() ? reference_share * shown
                                                                 : frame.tolerance.pixels.at(x, y).allows(shown);
            const std::uint32_t count = parts_for(p, core::divide_or(points.bend(p, light[t][i], x, y), allowed, 0.0f));
            if (count < 2) continue;
            SplitPoint split{i, count, p.point.position, p.elsewhere[0], allowed, light[t][i], {}};
            const SplitPoint* known = find_split(before[t], i);
            if (known != nullptr && serves(*known, split))
                split.parts = known->parts;
            else
                for (GatherPoint& part : parts_of(p, count)) parts[t].push_back(std::move(part));
            tiles_[t].push_back(std::move(split));
        }
    });
    return parts;
}

/// Puts the parts of tile `t` in the places of their points, and their light. `fresh` are those that were lit now.
void SteepLight::put_in(GatherTile& fresh, const std::vector<PointLight>& of_fresh, std::size_t t, GatherTile& points,
                        std::vector<PointLight>& light) {
    GatherTile tile;
    std::vector<PointLight> lit;
    std::size_t next = 0;
    auto split = tiles_[t].begin();
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        if (split == tiles_[t].end() || split->index != i) {
            tile.push_back(std::move(points[i]));
            lit.push_back(light[i]);
            continue;
        }
        if (split->parts.empty()) {
            for (std::uint32_t k = 0; k < split->count; ++k, ++next) {
                tile.push_back(std::move(fresh[next]));
                split->parts.push_back(of_fresh[next]);
            }
        } else {
            for (GatherPoint& part : parts_of(points[i], split->count)) tile.push_back(std::move(part));
        }
        lit.insert(lit.end(), split->parts.begin(), split->parts.end());
        ++split;
    }
    points = std::move(tile);
    light = std::move(lit);
}

void SteepLight::light(const LightingContext& frame, const ShadeSettings& settings, std::int64_t lit_frame,
                       FrameLight light, std::uint64_t non_finite, Seen& seen, core::Radiance& radiance,
                       ShadeCounts& counts) {
    EXPECTS(&frame.seen == &seen && light.size() == seen.tiles.size());
    frame_ = seen.visible.frame;
    Seen fresh;
    fresh.tiles = find(frame, light, lit_frame, radiance);
    if (std::all_of(tiles_.begin(), tiles_.end(), [](const auto& splits) { return splits.empty(); })) return;

    // Light what is not known,
    fresh.visible = core::Visible(seen.visible.frame, seen.visible.width(), seen.visible.height());
    fresh.emitted = seen.emitted;
    core::ToleranceMap tolerance = frame.tolerance;
    part_tolerances(seen, fresh, tolerance);
    FrameLight of_parts;
    ShadeCounts found;
    shade(frame.light_trees, frame.tracer, fresh, frame.eye, tolerance, {settings.limits, false}, found, nullptr,
          &of_parts);
    // put it where it belongs,
    parallel::for_each(seen.tiles.size(), [&](std::size_t t) {
        if (!tiles_[t].empty()) put_in(fresh.tiles[t], of_parts[t], t, seen.tiles[t], light[t]);
    });
    // and sum up anew.
    ShadeCounts summed;
    core::Radiance sum =
        shade(frame.light_trees, frame.tracer, seen, frame.eye, frame.tolerance, settings, summed, &light);
    sum.record_density = std::move(radiance.record_density);
    if (radiance.record_age.empty()) sum.record_age = sum.record_reuse = {};
    radiance = std::move(sum);
    // What the pixels show was counted before they were split.
    counts.gather_points += found.gather_points;
    counts.groups += found.groups;
    counts.shadow_rays += found.shadow_rays;
    counts.direct_clusters += found.direct_clusters;
    counts.indirect_clusters += found.indirect_clusters;
    if (summed.non_finite > non_finite) {
        counts.non_finite += summed.non_finite - non_finite;
        counts.first_non_finite = summed.first_non_finite;
    }
}

MovedPoints SteepLight::renumbered(MovedPoints moved, std::int64_t frame) const {
    if (frame_ != frame || tiles_.size() != moved.size()) return moved;
    for (std::size_t t = 0; t < moved.size(); ++t) {
        std::erase_if(moved[t], [&](const MovedPoint& m) { return find_split(tiles_[t], m.index) != nullptr; });
        auto split = tiles_[t].begin();
        std::uint32_t more = 0;
        for (MovedPoint& m : moved[t]) {
            for (; split != tiles_[t].end() && split->index < m.index; ++split) more += split->count - 1;
            m.index += more;
        }
    }
    return moved;
}

}  // namespace render2mpeg::renderer
