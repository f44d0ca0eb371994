#include "renderer/lights/photon_splat.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <optional>

#include "core/numeric.h"
#include "parallel/loops.h"

namespace render2mpeg::renderer {
namespace {

/// How alike photons and anchors must face.
constexpr float least_shared_facing = 0.5f;

/// Neighbours that are looked at for those that an anchor has: a photon's nearest seventeen are among those of the
/// nearest. chosen: three times as many as share.
constexpr int looked_at = 3 * shared_among;
static_assert(looked_at <= 64, "bit sets have 64 bits");

/// How far off its surface an anchor looks, in radii of its disc, the smaller of two: over bumps, mouldings and
/// carpets, not over walls. chosen: 2; at 0.5 anchors on cobbles lose so many neighbours that light gathers in
/// blotches.
constexpr float lift_radii = 2.0f;

constexpr std::uint32_t no_anchor = 0xffffffffu;

/// Anchors that are asked in turn whether they see a photon: more where none of those before does, since most are seen
/// by the nearest.
constexpr std::array<int, 3> asked = {1, 4, 32};

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

    /// One more than share at most.
    static constexpr int size = shared_among + 1;

  private:
    std::array<Neighbour, size> found_;
    int count_ = 0;
};

/// The way between two places that are lifted off their surfaces.
struct Way {
    glm::vec3 from, direction;
    float length;

    Way(const OrientedPoint& a, const OrientedPoint& b, float lift) : from(a.position + lift * a.normal) {
        const glm::vec3 way = b.position + lift * b.normal - from;
        length = glm::length(way);
        direction = length > 0.0f ? way / length : a.normal;
    }
    /// Past all that never moves.
    bool is_open(const RayTracer& scene) const {
        return !(length > 0.0f) || !scene.meets_static(from, direction, length);
    }
    /// Past what moves.
    bool is_free(const RayTracer& scene) const {
        return !(length > 0.0f) || !scene.meets_dynamic(from, direction, length);
    }
};

/// Parts 1 among the nearest by a kernel times the area that each stands for.
SplatWeights shares_of(const Nearest& near, std::span<const float> disc2) {
    SplatWeights shares;
    if (near.count() == 0) return shares;
    // The one beyond those that share says how far the kernel reaches, so that none comes or goes at once.
    const int count = std::min(near.count(), shared_among + 1);
    const float reach2 = near[count - 1].distance2 * (count <= shared_among ? 1.5f : 1.0f);
    shares.count = std::min(count, shared_among);
    float sum = 0;
    for (int k = 0; k < shares.count; ++k) {
        const auto i = static_cast<std::size_t>(k);
        shares.anchor[i] = near[k].point;
        const float kernel = std::max(0.0f, 1.0f - core::divide_or(near[k].distance2, reach2, 0.0f));
        shares.weight[i] = kernel * disc2[near[k].point];
        sum += shares.weight[i];
    }
    for (int k = 0; k < shares.count; ++k) {
        float& weight = shares.weight[static_cast<std::size_t>(k)];
        weight = core::divide_or(weight, sum, 1.0f / static_cast<float>(shares.count));
    }
    return shares;
}

}  // namespace

PhotonSplatter::PhotonSplatter(std::span<const AnchorPlace> places, const RayTracer& scene, std::size_t listed) {
    disc2_.reserve(places.size());
    for (std::size_t first = 0; first < places.size();) {
        std::vector<OrientedPoint> points;
        std::size_t last = first;
        while (last < places.size() && places[last].group == places[first].group) points.push_back(places[last++].rest);
        groups_.push_back({places[first].group, static_cast<std::uint32_t>(first), PointTree(points)});
        Group& group = groups_.back();
        for (const std::uint32_t i : group.tree.take_order()) {
            const AnchorPlace& place = places[first + i];
            disc2_.push_back(place.disc2);
            if (group.id != 0) mounts_.push_back({place.address, place.front});
        }
        if (group.id == 0) still_count_ = static_cast<std::uint32_t>(last);
        first = last;
    }
    if (still_count_ > 0) look_about(scene, listed);
}

OrientedPoint PhotonSplatter::rest(std::uint32_t anchor) const {
    if (anchor < still_count_) return groups_.front().tree[anchor];
    const auto after = std::upper_bound(groups_.begin(), groups_.end(), anchor,
                                        [](std::uint32_t i, const Group& group) { return i < group.first; });
    const Group& group = *std::prev(after);
    return group.tree[anchor - group.first];
}

