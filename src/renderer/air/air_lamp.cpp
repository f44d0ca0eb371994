// Single scattering along a ray: equiangular places about a lamp [Kulla2012], places by transmittance under a sun.
// Changed: no random numbers. One place in each cell asks for the shadow; where two differ, the shadow's edge between
// them is found by halving; lit parts are integrated by two points of Gauss in each cell, which changes smoothly along
// motion.
#include "renderer/air/air_lamp.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>

#include "core/numeric.h"
#include "renderer/cut/shadow_rays.h"

namespace render2mpeg::renderer {
namespace {

constexpr float endless = std::numeric_limits<float>::infinity();
constexpr int most_cells = 16;

/// Behind air of this optical depth nothing is looked for: a share of 6e-6.
constexpr float deepest = 12.0f;

/// Parts of a segment under a sun, each with as many places as a lamp's whole segment: a sun's light is even over long
/// distances, its shadows are not. chosen: 4; with 1 shafts between pillars have steps.
constexpr int sun_parts = 4;

/// Halvings between two places, one lit and one not. chosen: 5, so that an edge lies within 1/32 of a cell.
constexpr int halvings = 5;

/// Segment of a ray past a lamp, by the parameter in which its light is even: the angle at the lamp, or the share of
/// light lost.
class LampSegment {
  public:
    LampSegment(const FogMedium& air, const LightPoint& lamp, const AirRay& ray) : air_(air), lamp_(lamp), ray_(ray) {
        const float end = std::min(ray.ends.back(), air.distance_at(ray.origin, ray.direction, deepest));
        if (lamp.is_far()) {
            phase_ = phase(air.anisotropy(), glm::dot(lamp.normal, -ray.direction));
            last_ = parameter(end);
            return;
        }
        const glm::vec3 to_lamp = lamp.position - ray.origin;
        nearest_ = glm::dot(to_lamp, ray.direction);
        const glm::vec3 off = to_lamp - nearest_ * ray.direction;
        const float apart = std::sqrt(glm::dot(off, off));
        apart_ = std::max(
            {apart, std::sqrt(lamp.disc2), ray.width * std::abs(nearest_), 1e-6f * glm::length(to_lamp), 1e-12f});
        float from = 0, to = end;
        if (lamp.range > 0.0f) {
            const float half = core::sqrt_or_zero(lamp.range * lamp.range - apart * apart);
            from = std::max(from, nearest_ - half);
            to = std::min(to, nearest_ + half);
        }
        clip_to_cone(from, to);
        if (!(to > from)) return;
        first_ = parameter(from);
        last_ = parameter(to);
    }

    /// One of so many equal parts of it.
    LampSegment part(int index, int parts) const {
        LampSegment segment = *this;
        const float step = (last_ - first_) / static_cast<float>(parts);
        segment.first_ = first_ + static_cast<float>(index) * step;
        segment.last_ = index + 1 == parts ? last_ : segment.first_ + step;
        return segment;
    }

    bool is_dark() const { return !(last_ > first_); }
    float first() const { return first_; }
    float last() const { return last_; }

    float parameter(float distance) const {
        if (lamp_.is_far()) return -std::expm1(-air_.optical_depth(ray_.origin, ray_.direction, distance));
        return std::atan2(distance - nearest_, apart_);
    }
    float distance(float parameter) const {
        if (lamp_.is_far())
            return air_.distance_at(ray_.origin, ray_.direction, -std::log1p(-std::min(parameter, 1.0f)));
        return std::max(nearest_ + apart_ * std::tan(parameter), 0.0f);
    }
    glm::vec3 place(float distance) const {
        return ray_.origin + std::min(distance, std::numeric_limits<float>::max()) * ray_.direction;
    }

    /// Radiance by intensity and unit of the parameter.
    float scattered(float parameter) const {
        const float far = distance(parameter);
        if (!std::isfinite(far)) return 0.0f;
        const glm::vec3 x = place(far);
        if (lamp_.is_far()) return phase_ * std::exp(-air_.depth_to_sky(x, -lamp_.normal));
        const glm::vec3 from_lamp = x - lamp_.position;
        const float distance2 = glm::dot(from_lamp, from_lamp), length = std::sqrt(distance2);
        const glm::vec3 direction = from_lamp / std::max(length, 1e-20f);
        const float depth = air_.optical_depth(ray_.origin, ray_.direction, far) +
                            air_.optical_depth(lamp_.position, direction, length);
        return lamp_.emitted(direction, distance2) * air_.extinction(x.y) *
               phase(air_.anisotropy(), -std::sin(parameter)) * std::exp(-depth) / apart_;
    }

    /// Ray i of the packet: from this place to the lamp.
    void aim(float parameter, int i, ShadowPacket& packet) const {
        const glm::vec3 x = place(distance(parameter)), segment = lamp_.is_far() ? -lamp_.normal : lamp_.position - x;
        packet.origin_x[i] = x.x;
        packet.origin_y[i] = x.y;
        packet.origin_z[i] = x.z;
        packet.direction_x[i] = segment.x;
        packet.direction_y[i] = segment.y;
        packet.direction_z[i] = segment.z;
        // A round lamp's own surface is no obstacle.
        const float before = core::divide_or(std::sqrt(lamp_.disc2), glm::length(segment), 1.0f);
        packet.far[i] = lamp_.is_far() ? endless : std::clamp(1.0f - before, 0.0f, shadow_ray_end);
    }

