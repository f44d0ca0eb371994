#pragma once
// Lights one frame through the irradiance cache: recall, interpolate, gather, keep.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/color.h"
#include "renderer/cache/light_parts.h"
#include "renderer/cache/record_cache.h"
#include "renderer/cache/record_gather.h"
#include "renderer/cache/record_square.h"

namespace render2mpeg::renderer {

/// One frame's way through the records: what they know already, what is gathered because they do not, and what of that
/// becomes records for later points and frames.
class FrameLighting {
  public:
    /// `parts` of the light trees' light, of which records hold what stays; none where they hold all of it.
    FrameLighting(const LightTrees& light_trees, const RayTracer& tracer, const Seen& seen,
                  const scene::Snapshot& snapshot, const CutLimits& limits, const RecordTrust& trust,
                  const LobeTrials& trials, Records& records, const LightParts* parts = nullptr)
        : whole_(light_trees),
          parts_(parts),
          light_trees_(parts != nullptr ? parts->still : light_trees),
          tracer_(tracer),
          seen_(seen),
          snapshot_(snapshot),
          camera_(snapshot.camera),
          limits_(limits),
          trust_(trust),
          trials_(trials),
          records_(records),
          map_(seen.visible.width(), seen.visible.height()),
          exact_(seen.tiles.size()),
          light_(seen.tiles.size()),
          tolerances_(seen.tiles.size()),
          state_(seen.tiles.size()),
          served_(seen.tiles.size(), 0),
          moved_points_(seen.tiles.size()),
          dynamic_objects_(seen.tiles.size()),
          moving_(seen.tiles.size()),
          firsts_(seen.tiles.size()),
          squares_(seen.tiles.size()) {
        limits_.exact = false;
        // Records keep their errors without error scale, which is learnt anew at a cut.
        trust_.noise *= limits.error_scale;
    }

    /// `moved`: things lie elsewhere than in the last frame, though records are what they were.
    void prepare(const core::ToleranceMap& tolerance, const RecordCache::LitTiles& last,
                 const MovedPoints& last_moved_points, std::int64_t last_frame, bool moved, ShadeCounts& counts);
    /// Serves or gathers what is not known yet, lattice by lattice; and some of what was served all the same, for
    /// `watch`.
    void refine(RecordWatch& known, ShadeCounts& counts, RecordCounts& record_counts);
    /// What things that move change of light, for all points.
    void add_movers(ShadeCounts& counts, RecordCounts& record_counts);
    void thin() { records_.thin(snapshot_.frame, map_); }
    /// Which materials' lobes were served, and which were not.
    void tell(LobeTrials& trials) const;
    FrameLight take(RecordCache::LitTiles& last, MovedPoints& moved, ShadeCounts& counts, RecordCounts& record_counts);

  private:
    /// Of pixels, on which points that are not known yet are gathered, the coarsest first.
    static constexpr int lattices[] = {4, 2, 1};

    /// Squares of pixels of one tile, no two of which overlap.
    class TileSquares {
      public:
        TileSquares() { cells_.fill(-1); }
        /// That a pixel lies in; none: null.
        const RecordSquare* at(int x, int y) const {
            const int i = cells_[cell(x, y)];
            return i < 0 ? nullptr : &squares_[static_cast<std::size_t>(i)];
        }
        void add(int x, int y, int side, const RecordSquare& square) {
            for (int v = y; v < y + side; v += least)
                for (int u = x; u < x + side; u += least)
                    cells_[cell(u, v)] = static_cast<std::int8_t>(squares_.size());
            squares_.push_back(square);
        }

      private:
        static constexpr int least = 2, across = tile_size / least;  ///< sides of the smallest; so many in a row
        static std::size_t cell(int x, int y) { return static_cast<std::size_t>(y / least * across + x / least); }
        std::array<std::int8_t, static_cast<std::size_t>(across* across)> cells_;
        std::vector<RecordSquare> squares_;
    };

    enum class PointState : std::uint8_t {
        open,
        in_vain,    ///< asked records, and none came since
        settled,    ///< its light is known
        elsewhere,  ///< likewise: at the place of a record in the same pixel
        between,    ///< likewise: by the corners of its square
        recalled,   ///< likewise, from the frame before
        watched     ///< likewise: records served it, and it was gathered all the same
    };