/// Finds which neighbours each still anchor sees.
void PhotonSplatter::look_about(const RayTracer& scene, std::size_t listed) {
    const PointTree& still = groups_.front().tree;
    visible_.assign(still.size(), 0);
    std::vector<Neighbours> lists(still.size() <= listed ? still.size() : 0);
    std::vector<std::uint8_t> rays(still.size(), 0);
    parallel::for_ranges(visible_.size(), 64, [&](std::size_t first, std::size_t last) {
        std::array<Neighbour, looked_at> found;
        for (std::size_t i = first; i < last; ++i) {
            const int count = still.nearest(still[i], least_shared_facing, found);
            for (int k = 0, seen = 0; k < count && seen < Neighbours::most; ++k) {
                const std::uint32_t other = found[static_cast<std::size_t>(k)].point;
                if (other != i) {
                    ++rays[i];
                    const float lift = lift_between(static_cast<std::uint32_t>(i), other);
                    if (!Way(still[i], still[other], lift).is_open(scene)) continue;
                }
                visible_[i] |= std::uint64_t{1} << k;
                if (!lists.empty()) lists[i].anchor[static_cast<std::size_t>(lists[i].count++)] = other;
                ++seen;
            }
        }
    });
    for (const std::uint8_t n : rays) rays_ += n;
    neighbours_.swap(lists);
}

float PhotonSplatter::lift_between(std::uint32_t a, std::uint32_t b) const {
    return lift_radii * std::sqrt(std::min(disc2_[a], disc2_[b]));
}

PhotonSplatter::Neighbours PhotonSplatter::neighbours(std::uint32_t anchor) const {
    if (!neighbours_.empty()) return neighbours_[anchor];
    const PointTree& still = groups_.front().tree;
    std::array<Neighbour, looked_at> found;
    const int count = still.nearest(still[anchor], least_shared_facing, found);
    Neighbours list;
    for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k)
        if ((visible_[anchor] >> k & 1u) != 0) list.anchor[static_cast<std::size_t>(list.count++)] = found[k].point;
    return list;
}

OccludedNeighbours PhotonSplatter::occluded_neighbours(const RayTracer& scene) const {
    OccludedNeighbours found;
    if (visible_.empty() || !scene.has_dynamic_objects()) return found;
    found.hidden.assign(visible_.size(), 0);
    const PointTree& still = groups_.front().tree;
    std::vector<std::uint8_t> rays(visible_.size(), 0);
    parallel::for_ranges(found.hidden.size(), 64, [&](std::size_t first, std::size_t last) {
        for (auto i = static_cast<std::uint32_t>(first); i < last; ++i) {
            const Neighbours near = neighbours(i);
            for (int k = 0; k < near.count; ++k) {
                const std::uint32_t other = near.anchor[static_cast<std::size_t>(k)];
                if (other == i) continue;
                ++rays[i];
                if (!Way(still[i], still[other], lift_between(i, other)).is_free(scene))
                    found.hidden[i] |= std::uint32_t{1} << k;
            }
        }
    });
    for (const std::uint8_t n : rays) found.rays += n;
    return found;
}

std::size_t PhotonSplatter::bytes() const {
    std::size_t sum = disc2_.capacity() * sizeof(float) + mounts_.capacity() * sizeof(AnchorMount) +
                      visible_.capacity() * sizeof(std::uint64_t) + neighbours_.capacity() * sizeof(Neighbours);
    for (const Group& group : groups_) sum += group.tree.bytes();
    return sum;
}

/// The nearest still anchor that sees the place, past what moves where that counts, and facing alike if there is one;
/// where none of many does, one that nothing still hides, or the nearest of all.
std::uint32_t PhotonSplatter::nearest_in_sight(const OrientedPoint& at, const RayTracer& scene, bool past_dynamic,
                                               int& rays) const {
    const PointTree& tree = groups_.front().tree;
    std::array<Neighbour, asked.back()> found;
    std::optional<std::uint32_t> hidden;
    int next = 0;
    for (const int most : asked) {
        const std::span<Neighbour> some(found.data(), static_cast<std::size_t>(most));
        int count = tree.nearest(at, least_shared_facing, some);
        if (count == 0) count = tree.nearest(at, -2.0f, some);
        for (; next < count; ++next) {
            const std::uint32_t anchor = found[static_cast<std::size_t>(next)].point;
            const Way way(at, tree[anchor], lift_radii * std::sqrt(disc2_[anchor]));
            ++rays;
            if (!way.is_open(scene)) continue;
            if (!past_dynamic || way.is_free(scene)) return anchor;
            if (!hidden) hidden = anchor;
        }
        if (count < most) break;
    }

    // In a small room that something shuts there may be none that faces alike: rather one that does not, than outside.
    const std::uint32_t nearest = found[0].point;
    const int count = past_dynamic && hidden ? tree.nearest(at, -2.0f, found) : 0;
    for (const Neighbour& other : std::span(found.data(), static_cast<std::size_t>(count))) {
        const Way way(at, tree[other.point], lift_radii * std::sqrt(disc2_[other.point]));
        ++rays;
        if (way.is_open(scene) && way.is_free(scene)) return other.point;
    }
    return hidden.value_or(nearest);
}

/// Of the nearest anchor's neighbours those nearest to the photon itself, but for those that are hidden from that
/// anchor.
SplatWeights PhotonSplatter::share_among(const Neighbours& neighbours, std::uint32_t hidden,
                                         const OrientedPoint& at) const {
    const PointTree& still = groups_.front().tree;
    Nearest near;
    for (int k = 0; k < neighbours.count; ++k) {
        if ((hidden >> k & 1u) != 0) continue;
        const std::uint32_t anchor = neighbours.anchor[static_cast<std::size_t>(k)];
        const glm::vec3 d = still.position(anchor) - at.position;
        near.add({glm::dot(d, d), anchor});
    }
    return shares_of(near, disc2_);
}