    /// Share that volumes leave of light from the lamp to a place, and from there to the ray's origin.
    glm::vec3 left_by_volumes(const Air& air, float parameter) const {
        const float far = distance(parameter);
        const glm::vec3 x = place(far), way = lamp_.is_far() ? -lamp_.normal : lamp_.position - x;
        const float length = glm::length(way);
        return glm::exp(-air.depth_of_volumes(ray_.origin, ray_.direction, far) -
                        air.depth_of_volumes(x, way / std::max(length, 1e-20f), lamp_.is_far() ? endless : length));
    }

  private:
    /// Leaves of [from, to] what lies in the cone of a spot.
    void clip_to_cone(float& from, float& to) const {
        const float cosine = lamp_.spot.outer_cosine();
        if (!(cosine > 0.0f && cosine < 1.0f)) return;
        // (w + t d) a = cosine |w + t d|, in double, since both roots matter.
        const glm::dvec3 w = ray_.origin - lamp_.position, d = ray_.direction, a = lamp_.normal;
        const double c2 = static_cast<double>(cosine) * cosine, da = glm::dot(d, a), wa = glm::dot(w, a);
        const double qa = da * da - c2, qb = wa * da - c2 * glm::dot(w, d), qc = wa * wa - c2 * glm::dot(w, w);
        const double root = qb * qb - qa * qc;
        const auto inside = [&](double t) {
            const glm::dvec3 p = w + t * d;
            return glm::dot(p, a) > cosine * glm::length(p);
        };
        if (!(root > 0.0) || qa == 0.0) {
            if (!inside(nearest_ + 1e-3 * apart_)) to = from;
            return;
        }
        const double s = std::sqrt(root);
        double t1 = (-qb - s) / qa, t2 = (-qb + s) / qa;
        if (t1 > t2) std::swap(t1, t2);
        // Of the three parts one is lit: cones are convex.
        if (inside(0.5 * (t1 + t2))) {
            from = std::max(from, static_cast<float>(t1));
            to = std::min(to, static_cast<float>(t2));
        } else if (inside(t2 + std::max(1.0, std::abs(t2)))) {
            from = std::max(from, static_cast<float>(t2));
        } else if (inside(t1 - std::max(1.0, std::abs(t1)))) {
            to = std::min(to, static_cast<float>(t1));
        } else {
            to = from;
        }
    }

    const FogMedium& air_;
    const LightPoint& lamp_;
    const AirRay& ray_;
    float nearest_ = 0, apart_ = 1;  ///< the place nearest to the lamp, and its distance from it
    float phase_ = 0;                ///< suns
    float first_ = 0, last_ = 0;
};

/// Lit parts of a segment: runs about places that are asked, with the transmittance of layers. Places are the middles
/// of equal cells.
class LitRuns {
  public:
    LitRuns(const AirScene& scene, const LampSegment& segment, int cells) : segment_(segment), cells_(cells) {
        for (int i = 0; i < cells; ++i) at_.push_back(border(i) + 0.5f * (border(i + 1) - border(i)));
        passes_.assign(at_.size(), glm::vec3(1));
        lit_.resize(at_.size());
        ask(scene);
        find_borders(scene);
    }

    std::uint64_t rays() const { return rays_; }
    bool is_dark() const { return std::find(lit_.begin(), lit_.end(), true) == lit_.end(); }

    /// Light arriving at a place: that of the queried place that no border separates from it.
    glm::vec3 passes(float parameter) const {
        const auto i = std::upper_bound(borders_.begin(), borders_.end(), parameter) - borders_.begin();
        return lit_[static_cast<std::size_t>(i)] ? passes_[static_cast<std::size_t>(i)] : glm::vec3(0);
    }
    /// Adds where integrals must begin anew.
    void add_cuts(std::vector<float>& cuts) const {
        for (int i = 0; i <= cells_; ++i) cuts.push_back(border(i));
        cuts.insert(cuts.end(), borders_.begin(), borders_.end());
    }

  private:
    float border(int i) const {
        if (i == cells_) return segment_.last();
        return segment_.first() +
               (segment_.last() - segment_.first()) * static_cast<float>(i) / static_cast<float>(cells_);
    }
    /// Whether a shadow begins or ends after place i.
    bool differs(std::size_t i) const { return lit_[i] != lit_[i + 1]; }

    void ask(const AirScene& scene) {
        const std::size_t count = at_.size();
        ShadowPacket packet;
        packet.bodies = scene.bodies;
        packet.active = (1u << count) - 1u;
        for (std::size_t i = 0; i < count; ++i) segment_.aim(at_[i], static_cast<int>(i), packet);
        std::array<glm::vec3, most_cells> passes;
        passes.fill(glm::vec3(1));
        const std::uint32_t dark = scene.tracer.occluded(packet, passes.data());
        for (std::size_t i = 0; i < count; ++i) {
            lit_[i] = (dark >> i & 1u) == 0;
            passes_[i] = passes[i];
            if (lit_[i] && !scene.air.volumes().empty()) passes_[i] *= segment_.left_by_volumes(scene.air, at_[i]);
        }
        rays_ += count;
    }

