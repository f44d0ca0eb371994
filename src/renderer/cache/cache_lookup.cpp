// How a frame's points get their light (docs/model/irradiance-cache.md, "Order of a frame").
#include "renderer/cache/cache_lookup.h"

#include "core/color.h"
#include "core/numeric.h"
#include "core/standard_error.h"
#include "parallel/loops.h"
#include "renderer/cache/adaptive_rays.h"
#include "renderer/cache/gather_requests.h"
#include "renderer/cache/glossy_record.h"
#include "renderer/cache/shared_points.h"

namespace render2mpeg::renderer {
namespace {

/// On the coarser lattices an area of 64 x 64 pixels gathers only so many requests or more: fewer fill no packets, and
/// are asked again on the next. chosen: 128, the fastest of 0 to 128 (docs/measurements.md#irradiance-cache).
constexpr std::size_t least_dense = 128;

/// Light that the other eye has found at a point, where it changes little between its pixels and by the turn to this
/// eye.
std::optional<PointLight> light_of_other_eye(const ToldLight& told, const GatherPoint& p,
                                             const PointTolerance& tolerance) {
    if (!(told.light.error > 0.0f)) return std::nullopt;
    PointLight light;
    light.direct = told.light.direct;
    light.indirect = told.light.indirect;
    light.glossy = told.light.glossy;
    const float weight = core::luminance(p.weight),
                allowed = tolerance.allows_samples(core::luminance(light.scattered(p)));
    float turned = 0;
    if (p.point.bsdf.has_glossy())
        turned = turn_error * 0.5f * core::divide_or(glm::length(told.turn), p.point.bsdf.alpha, 1e6f) *
                 core::luminance(p.weight * light.glossy);
    if (!(told.spread <= allowed) || !(core::errors_of_one_in_hundred * turned <= allowed)) return std::nullopt;
    light.error = {weight * told.light.error + turned};
    light.shared = {weight * told.light.error_of_block};
    light.served = true;
    return light;
}

/// Lights one point by the cache, if that can.
bool look_up(FrameState& frame, std::size_t t, std::size_t i) {
    TileState& tile = frame.tiles[t];
    if (tile.state[i] != PointState::open) return false;
    auto query = frame.query_of(t, i);
    if (!query) return false;
    std::optional<PointLight> found;
    if (!frame.other.is_empty()) {
        const ToldLight told = frame.other.at(query->point, query->extent);
        found = light_of_other_eye(told, query->point, tile.tolerance[i]);
        query->other_error = told.light.error * core::luminance(query->point.weight);
    }
    if (!found)
        found = query_cache(*query, frame.grid, frame.records, frame.allocation, frame.limits.error_scale,
                            frame.snapshot.frame);
    tile.state[i] = found ? PointState::done : PointState::failed;
    if (found) tile.light[i] = *found;
    return found.has_value();
}

/// The record in the very place of a point that it failed.
std::uint32_t record_at(const FrameState& frame, std::size_t t, const GatherPoint& p) {
    const glm::ivec2 pixel = frame.pixel_of(t, p);
    for (const SurfaceMark& m : frame.grid.row(pixel.y, pixel.x, pixel.x)) {
        const IrradianceRecord& r = frame.records[m.record];
        if (r.address == p.point.address && r.back_side == p.point.back_side && r.path == p.path &&
            r.position == p.point.position && (r.lobe.alpha > 0.0f) == p.point.bsdf.has_glossy() &&
            (r.lobe.alpha == 0.0f || r.lobe.outgoing == p.point.outgoing))
            return m.record;
    }
    return PointRef::none;
}

/// Queries the cache for the points of a tile on a lattice; returns those that must be gathered.
std::vector<PointRef> look_up_tile(FrameState& frame, std::size_t t, int lattice) {
    TileState& tile = frame.tiles[t];
    std::vector<PointRef> requests;
    for (std::size_t i = 0; i < tile.state.size(); ++i) {
        const GatherPoint& p = frame.seen().tiles[t][i];
        if (tile.state[i] >= PointState::done || !frame.on_lattice(t, p, lattice)) continue;
        PointRef request{static_cast<std::uint32_t>(t), static_cast<std::uint32_t>(i)};
        if (uses_cache(p)) {
            if (look_up(frame, t, i)) {
                ++tile.served;
                continue;
            }
            request.record = record_at(frame, t, p);
        } else if (lattice > 1) {
            continue;
        }
        requests.push_back(request);
    }
    return requests;
}

/// New records have come to some areas: points that failed near them may query again.
void reopen_near(FrameState& frame, const std::vector<GatheredRequests>& of_area) {
    const int across = frame.areas_across(), down = static_cast<int>(of_area.size()) / std::max(across, 1);
    const auto is_new = [&](int x, int y) {
        return x >= 0 && y >= 0 && x < across && y < down &&
               !of_area[static_cast<std::size_t>(y * across + x)].points.empty();
    };
    for (std::size_t t = 0; t < frame.tiles.size(); ++t) {
        const auto area = static_cast<int>(frame.area_of(t));
        bool near = false;
        for (int k = 0; k < 9; ++k) near = near || is_new(area % across + k % 3 - 1, area / across + k / 3 - 1);
        if (!near) continue;
        for (PointState& state : frame.tiles[t].state)
            if (state == PointState::failed) state = PointState::open;
    }
}

}  // namespace

void light_lattice(FrameState& frame, int lattice) {
    // Ask the cache,
    frame.grid.extend(frame.records.all(), frame.camera());
    std::vector<std::vector<PointRef>> requests(frame.tiles.size());
    parallel::for_each(frame.tiles.size(), [&](std::size_t t) { requests[t] = look_up_tile(frame, t, lattice); });
    // else gather, and keep what was found as records.
    const std::vector<GatheredRequests> found = gather(frame, requests, lattice > 1 ? least_dense : 0);
    const std::size_t first = frame.fresh.size();
    keep(frame, found);
    if (frame.rays != nullptr) refine_rays(frame, first);
    reopen_near(frame, found);
}

void light_points(FrameState& frame) {
    for (const int lattice : lattices) light_lattice(frame, lattice);
    if (frame.rays != nullptr) reconstruct(frame);
    share_in_pixels(frame);
}

}  // namespace render2mpeg::renderer
