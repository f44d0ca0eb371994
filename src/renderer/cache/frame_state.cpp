#include "renderer/cache/frame_state.h"

#include <algorithm>

#include "renderer/cache/adaptive_rays.h"

namespace render2mpeg::renderer {

FrameState::FrameState(const LightingContext& lit_by, const scene::Snapshot& instant, const CutLimits& cut_limits,
                       FinalGather* final_gather, RecordStore& store, const OtherEye& left)
    : context(lit_by),
      snapshot(instant),
      limits(cut_limits),
      rays(final_gather),
      // Without rays tolerances are bounds (point_tolerances).
      allocation{final_gather != nullptr ? context.tolerance.typical : 0.0f, context.tolerance.means,
                 final_gather != nullptr ? context.tolerance.most_rays : 0.0f},
      records(store),
      other(left),
      grid(seen().visible.width(), seen().visible.height()),
      tiles(seen().tiles.size()) {
    limits.exact = false;
}

double FrameState::pilots_worth(const PointTolerance& tolerance) const {
    return allocation.typical > 0.0f ? allocation.worth(needs_by_share(tolerance)) / pilot_rays : 1.0;
}

std::optional<CacheQuery> FrameState::query_of(std::size_t t, std::size_t i) const {
    const GatherPoint& p = seen().tiles[t][i];
    if (p.reached_by_specular()) {
        // The way by mirrors and glass is about as long as the straight one.
        const float away = glm::distance(camera().position(), p.point.position);
        return CacheQuery{p,
                          tiles[t].tolerance[i],
                          middle_of(t, p),
                          camera().pixel_extent(away),
                          receives(p),
                          std::nullopt,
                          pilots_worth(tiles[t].tolerance[i]) < 1.0,
                          allocation.typical > 0.0f};
    }
    const auto on_picture = camera().project(p.point.position);
    if (!on_picture) return std::nullopt;
    const float extent = camera().pixel_extent(on_picture->depth);
    const auto eye = camera().has_eye() ? std::optional(camera().eye_of(p.point.position)) : std::nullopt;
    return CacheQuery{p,
                      tiles[t].tolerance[i],
                      on_picture->position,
                      extent,
                      receives(p),
                      eye,
                      pilots_worth(tiles[t].tolerance[i]) < 1.0,
                      allocation.typical > 0.0f};
}

glm::ivec2 FrameState::pixel_of(std::size_t tile, const GatherPoint& p) const {
    const int t = static_cast<int>(tile), across = seen().tiles_across();
    return {t % across * tile_size + p.pixel % tile_size, t / across * tile_size + p.pixel / tile_size};
}

std::size_t FrameState::area_of(std::size_t tile) const {
    const auto across = static_cast<std::size_t>(seen().tiles_across());
    return tile / across / area_tiles * static_cast<std::size_t>(areas_across()) + tile % across / area_tiles;
}

std::size_t FrameState::area_count() const {
    const int across = seen().tiles_across();
    const int down = (static_cast<int>(seen().tiles.size()) + across - 1) / std::max(across, 1);
    return static_cast<std::size_t>(areas_across() * ((down + area_tiles - 1) / area_tiles));
}

}  // namespace render2mpeg::renderer
