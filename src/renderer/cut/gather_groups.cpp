#include "renderer/cut/gather_groups.h"

#include <algorithm>
#include <array>

namespace render2mpeg::renderer {
namespace {

/// Within a block. chosen: docs/measurements.md#lightcuts.
constexpr Likeness within_block{0.9f, 0.02f, 0.1f};

/// Of what blocks leave over. chosen: docs/measurements.md#lightcuts.
constexpr Likeness left_over{0.5f, 0.05f, 0.2f};

/// Adds a point to the first group of its block that takes it, or to a new one.
void assign(std::uint32_t index, int set, const GatherTile& tile, glm::vec3 eye, std::vector<GatherGroup>& groups) {
    for (GatherGroup& group : groups) {
        if (group.points.size() >= lane_count ||
            !share_surface(tile[group.points.front()], tile[index], eye, within_block))
            continue;
        group.points.push_back(index);
        return;
    }
    groups.push_back({{index}, set});
}

/// Lets points find groups of the tile that are not full, all or only those of their own set. Only the newest
/// `most_open` groups are asked, which bounds the time of a tile whose points are all unlike.
class Merger {
  public:
    Merger(const GatherTile& tile, glm::vec3 eye, bool own_set) : tile_(tile), eye_(eye), own_set_(own_set) {}

    void add(const GatherGroup& group) {
        for (const std::uint32_t index : group.points) {
            if (take(index, group.set)) continue;
            if (open_.size() == most_open) open_.erase(open_.begin());
            open_.push_back(groups_.size());
            groups_.push_back({{index}, group.set});
        }
    }
    std::vector<GatherGroup>& groups() { return groups_; }

  private:
    /// chosen: 64; tiles of real scenes have fewer.
    static constexpr std::size_t most_open = 64;

    bool take(std::uint32_t index, int set) {
        for (std::size_t k = 0; k < open_.size(); ++k) {
            GatherGroup& group = groups_[open_[k]];
            if ((own_set_ && group.set != set) ||
                !share_surface(tile_[group.points.front()], tile_[index], eye_, left_over))
                continue;
            group.points.push_back(index);
            if (group.points.size() == lane_count) open_.erase(open_.begin() + static_cast<std::ptrdiff_t>(k));
            return true;
        }
        return false;
    }

    const GatherTile& tile_;
    glm::vec3 eye_;
    bool own_set_;
    std::vector<GatherGroup> groups_;
    std::vector<std::size_t> open_;  ///< indices of groups
};

/// The pixels of a tile in blocks of sixteen that share a set: the places of one phase of a pattern of stride x stride
/// pixels, in an area of 4 stride x 4 stride.
struct Pattern {
    int stride, across;
    explicit Pattern(int sets) : stride(sets == representative_sets ? 2 : 1), across(tile_size / (4 * stride)) {}

    int set(int x, int y) const { return stride == 1 ? 0 : x % 2 + 2 * (y % 2); }
    std::size_t block(int x, int y) const {
        const int area = 4 * stride;
        return static_cast<std::size_t>((y / area * across + x / area) * stride * stride + set(x, y));
    }
};

}  // namespace

bool share_surface(const GatherPoint& first, const GatherPoint& other, glm::vec3 eye, const Likeness& likeness) {
    const SurfacePoint& a = first.point;
    const SurfacePoint& b = other.point;
    if (first.reached_by_specular() != other.reached_by_specular() || a.bsdf.has_glossy() != b.bsdf.has_glossy())
        return false;
    if (!(glm::dot(a.shading_normal, b.shading_normal) > likeness.least_normal)) return false;
    if (!(glm::dot(a.geometric_normal, b.geometric_normal) > likeness.least_normal)) return false;
    const float distance = glm::length(a.position - eye);
    const glm::vec3 between = b.position - a.position;
    return std::abs(glm::dot(between, a.geometric_normal)) <= likeness.largest_step * distance &&
           glm::dot(between, between) <= likeness.largest_gap * distance * likeness.largest_gap * distance;
}

int block_of(int pixel, int sets) {
    return static_cast<int>(Pattern(sets).block(pixel % tile_size, pixel / tile_size));
}

std::vector<GatherGroup> group_points(const GatherTile& tile, glm::vec3 eye, int sets) {
    const Pattern pattern(sets);
    std::array<std::vector<std::uint32_t>, tile_size * tile_size / lane_count> blocks;
    for (std::uint32_t i = 0; i < tile.size(); ++i)
        blocks[pattern.block(tile[i].pixel % tile_size, tile[i].pixel / tile_size)].push_back(i);
    // Group within blocks; then let the scattered small groups of the tile find each other, those of one set first, so
    // that packets are full.
    std::vector<GatherGroup> groups, small;
    for (const auto& block : blocks) {
        std::vector<GatherGroup> of_block;
        for (const std::uint32_t i : block)
            assign(i, pattern.set(tile[i].pixel % tile_size, tile[i].pixel / tile_size), tile, eye, of_block);
        for (GatherGroup& group : of_block)
            (group.points.size() >= large_group ? groups : small).push_back(std::move(group));
    }
    Merger of_set(tile, eye, true), of_any(tile, eye, false);
    for (const GatherGroup& group : small) of_set.add(group);
    for (GatherGroup& group : of_set.groups()) {
        if (group.points.size() >= large_group)
            groups.push_back(std::move(group));
        else
            of_any.add(group);
    }
    for (GatherGroup& group : of_any.groups()) groups.push_back(std::move(group));
    return groups;
}

}  // namespace render2mpeg::renderer
