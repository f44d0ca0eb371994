#pragma once
// State of a frame while the irradiance cache lights it.
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "renderer/cache/cache_counts.h"
#include "renderer/cache/cache_query.h"
#include "renderer/cache/other_eye.h"
#include "renderer/cache/receiver.h"
#include "renderer/cache/request_groups.h"
#include "renderer/cut/lighting_context.h"
#include "renderer/cut/shade.h"
#include "renderer/gather/final_gather.h"

namespace render2mpeg::renderer {

/// Distances, in pixels, of the lattices on which a frame's points are lit, the coarsest first. chosen: 2 and 1 of
/// {4, 2, 1}, {2, 1} and {1} (docs/measurements.md#irradiance-cache).
inline constexpr int lattices[] = {2, 1};

/// How far a gather point has come.
enum class PointState : std::uint8_t {
    open,
    failed,  ///< queried the cache in vain, and no record came near since
    done,    ///< its light is known
    reused,  ///< likewise: from the frame before
};

/// Points of a pixel that share the light of one of them (shared_points.h).
struct SharedStratum {
    std::uint32_t gathered = 0;         ///< whose light is gathered
    std::vector<std::uint32_t> points;  ///< it and the others
    bool goes_on = false;               ///< the next of the like points before it
};

/// State of a tile's gather points; lists have one entry per point, in the tile's order.
struct TileState {
    std::vector<PointTolerance> tolerance;
    std::vector<PointState> state;
    std::vector<PointLight> light;    ///< of trees
    std::vector<PointLight> exact;    ///< of lights that are gathered one by one
    std::vector<SharedLight> shared;  ///< two eyes: of the left one to be told, of the right one as it was; else empty
    std::vector<SharedStratum> strata;
    std::uint64_t served = 0;
};

/// A point that became a record in this frame.
struct NewRecord {
    PointRef point;
    std::uint32_t pool = 0;  ///< GatherRequest::pool
    std::uint32_t record = 0;
    PointLight trees;  ///< light of light trees
};

/// A frame while it is lit: what it is lit by, and how far it is. A stage is a free function; the order of stages is
/// IrradianceCache::light.
struct FrameState {
    FrameState(const LightingContext& context, const scene::Snapshot& snapshot, const CutLimits& limits,
               FinalGather* rays, RecordStore& records, const OtherEye& other);

    const LightingContext context;
    const scene::Snapshot& snapshot;
    CutLimits limits;             ///< without exact lights
    FinalGather* const rays;      ///< gathers the sky and indirect light; null: light trees hold them
    const Allocation allocation;  ///< of rays

    RecordStore& records;
    const OtherEye& other;         ///< of the right eye the left one; else empty
    RecordGrid grid;               ///< of them
    std::vector<TileState> tiles;  ///< light so far
    std::vector<NewRecord> fresh;
    ShadeCounts shade_counts;
    CacheCounts counts;

    const Frame& seen() const { return context.seen; }
    const scene::Camera& camera() const { return snapshot.camera; }
    bool is_of(scene::Eye eye) const { return camera().lens().eye == eye; }
    const GatherPoint& point(const PointRef& r) const { return seen().tiles[r.tile][r.index]; }
    /// None for points that no picture shows, which does not happen but by rounding.
    std::optional<CacheQuery> query_of(std::size_t tile, std::size_t point) const;
    /// Rays that a point is worth by its share of its pixel, over those of a pilot: below 1 it is one of a crowd. 1
    /// where tolerances are bounds.
    double pilots_worth(const PointTolerance& tolerance) const;
    glm::ivec2 pixel_of(std::size_t tile, const GatherPoint& p) const;
    glm::vec2 middle_of(std::size_t tile, const GatherPoint& p) const { return glm::vec2(pixel_of(tile, p)) + 0.5f; }
    /// Whether it lies on a lattice of so many pixels.
    bool on_lattice(std::size_t tile, const GatherPoint& p, int lattice) const {
        const glm::ivec2 pixel = pixel_of(tile, p);
        return pixel.x % lattice == 0 && pixel.y % lattice == 0;
    }

    /// Groups of area_tiles x area_tiles tiles.
    int areas_across() const { return (seen().tiles_across() + area_tiles - 1) / area_tiles; }
    std::size_t area_of(std::size_t tile) const;
    std::size_t area_count() const;
};

}  // namespace render2mpeg::renderer
