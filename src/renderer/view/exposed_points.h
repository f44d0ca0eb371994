#pragma once
// Gather points that only exposure finds: what tiles found, put together.
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

#include "renderer/view/expose.h"
#include "renderer/view/normal_spread.h"

namespace render2mpeg::renderer {

/// A gather point that the middle of the frame does not show.
struct NewPoint {
    GatherPoint point;
    float extent = 0;              ///< of a pixel there
    std::uint32_t tile = 0;        ///< where it is seen from the middle
    std::uint16_t source = 0;      ///< pixel of the tile that found it, its home where its cell is not exposed
    std::uint32_t found_tile = 0;  ///< that
    NormalSpread spread{};         ///< of all samples that it stands for
};

/// Marks places in TileExposure::points.
inline constexpr std::uint32_t is_new = 0x80000000u;

/// Results of one tile's samples. Points of contributions: an existing point's place in `tile`, or is_new and a place
/// in `points`.
struct TileExposure {
    struct Part {
        std::uint32_t tile, point;
        glm::vec3 weight, diffuse;
    };
    std::vector<Part> parts;
    std::vector<std::uint32_t> starts;  ///< empty: not exposed
    std::vector<NewPoint> points;
    std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> in_cell;  ///< `points` by cell_of
    ExposureCounts counts;
    SeenAir air;                    ///< of all pixels that were looked through
    std::vector<SeenMatte> mattes;  ///< likewise
    FibreTile fibres{};             ///< likewise

    static std::uint64_t cell_of(std::uint32_t tile, std::uint16_t pixel) {
        return std::uint64_t{tile} << 16 | std::uint64_t{pixel};
    }
    void add(NewPoint point) {
        in_cell[cell_of(point.tile, point.point.pixel)].push_back(static_cast<std::uint32_t>(points.size()));
        points.push_back(std::move(point));
    }
    void forget_from(std::size_t first_part, std::size_t first_point) {
        parts.resize(first_part);
        for (; points.size() > first_point; points.pop_back())
            in_cell[cell_of(points.back().tile, points.back().point.pixel)].pop_back();
    }
};

/// Puts new points among those of their tiles, one for each surface and pixel; says where each went.
class PointMerger {
  public:
    /// Points whose cells are not exposed move to the pixel that found them.
    PointMerger(std::vector<TileExposure>& found, const Exposure& exposure, Frame& seen);

    /// Of one tile, for all threads.
    void merge(std::size_t tile);

    /// A contribution's point: its tile and its place there.
    std::pair<std::uint32_t, std::uint32_t> of(std::size_t found_in, const TileExposure::Part& part) const;

  private:
    using Ref = std::pair<std::uint32_t, std::uint32_t>;  ///< a tile, and a place among its new points
    const NewPoint& point(const Ref& ref) const { return found_[ref.first].points[ref.second]; }
    void add(const std::vector<Ref>& more, std::size_t& next, GatherTile& merged);

    const std::vector<TileExposure>& found_;
    Frame& seen_;
    std::vector<std::vector<Ref>> of_tile_;
    std::vector<std::vector<std::uint32_t>> place_;  ///< of new points, by the tile that found them
    std::vector<std::vector<std::uint32_t>> moved_;  ///< where points that were there are now, by tile
};

}  // namespace render2mpeg::renderer
