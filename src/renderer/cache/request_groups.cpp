#include "renderer/cache/request_groups.h"

#include <algorithm>
#include <bit>

#include "renderer/cut/gather_groups.h"
#include "renderer/tree/gather_lanes.h"

namespace render2mpeg::renderer {
namespace {

/// Requests lie farther apart than the pixels of a block. chosen: against looser ones
/// (docs/measurements.md#irradiance-cache).
constexpr Likeness first_pass{0.85f, 0.03f, 0.25f}, second_pass{0.5f, 0.1f, 0.4f};

/// Groups that a point is offered to, the newest.
constexpr std::size_t most_open = 48;

class Grouping {
  public:
    Grouping(const Frame& seen, glm::vec3 eye, const Likeness& likeness, bool own_set)
        : seen_(seen), eye_(eye), likeness_(likeness), own_set_(own_set) {}

    void add(const PointRef& p, int set) {
        for (std::size_t k = open_.size(); k-- > 0;) {
            RequestGroup& group = groups_[open_[k]];
            if ((own_set_ && group.set != set) ||
                !share_surface(point(group.points.front()), point(p), eye_, likeness_))
                continue;
            group.points.push_back(p);
            if (group.points.size() == lane_count) open_.erase(open_.begin() + static_cast<std::ptrdiff_t>(k));
            return;
        }
        if (open_.size() == most_open) open_.erase(open_.begin());
        open_.push_back(groups_.size());
        groups_.push_back({{p}, set});
    }
    std::vector<RequestGroup>& groups() { return groups_; }

  private:
    const GatherPoint& point(const PointRef& p) const { return seen_.tiles[p.tile][p.index]; }

    const Frame& seen_;
    glm::vec3 eye_;
    Likeness likeness_;
    bool own_set_;
    std::vector<RequestGroup> groups_;
    std::vector<std::size_t> open_;
};

/// Place on a curve that keeps neighbours together [Morton1966]; pixels of an area.
std::uint32_t curve(std::uint32_t x, std::uint32_t y) {
    std::uint32_t code = 0;
    for (unsigned bit = 0; bit < 6; ++bit) code |= (x >> bit & 1u) << (2 * bit) | (y >> bit & 1u) << (2 * bit + 1);
    return code;
}

}  // namespace

int record_set(int x, int y) {
    const auto parity = [](int v) { return std::popcount(static_cast<unsigned>(v) & 7u) & 1; };
    return parity(x) + 2 * parity(y);
}

std::vector<RequestGroup> group_requests(const Frame& seen, const std::vector<PointRef>& requests, glm::vec3 eye) {
    struct Placed {
        std::uint32_t code;
        int set;
        PointRef point;
    };
    // Follow a curve through the area, so that groups are compact.
    std::vector<Placed> placed;
    placed.reserve(requests.size());
    const auto across = static_cast<std::uint32_t>(seen.tiles_across());
    for (const PointRef& r : requests) {
        const std::uint32_t pixel = seen.tiles[r.tile][r.index].pixel;
        const std::uint32_t x = r.tile % across * tile_size + pixel % tile_size,
                            y = r.tile / across * tile_size + pixel / tile_size;
        placed.push_back({curve(x % 64, y % 64), record_set(static_cast<int>(x), static_cast<int>(y)), r});
    }
    std::stable_sort(placed.begin(), placed.end(), [](const Placed& a, const Placed& b) { return a.code < b.code; });
    Grouping of_set(seen, eye, first_pass, true), of_any(seen, eye, second_pass, false);
    for (const Placed& p : placed) of_set.add(p.point, p.set);
    std::vector<RequestGroup> groups;
    for (RequestGroup& group : of_set.groups()) {
        if (group.points.size() >= large_group)
            groups.push_back(std::move(group));
        else
            for (const PointRef& p : group.points) of_any.add(p, group.set);
    }
    for (RequestGroup& group : of_any.groups()) groups.push_back(std::move(group));
    return groups;
}

}  // namespace render2mpeg::renderer
