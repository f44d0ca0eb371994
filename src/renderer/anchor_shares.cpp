#include "renderer/anchor_shares.h"

#include <algorithm>
#include <cmath>

#include "core/numeric.h"
#include "parallel/loops.h"

namespace render2mpeg::renderer {
namespace {

/// How alike photons and anchors must face.
constexpr float least_facing = 0.5f;

/// Neighbours that every anchor keeps, and how many are looked at for them: a photon's nearest seventeen are among
/// those of the nearest. chosen: twice and three times as many as share.
constexpr int kept = 2 * shared_among, looked_at = 3 * shared_among;

/// How far off its surface an anchor looks, in radii of its disc, the smaller of two: over bumps, mouldings and
/// carpets, not over walls. chosen: 2; at 0.5 anchors on cobbles lose so many neighbours that light gathers in
/// blotches.
constexpr float lift_radii = 2.0f;

/// Anchors that are asked in turn whether they see a photon.
constexpr int asked = 4;

/// More anchors than these lie closer together than walls are thick; their neighbours are not looked for by rays.
constexpr std::size_t most_tested = 1u << 16;

/// The nearest so far, nearest first.
class Nearest {
  public:
    void add(Neighbour n) {
        if (count_ == size && n.distance2 >= found_[size - 1].distance2) return;
        int i = count_ < size ? count_++ : size - 1;
        for (; i > 0 && n.distance2 < found_[static_cast<std::size_t>(i - 1)].distance2; --i)
            found_[static_cast<std::size_t>(i)] = found_[static_cast<std::size_t>(i - 1)];
        found_[static_cast<std::size_t>(i)] = n;
    }
    int count() const { return count_; }
    const Neighbour& operator[](int i) const { return found_[static_cast<std::size_t>(i)]; }

    /// One more than share: it says how far the kernel reaches, so that none comes or goes at once.
    static constexpr int size = shared_among + 1;

  private:
    std::array<Neighbour, size> found_;
    int count_ = 0;
};

}  // namespace

AnchorSharing::AnchorSharing(std::span<const AnchorPlace> places, const scene::Animation& film, const RayTracer& scene)
    : film_(&film) {
    for (std::size_t first = 0; first < places.size();) {
        std::vector<OrientedPoint> points;
        std::size_t last = first;
        while (last < places.size() && places[last].group == places[first].group) points.push_back(places[last++].rest);
        groups_.emplace(places[first].group, Group{static_cast<std::uint32_t>(first), PointTree(std::move(points))});
        first = last;
    }

    tested_ = groups_.contains(0) && groups_.at(0).tree.size() <= most_tested;
    std::vector<std::vector<std::uint32_t>> lists(places.size());
    parallel::for_ranges(places.size(), 64, [&](std::size_t first, std::size_t last) {
        std::array<Neighbour, looked_at> found;
        for (std::size_t i = first; i < last; ++i) {
            const Group& group = groups_.at(places[i].group);
            const int count = group.tree.nearest(places[i].rest, least_facing, found);
            for (int k = 0; k < count && lists[i].size() < kept; ++k) {
                const std::uint32_t other = group.first + found[static_cast<std::size_t>(k)].point;
                const bool near =
                    other == i || places[i].group != 0 || !tested_ ||
                    see_each_other(places[i].rest, places[other].rest,
                                   lift_radii * std::sqrt(std::min(places[i].disc2, places[other].disc2)), scene);
                if (near) lists[i].push_back(other);
            }
        }
    });
    for (std::size_t i = 0; i < places.size(); ++i) {
        const auto first = static_cast<std::uint32_t>(neighbours_.size());
        neighbours_.insert(neighbours_.end(), lists[i].begin(), lists[i].end());
        anchors_.push_back({places[i].rest, places[i].disc2, first, static_cast<std::uint32_t>(neighbours_.size())});
    }
}

/// Whether nothing still is between two places, both lifted off their surfaces.
bool AnchorSharing::see_each_other(const OrientedPoint& a, const OrientedPoint& b, float lift,
                                   const RayTracer& scene) const {
    const glm::vec3 from = a.position + lift * a.normal, way = b.position + lift * b.normal - from;
    const float distance = glm::length(way);
    if (!(distance > 0.0f)) return true;
    const Hit hit = scene.nearest(from, way / distance, distance);
    return !hit.found() || film_->objects[hit.address.object].mobility != scene::Mobility::still;
}

/// The nearest anchor that sees the place, or the nearest of all where none of some does.
std::uint32_t AnchorSharing::nearest(std::uint32_t group, const OrientedPoint& at, const RayTracer& scene) const {
    const Group& here = groups_.at(group);
    std::array<Neighbour, asked> found;
    int count = here.tree.nearest(at, least_facing, found);
    if (count == 0) count = here.tree.nearest(at, -2.0f, found);
    for (int k = 0; group == 0 && tested_ && k < count; ++k) {
        const std::uint32_t anchor = here.first + found[static_cast<std::size_t>(k)].point;
        const float lift = lift_radii * std::sqrt(anchors_[anchor].disc2);
        if (see_each_other(at, anchors_[anchor].rest, lift, scene)) return anchor;
    }
    return here.first + found[0].point;
}

AnchorShares AnchorSharing::share(std::uint32_t group, const OrientedPoint& at, const RayTracer& scene) const {
    AnchorShares shares;
    if (!groups_.contains(group)) return shares;

    // Of the nearest anchor's neighbours take those nearest to the photon itself.
    const Anchor& anchor = anchors_[nearest(group, at, scene)];
    Nearest near;
    for (std::uint32_t n = anchor.first_neighbour; n < anchor.last_neighbour; ++n) {
        const Anchor& other = anchors_[neighbours_[n]];
        const glm::vec3 d = other.rest.position - at.position;
        if (glm::dot(other.rest.normal, anchor.rest.normal) > least_facing) near.add({glm::dot(d, d), neighbours_[n]});
    }
    const bool all = near.count() < Nearest::size;
    const float reach2 = near[near.count() - 1].distance2 * (all ? 1.5f : 1.0f);
    shares.count = std::min(near.count(), shared_among);
    float sum = 0;
    for (int k = 0; k < shares.count; ++k) {
        const auto i = static_cast<std::size_t>(k);
        shares.anchor[i] = near[k].point;
        const float kernel = std::max(0.0f, 1.0f - core::divide_or(near[k].distance2, reach2, 0.0f));
        shares.weight[i] = kernel * anchors_[near[k].point].disc2;
        sum += shares.weight[i];
    }
    for (int k = 0; k < shares.count; ++k) {
        float& weight = shares.weight[static_cast<std::size_t>(k)];
        weight = core::divide_or(weight, sum, 1.0f / static_cast<float>(shares.count));
    }
    return shares;
}

}  // namespace render2mpeg::renderer
