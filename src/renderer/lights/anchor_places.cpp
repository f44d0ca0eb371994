#include "renderer/lights/anchor_places.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "core/box.h"
#include "core/numeric.h"
#include "parallel/loops.h"
#include "renderer/base/lobe.h"

namespace render2mpeg::renderer {
namespace {

/// Neighbours that an area is estimated by, and how alike they must face. chosen: 12 and 60 degrees; 6 are noisy, 24
/// and 48 blur edges (in Sponza what is clamped changes by a tenth between 6 and 48).
constexpr int neighbours = 12;
constexpr float least_facing = 0.5f;

/// Share of anchors that lie where light is rather than evenly over surfaces.
constexpr double flux_share = 0.5;

/// Share of anchors that lie evenly over all surfaces, lit or not: light that comes where none of the instants looked
/// must find anchors near. chosen: a sixteenth, one for every 2 m of a path of 500 m, of 4,096; at an eighth errors
/// against the path tracer are 19 % instead of 18 in many_lamps, alike in colonnade.
constexpr double even_share = 0.0625;

/// A part of what is still that is due this share of an anchor gets one. chosen: a tenth; a part without any would give
/// its light to surfaces that face another way.
constexpr double least_due = 0.1;

/// Candidates of one group that face one way, and how many anchors they are due.
struct Part {
    std::vector<std::uint32_t> candidates;
    double measure = 0;
    bool lit = false;
    int count = 0;
};

/// Which of six ways a normal points.
int facing(glm::vec3 normal) {
    const glm::vec3 a = glm::abs(normal);
    const int axis = a.x >= a.y && a.x >= a.z ? 0 : a.y >= a.z ? 1 : 2;
    return 2 * axis + (normal[axis] < 0.0f ? 1 : 0);
}

class StratifiedSampler {
  public:
    StratifiedSampler(const std::vector<AnchorCandidate>& candidates, std::vector<double> measure)
        : candidates_(candidates), measure_(std::move(measure)) {}

    /// Parts [first, last) into `count` strata of equal measure and takes the middle of each.
    void choose(std::uint32_t* first, std::uint32_t* last, int count, std::vector<std::uint32_t>& out) const {
        count = std::min(count, static_cast<int>(last - first));
        if (count <= 0) return;
        if (count == 1) {
            out.push_back(middle_of(first, last));
            return;
        }
        const int axis = longest(first, last);
        std::uint32_t* const at = cut(first, last, axis, static_cast<double>(count / 2) / count);
        // No side is due more than it has.
        const auto left = std::clamp<std::ptrdiff_t>(count / 2, std::max<std::ptrdiff_t>(1, count - (last - at)),
                                                     std::min<std::ptrdiff_t>(count - 1, at - first));
        choose(first, at, static_cast<int>(left), out);
        choose(at, last, count - static_cast<int>(left), out);
    }

  private:
    double sum(const std::uint32_t* first, const std::uint32_t* last) const {
        double s = 0;
        for (; first != last; ++first) s += measure_[*first];
        return s;
    }

    int longest(const std::uint32_t* first, const std::uint32_t* last) const {
        core::Box box;
        for (const std::uint32_t* i = first; i != last; ++i) box.hold(candidates_[*i].rest.position);
        return box.longest_axis();
    }

    /// Orders the range along an axis about the place where `share` of the measure lies before; at least one candidate
    /// is on either side.
    std::uint32_t* cut(std::uint32_t* first, std::uint32_t* last, int axis, double share) const {
        const auto before = [&](std::uint32_t a, std::uint32_t b) {
            const float pa = candidates_[a].rest.position[axis], pb = candidates_[b].rest.position[axis];
            return pa != pb ? pa < pb : a < b;
        };
        double wanted = share * sum(first, last);
        std::uint32_t *low = first, *high = last;
        while (high - low > 1) {
            std::uint32_t* const middle = low + (high - low) / 2;
            std::nth_element(low, middle, high, before);
            const double left = sum(low, middle);
            if (left >= wanted) {
                high = middle;
            } else {
                wanted -= left;
                low = middle;
            }
        }
        return std::clamp(high, first + 1, last - 1);
    }

    std::uint32_t middle_of(const std::uint32_t* first, const std::uint32_t* last) const {
        glm::dvec3 centre(0);
        double all = 0;
        for (const std::uint32_t* i = first; i != last; ++i) {
            const double m = measure_[*i] + 1e-30;
            centre += m * glm::dvec3(candidates_[*i].rest.position);
            all += m;
        }
        centre /= all;
        std::uint32_t best = *first;
        double least = 1e300;
        for (const std::uint32_t* i = first; i != last; ++i) {
            const glm::dvec3 d = glm::dvec3(candidates_[*i].rest.position) - centre;
            const double distance2 = glm::dot(d, d);
            if (distance2 < least || (distance2 == least && *i < best)) {
                least = distance2;
                best = *i;
            }
        }
        return best;
    }