    /// Between all places: a shadow's edge where they differ, else halfway.
    void find_borders(const AirScene& scene) {
        std::vector<std::size_t> edges;
        for (std::size_t i = 0; i + 1 < at_.size(); ++i) {
            borders_.push_back(0.5f * (at_[i] + at_[i + 1]));
            if (differs(i)) edges.push_back(i);
        }
        if (!edges.empty()) find_edges(scene, edges);
    }

    void find_edges(const AirScene& scene, std::span<const std::size_t> edges) {
        std::array<float, most_cells> low{}, high{};
        for (std::size_t k = 0; k < edges.size(); ++k) {
            low[k] = at_[edges[k]];
            high[k] = at_[edges[k] + 1];
        }
        for (int turn = 0; turn < halvings; ++turn) {
            ShadowPacket packet;
            packet.bodies = scene.bodies;
            packet.active = (1u << edges.size()) - 1u;
            for (std::size_t k = 0; k < edges.size(); ++k)
                segment_.aim(0.5f * (low[k] + high[k]), static_cast<int>(k), packet);
            const std::uint32_t dark = scene.tracer.occluded(packet, nullptr);
            rays_ += edges.size();
            for (std::size_t k = 0; k < edges.size(); ++k) {
                const bool as_low = ((dark >> k & 1u) == 0) == lit_[edges[k]];
                (as_low ? low : high)[k] = 0.5f * (low[k] + high[k]);
            }
        }
        for (std::size_t k = 0; k < edges.size(); ++k) borders_[edges[k]] = 0.5f * (low[k] + high[k]);
    }

    const LampSegment& segment_;
    int cells_;
    std::vector<float> at_;  ///< places, rising
    std::vector<bool> lit_;
    std::vector<glm::vec3> passes_;
    std::vector<float> borders_;  ///< between a place and the next
    std::uint64_t rays_ = 0;
};

/// By two points of Gauss.
float integral(const LampSegment& segment, float from, float to) {
    const float middle = 0.5f * (from + to), half = 0.5f * (to - from);
    const float off = half * std::numbers::inv_sqrt3_v<float>;
    return half * (segment.scattered(middle - off) + segment.scattered(middle + off));
}

/// Adds the light that one part of a segment scatters before each end, in the segment's parameter.
void add_part(const LampSegment& segment, const LitRuns& runs, const std::vector<float>& ends, glm::vec3 strength,
              glm::vec3* sums) {
    std::vector<float> cuts;
    cuts.reserve(2 * most_cells + ends.size() + 1);
    runs.add_cuts(cuts);
    for (const float end : ends) cuts.push_back(std::clamp(end, segment.first(), segment.last()));
    std::sort(cuts.begin(), cuts.end());
    glm::vec3 sum(0);
    std::size_t end = 0;
    for (std::size_t i = 0; i < cuts.size(); ++i) {
        for (; end < ends.size() && ends[end] <= cuts[i]; ++end) sums[end] += strength * sum;
        if (i + 1 == cuts.size() || !(cuts[i + 1] > cuts[i])) continue;
        const glm::vec3 passes = runs.passes(0.5f * (cuts[i] + cuts[i + 1]));
        if (passes != glm::vec3(0)) sum += passes * integral(segment, cuts[i], cuts[i + 1]);
    }
    for (; end < ends.size(); ++end) sums[end] += strength * sum;
}

}  // namespace

std::vector<LightPoint> air_lamps(std::span<const LightPoint> points, const LightTrees& light_trees) {
    std::vector<LightPoint> lamps;
    std::copy_if(points.begin(), points.end(), std::back_inserter(lamps),
                 [](const LightPoint& p) { return p.is_of_lamp(); });
    for (const auto& whole : light_trees.lamps)
        if (const auto p = whole->ball()) lamps.push_back(*p);
    return lamps;
}

std::uint64_t add_scattered(const AirScene& scene, const LightPoint& lamp, const AirRay& ray, int cells,
                            glm::vec3* sums) {
    const LampSegment whole(*scene.air.fog(), lamp, ray);
    if (whole.is_dark()) return 0;
    std::vector<float> ends;
    for (const float end : ray.ends) ends.push_back(whole.parameter(end));
    const glm::vec3 strength = lamp.intensity * scene.air.fog()->albedo();
    const int parts = lamp.is_far() ? sun_parts : 1;
    std::uint64_t rays = 0;
    for (int p = 0; p < parts; ++p) {
        const LampSegment segment = whole.part(p, parts);
        const LitRuns runs(scene, segment, std::clamp(cells, 1, most_cells));
        rays += runs.rays();
        if (!runs.is_dark()) add_part(segment, runs, ends, strength, sums);
    }
    return rays;
}

}  // namespace render2mpeg::renderer