/// Whether two places that face alike can be parts of one surface: neither lies far behind the other, as the inside of
/// a lantern does behind the outside of its far wall.
bool may_be_one_surface(const OrientedPoint& a, const OrientedPoint& b) {
    const glm::vec3 way = b.position - a.position;
    // Places on a ball that face as little alike as least_shared_facing allows lie half their distance behind each
    // other. chosen: 0.6 of it, a little more.
    const float behind = -0.6f * glm::length(way);
    return glm::dot(way, a.normal) >= behind && -glm::dot(way, b.normal) >= behind;
}

/// Of a group that moves.
SplatWeights PhotonSplatter::share_among_alike(std::uint32_t id, const OrientedPoint& at) const {
    const auto place = std::lower_bound(groups_.begin(), groups_.end(), id,
                                        [](const Group& other, std::uint32_t wanted) { return other.id < wanted; });
    if (place == groups_.end() || place->id != id) return {};
    const Group& group = *place;
    // Half of those that are looked at are mostly enough.
    std::array<Neighbour, looked_at> found;
    const std::span<Neighbour> some(found.data(), looked_at / 2);
    Nearest near;
    const auto take = [&](int count) {
        near = {};
        for (int k = 0; k < count; ++k) {
            const Neighbour& n = found[static_cast<std::size_t>(k)];
            if (may_be_one_surface(at, group.tree[n.point])) near.add({n.distance2, group.first + n.point});
        }
    };
    int count = group.tree.nearest(at, least_shared_facing, some);
    take(count);
    if (near.count() == Nearest::size) return shares_of(near, disc2_);
    if (count == static_cast<int>(some.size())) count = group.tree.nearest(at, least_shared_facing, found);
    if (count == 0) {
        // None faces that way: its light goes where the nearest of all does.
        group.tree.nearest(at, -2.0f, {found.data(), 1});
        const OrientedPoint other = group.tree[found[0].point];
        count = group.tree.nearest({at.position, other.normal}, least_shared_facing, found);
    }
    take(count);
    // No light is lost: where none fits, the nearest takes it.
    if (near.count() == 0) near.add({found[0].distance2, group.first + found[0].point});
    return shares_of(near, disc2_);
}

/// Finds the shares of photons in the order of their nearest anchors: those with the same one share its neighbours,
/// which are looked up once.
void PhotonSplatter::share(std::span<const Placed> placed, std::span<const PhotonHit> photons,
                           const OccludedNeighbours* occluded, std::span<SplatWeights> shares) const {
    parallel::for_ranges(placed.size(), 256, [&](std::size_t first, std::size_t last) {
        Neighbours list;
        std::uint32_t hidden = 0;
        for (std::size_t i = first; i < last; ++i) {
            const PhotonHit& photon = photons[placed[i].photon];
            if (placed[i].nearest == no_anchor) {
                shares[i] = share_among_alike(photon.group, photon.at);
                continue;
            }
            if (i == first || placed[i].nearest != placed[i - 1].nearest) {
                list = neighbours(placed[i].nearest);
                hidden = occluded != nullptr ? occluded->hidden[placed[i].nearest] : 0;
            }
            shares[i] = share_among(list, hidden, photon.at);
        }
    });
}

std::uint64_t PhotonSplatter::splat(std::span<const PhotonHit> photons, const RayTracer& scene,
                                    const OccludedNeighbours* occluded, std::span<glm::dvec3> light) const {
    if (occluded != nullptr && occluded->hidden.empty()) occluded = nullptr;
    std::vector<Placed> placed(photons.size());
    std::vector<std::uint8_t> rays(photons.size(), 0);
    parallel::for_ranges(photons.size(), 256, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            int traced = 0;
            placed[i] = {no_anchor, static_cast<std::uint32_t>(i)};
            if (photons[i].group == 0 && still_count_ > 0)
                placed[i].nearest = nearest_in_sight(photons[i].at, scene, occluded != nullptr, traced);
            rays[i] = static_cast<std::uint8_t>(traced);
        }
    });
    std::sort(placed.begin(), placed.end());

    // Some at a time, since shares are large; added in that order, whatever thread found them.
    constexpr std::size_t some = 1u << 14;
    std::vector<SplatWeights> shares(std::min(some, placed.size()));
    for (std::size_t done = 0; done < placed.size(); done += some) {
        const std::span<const Placed> next = std::span(placed).subspan(done, std::min(some, placed.size() - done));
        share(next, photons, occluded, shares);
        for (std::size_t i = 0; i < next.size(); ++i)
            for (std::size_t k = 0; k < static_cast<std::size_t>(shares[i].count); ++k) {
                const auto share = static_cast<double>(shares[i].weight[k]);
                light[shares[i].anchor[k]] += share * glm::dvec3(photons[next[i].photon].light);
            }
    }
    return std::accumulate(rays.begin(), rays.end(), std::uint64_t{0});
}

}  // namespace render2mpeg::renderer