    const std::vector<AnchorCandidate>& candidates_;
    std::vector<double> measure_;
};

/// How many anchors each candidate is due, but for a factor: a share of its own area and flux in all.
std::vector<double> measures(const std::vector<AnchorCandidate>& candidates) {
    std::map<std::uint32_t, std::vector<std::uint32_t>> groups;
    double even = 0;
    for (std::uint32_t i = 0; i < candidates.size(); ++i) {
        if (candidates[i].even)
            ++even;
        else
            groups[candidates[i].group].push_back(i);
    }
    const double followed = even > 0 ? 1.0 - even_share : 1.0;
    std::vector<double> area(candidates.size());
    double all_area = 0, all_flux = 0;
    for (const auto& [group, members] : groups) {
        std::vector<OrientedPoint> places;
        for (const std::uint32_t i : members) places.push_back(candidates[i].rest);
        const std::vector<float> areas = cell_areas(places, 0.0f);
        for (std::size_t k = 0; k < members.size(); ++k) {
            const AnchorCandidate& c = candidates[members[k]];
            area[members[k]] = static_cast<double>(areas[k]) * c.area_scale * c.importance;
            all_area += area[members[k]];
            all_flux += static_cast<double>(c.flux) * c.importance;
        }
    }
    std::vector<double> measure(candidates.size());
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        const AnchorCandidate& c = candidates[i];
        const double by_area = core::divide_or(area[i], all_area, 0.0),
                     by_flux = core::divide_or(static_cast<double>(c.flux) * c.importance, all_flux, 0.0);
        measure[i] = c.even ? even_share / even : followed * ((1.0 - flux_share) * by_area + flux_share * by_flux);
    }
    return measure;
}

/// Gives every part its share of the anchors; groups that move at least one, and one for each way that light comes
/// from, as far as half of all anchors serve for that.
void allot(std::map<std::pair<std::uint32_t, int>, Part>& parts, int count) {
    double passed = 0, given = 0;
    std::map<std::uint32_t, int> of_group;
    int lit_ways = 0;
    for (auto& [key, part] : parts) {
        passed += part.measure * count;
        part.count = static_cast<int>(std::max(0.0, std::floor(passed + 0.5) - given));
        given += part.count;
        of_group[key.first] += part.count;
        lit_ways += key.first != 0 && part.lit ? 1 : 0;
    }
    for (auto& [key, part] : parts) {
        const bool moves = key.first != 0;
        const bool due = part.measure * count >= least_due || (moves && part.lit && lit_ways <= count / 2);
        if (part.count > 0 || (!due && (!moves || of_group[key.first] > 0))) continue;
        part.count = 1;
        ++of_group[key.first];
    }
}

}  // namespace

std::vector<float> cell_areas(const std::vector<OrientedPoint>& points, float alone) {
    PointTree tree(points);
    // In the tree's order neighbours are near in memory, too.
    const std::vector<std::uint32_t> order = tree.take_order();
    std::vector<float> areas(points.size());
    parallel::for_ranges(points.size(), 256, [&](std::size_t first, std::size_t last) {
        std::array<Neighbour, neighbours> found;
        for (std::size_t i = first; i < last; ++i) {
            const int count = tree.nearest(tree[i], least_facing, found);
            // The circle through the farthest holds the others, and half of it.
            const float circle = count > 1 ? found[static_cast<std::size_t>(count - 1)].distance2 : 0.0f;
            areas[order[i]] =
                count > 1 ? std::numbers::pi_v<float> * circle / (static_cast<float>(count) - 0.5f) : alone;
        }
    });
    return areas;
}

std::vector<AnchorPlace> choose_places(const std::vector<AnchorCandidate>& candidates, int count) {
    const std::vector<double> measure = measures(candidates);
    std::map<std::pair<std::uint32_t, int>, Part> parts;
    std::map<std::uint32_t, float> extent2;
    for (std::uint32_t i = 0; i < candidates.size(); ++i) {
        extent2[candidates[i].group] = candidates[i].extent2;
        Part& part = parts[{candidates[i].group, facing(candidates[i].rest.normal)}];
        part.candidates.push_back(i);
        part.measure += measure[i];
        part.lit = part.lit || candidates[i].flux > 0.0f;
    }
    allot(parts, count);

    const StratifiedSampler sampler(candidates, measure);
    std::vector<AnchorPlace> places;
    for (auto& [key, part] : parts) {
        std::vector<std::uint32_t> chosen;
        sampler.choose(part.candidates.data(), part.candidates.data() + part.candidates.size(), part.count, chosen);
        for (const std::uint32_t i : chosen) {
            const AnchorCandidate& c = candidates[i];
            places.push_back({c.address, c.front, c.rest, c.group, 0.0f});
        }
    }

    // Anchors of one group lie together: their discs are the share of surface about each.
    for (std::size_t first = 0; first < places.size();) {
        std::size_t last = first;
        std::vector<OrientedPoint> rest;
        const float alone = extent2.at(places[first].group);
        while (last < places.size() && places[last].group == places[first].group) rest.push_back(places[last++].rest);
        const std::vector<float> areas = cell_areas(rest, alone);
        for (std::size_t i = first; i < last; ++i) places[i].disc2 = areas[i - first] * lobe::inverse_pi;
        first = last;
    }
    return places;
}

}  // namespace render2mpeg::renderer