    bool recall(std::size_t tile, const RecordCache::LitTiles& last, const MovedPoints& last_moved_points,
                std::int64_t last_frame, bool moved);
    /// What moves has no records where light is parted.
    bool moves(const GatherPoint& p) const {
        return parts_ != nullptr &&
               snapshot_.animation->objects[p.point.address.object].mobility != scene::Mobility::still;
    }
    bool takes(const GatherPoint& p) const { return takes_records(p, trials_) && !moves(p); }
    bool is_between(std::size_t tile, std::size_t point, int lattice);
    bool corner(int x, int y, const GatherPoint& like, PointRef& found) const;
    std::vector<std::vector<PointRef>> wanting_movers(int lattice);
    void gather_movers(const std::vector<std::vector<PointRef>>& of_tile, ShadeCounts& counts);
    float allowed(std::size_t tile, std::size_t point) const;
    std::vector<std::vector<PointRef>> doubt_hidden();
    void gather_exact(std::size_t tile, ShadeCounts& counts);
    std::optional<RecordQuery> query_of(std::size_t tile, std::size_t point) const;
    std::optional<SquareCorner> served_corner(int x, int y, const SquareCorner* like) const;
    void find_squares(int side);
    void reopen(const std::vector<GatheredRequests>& of_area);
    std::vector<PointRef> wanting(std::size_t tile, int lattice);
    std::vector<std::vector<PointRef>> by_area(const std::vector<std::vector<PointRef>>& of_tile) const;
    std::vector<GatheredRequests> gather(const std::vector<std::vector<PointRef>>& of_tile, std::size_t least,
                                         ShadeCounts& counts) const;
    enum class Watch : std::uint8_t { early, late };  ///< before a first frame's last lattice; after it
    std::vector<std::vector<PointRef>> watched(Watch when, const RecordWatch& known, float& served_share) const;
    bool is_served(std::size_t tile, std::size_t point) const {
        const PointState state = state_[tile][point];
        return state == PointState::between || (state == PointState::settled && light_[tile][point].served);
    }
    void doubt_served();
    void watch(Watch when, RecordWatch& known, ShadeCounts& counts, RecordCounts& record_counts);
    void fill_lattice(int lattice, ShadeCounts& counts, RecordCounts& record_counts);
    std::optional<Record> record(const GatheredRequests& gathered, std::size_t i) const;
    void keep(const GatheredRequests& gathered, std::size_t i, RecordCounts& counts);
    int x_of(std::size_t tile, const GatherPoint& p) const {
        return static_cast<int>(tile) % seen_.tiles_across() * tile_size + p.pixel % tile_size;
    }
    int y_of(std::size_t tile, const GatherPoint& p) const {
        return static_cast<int>(tile) / seen_.tiles_across() * tile_size + p.pixel / tile_size;
    }
    int areas_across() const { return (seen_.tiles_across() + area_tiles - 1) / area_tiles; }
    std::size_t area_of(std::size_t tile) const {
        const auto across = static_cast<std::size_t>(seen_.tiles_across());
        return tile / across / area_tiles * static_cast<std::size_t>(areas_across()) + tile % across / area_tiles;
    }
    const GatherPoint& point(const PointRef& r) const { return seen_.tiles[r.tile][r.index]; }

    const LightTrees& whole_;
    const LightParts* parts_;
    const LightTrees& light_trees_;  ///< what records hold
    const RayTracer& tracer_;
    const Seen& seen_;
    const scene::Snapshot& snapshot_;
    const scene::Camera& camera_;
    CutLimits limits_;
    RecordTrust trust_;
    const LobeTrials& trials_;
    Records& records_;
    RecordMap map_;
    FrameLight exact_, light_;  ///< of lights gathered exactly; of trees
    std::vector<std::vector<PointTolerance>> tolerances_;
    std::vector<std::vector<PointState>> state_;
    std::vector<std::uint64_t> served_;  ///< by tile
    MovedPoints moved_points_;           ///< in any order
    enum class Moving : std::uint8_t {
        unknown,
        gathered,
        between,  ///< taken from points around
        recalled  ///< as in the frame before, with the exact light
    };
    FrameLight dynamic_objects_;                      ///< what they change
    std::vector<std::vector<Moving>> moving_;         ///< whether that is known
    std::vector<std::vector<std::uint32_t>> firsts_;  ///< of each pixel of a tile, its first point; and the end
    std::vector<TileSquares> squares_;
};

}  // namespace render2mpeg::renderer
