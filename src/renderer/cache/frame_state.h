#pragma once
// State of a frame while the irradiance cache lights it.
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "renderer/cache/cache_counts.h"
#include "renderer/cache/cache_query.h"
#include "renderer/cache/receiver.h"
#include "renderer/cache/request_groups.h"
#include "renderer/cut/lighting_context.h"
#include "renderer/cut/shade.h"
#include "renderer/gather/final_gather.h"

namespace render2mpeg::renderer {

/// Distances, in pixels, of the lattices on which a frame's points are lit, the coarsest first.
inline constexpr int lattices[] = {4, 2, 1};

/// How far a gather point has come.
enum class PointState : std::uint8_t {
    open,
    failed,     ///< queried the cache in vain, and no record came near since
    done,       ///< its light is known
    at_record,  ///< likewise: at the place of a record in the same pixel
    reused,     ///< likewise: from the frame before
    held_out    ///< likewise: the cache served it, and it was gathered as well
};

/// State of a tile's gather points; lists have one entry per point, in the tile's order.
struct TileState {
    std::vector<PointTolerance> tolerance;
    std::vector<PointState> state;
    std::vector<PointLight> light;  ///< of trees
    std::vector<PointLight> exact;  ///< of lights that are gathered one by one
    std::vector<MovedPoint> moved;  ///< in any order
    std::uint64_t served = 0;

    /// Whether records of this frame's cache light the point at its own place.
    bool is_served(std::size_t i) const { return state[i] == PointState::done && light[i].served; }
    /// Forgets the light of a point that was served or reused.
    void reopen(std::size_t i) {
        state[i] = PointState::open;
        light[i] = {};
        --served;
    }
    /// Luminance that a point's light may be off by, as far as its light is known.
    float allowed(const GatherPoint& p, std::size_t i) const;
};

/// All that a frame's stages read and write. A stage is a free function; the order of stages is IrradianceCache::light.
struct FrameState {
    FrameState(const LightingContext& context, const scene::Snapshot& snapshot, const CutLimits& limits,
               const CacheErrorModel& errors, RecordStore& records, FinalGather* rays);

    const LightTrees& light_trees;
    FinalGather* rays;  ///< gathers the sky and indirect light; null: light trees hold them
    GatherAim aim;      ///< of them
    bool keeps_rays;    ///< of new records
    const RayTracer& tracer;
    const Frame& seen;
    const scene::Snapshot& snapshot;
    const scene::Camera& camera;
    CutLimits limits;
    CacheErrorModel errors;
    RecordStore& records;
    RecordGrid grid;
    std::vector<TileState> tiles;
    ShadeCounts shade_counts;
    CacheCounts counts;

    const GatherPoint& point(const PointRef& r) const { return seen.tiles[r.tile][r.index]; }
    /// None for points that no picture shows, which does not happen but by rounding.
    std::optional<CacheQuery> query_of(std::size_t tile, std::size_t point) const;
    glm::ivec2 pixel_of(std::size_t tile, const GatherPoint& p) const;
    /// Whether it lies on a lattice of so many pixels.
    bool on_lattice(std::size_t tile, const GatherPoint& p, int lattice) const {
        const glm::ivec2 pixel = pixel_of(tile, p);
        return pixel.x % lattice == 0 && pixel.y % lattice == 0;
    }

    /// Groups of area_tiles x area_tiles tiles.
    int areas_across() const { return (seen.tiles_across() + area_tiles - 1) / area_tiles; }
    std::size_t area_of(std::size_t tile) const;
    std::size_t area_count() const;
};

}  // namespace render2mpeg::renderer
