// Flat lamps: convex polygons.
#include "core/box.h"
#include "renderer/lights/area_lamps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <type_traits>
#include <utility>

#include "core/error.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "renderer/base/lobe.h"

namespace render2mpeg::renderer {
namespace {

constexpr std::size_t most_corners = std::extent_v<decltype(LampView::edges)>;

/// Clipping a convex polygon by a plane adds one corner at most.
constexpr std::size_t most_clipped = 16;

/// Below this share of the product of its ends' lengths, an edge spans no angle that double precision could tell.
constexpr double no_angle = 1e-12;

/// Edges that belong to one triangle alone: for each corner where the outline goes from there.
std::map<std::uint32_t, std::uint32_t> outline_of(const scene::Mesh& mesh, const std::vector<std::uint32_t>& welded,
                                                  bool& simple) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    for (const glm::uvec3 t : mesh.triangles)
        for (int k = 0; k < 3; ++k) ++edges[{welded[t[k]], welded[t[(k + 1) % 3]]}];
    std::map<std::uint32_t, std::uint32_t> next;
    simple = true;
    for (const auto& [edge, count] : edges) {
        if (count > 1) simple = false;
        if (edges.contains({edge.second, edge.first})) continue;
        if (!next.emplace(edge.first, edge.second).second) simple = false;
    }
    return next;
}

bool is_flat(const scene::Mesh& mesh, glm::vec3 normal, float size) {
    for (const glm::uvec3 t : mesh.triangles) {
        if (!(glm::dot(wound_normal(mesh, t), normal) > 0)) return false;
        for (int k = 0; k < 3; ++k) {
            const glm::vec3 off = mesh.positions[t[k]] - mesh.positions[mesh.triangles.front().x];
            if (std::abs(glm::dot(off, normal)) > 0.01f * shape_error * size) return false;
        }
    }
    return true;
}

bool is_parallelogram(const std::vector<glm::vec3>& c) {
    return c.size() == 4 && glm::length(c[0] + c[2] - c[1] - c[3]) <= 1e-4f * glm::length(c[2] - c[0]);
}

/// A place on a convex polygon of this area, evenly.
glm::vec3 on_polygon(const std::vector<glm::vec3>& c, float area, glm::vec2 u) {
    float left = 2.0f * u.x * area;
    for (std::size_t i = 2; i < c.size(); ++i) {
        const glm::vec3 a = c[i - 1] - c[0], b = c[i] - c[0];
        const float part = glm::length(glm::cross(a, b));
        if (left > part && i + 1 < c.size()) {
            left -= part;
            continue;
        }
        const glm::vec2 uv = core::sample_triangle({core::divide_or(std::min(left, part), part, 0.0f), u.y});
        return c[0] + uv.x * a + uv.y * b;
    }
    return c[0];
}

/// A function of its own, since a loop of lanes within one of corners does not become vector code.
RENDER2MPEG_CLONES
void lower(const Vec3Lanes& __restrict edge, const Vec3Lanes& __restrict direction, Lanes& __restrict least) {
    for (int i = 0; i < lane_count; ++i) least[i] = inlined::min(least[i], dot(edge, direction, i));
}

/// Parallelograms keep the strata. Density by solid angle of a place at distance d on a plane at height h: d^2 / (area
/// h / d).
RENDER2MPEG_CLONES
void choose_on_polygon(const std::vector<glm::vec3>& c, bool even, float area, const LampView& __restrict view,
                       const SampleNumbers& __restrict u, LampSamples& __restrict samples) {
    Vec3Lanes place;
    if (even) {
        const glm::vec3 a = c[1] - c[0], b = c[3] - c[0];
        for (int i = 0; i < lane_count; ++i) {
            place.x[i] = c[0].x + u.x[i] * a.x + u.y[i] * b.x;
            place.y[i] = c[0].y + u.x[i] * a.y + u.y[i] * b.y;
            place.z[i] = c[0].z + u.x[i] * a.z + u.y[i] * b.z;
        }
    } else {
        for (int i = 0; i < lane_count; ++i) put(place, i, on_polygon(c, area, {u.x[i], u.y[i]}));
    }
    for (int i = 0; i < lane_count; ++i) {
        const float x = place.x[i] - view.places.x[i], y = place.y[i] - view.places.y[i];
        const float z = place.z[i] - view.places.z[i];
        const float inverse = 1.0f / inlined::sqrt(inlined::max(x * x + y * y + z * z, lobe::tiny));
        samples.direction.x[i] = x * inverse;
        samples.direction.y[i] = y * inverse;
        samples.direction.z[i] = z * inverse;
        samples.inverse_density[i] = area * inlined::abs(view.distance[i]) * inverse * inverse * inverse;
    }
}

RENDER2MPEG_CLONES
void meet_polygon(glm::vec3 normal, float area, std::size_t corners, const LampView& __restrict view,
                  LampSamples& __restrict samples) {
    const float nx = normal.x, ny = normal.y, nz = normal.z;
    alignas(64) Lanes least;
    for (int i = 0; i < lane_count; ++i) {
        const float slope = nx * samples.direction.x[i] + ny * samples.direction.y[i] + nz * samples.direction.z[i];
        least[i] = view.distance[i] < 0.0f ? slope : -slope;
        const float height2 = inlined::max(view.distance[i] * view.distance[i], lobe::tiny);
        samples.inverse_density[i] = area * inlined::abs(slope * slope * slope) / height2;
    }
    for (std::size_t k = 0; k < corners; ++k) lower(view.edges[k], samples.direction, least);
    for (int i = 0; i < lane_count; ++i)
        samples.inverse_density[i] = least[i] > 0.0f ? samples.inverse_density[i] : 0.0f;
}

RENDER2MPEG_CLONES
void aim_at_polygon(glm::vec3 normal, float clearance, const LampView& __restrict view,
                    const Vec3Lanes& __restrict direction, Vec3Lanes& __restrict targets) {
    const float nx = normal.x, ny = normal.y, nz = normal.z;
    for (int i = 0; i < lane_count; ++i) {
        const float slope = nx * direction.x[i] + ny * direction.y[i] + nz * direction.z[i];
        const float far = inlined::abs(view.distance[i]) / inlined::max(inlined::abs(slope), lobe::tiny);
        const float lift = view.distance[i] < 0.0f ? -clearance : clearance;
        targets.x[i] = view.places.x[i] + far * direction.x[i] + lift * nx;
        targets.y[i] = view.places.y[i] + far * direction.y[i] + lift * ny;
        targets.z[i] = view.places.z[i] + far * direction.z[i] + lift * nz;
    }
}

class PolygonLamp final : public AreaLamp {
  public:
    PolygonLamp(std::vector<glm::vec3> corners, bool two_sided, const LampPose& pose)
        : corners_(std::move(corners)),
          normal_(pose.normal),
          clearance_(pose.clearance),
          two_sided_(two_sided),
          even_(is_parallelogram(corners_)) {
        glm::vec3 across(0);
        for (std::size_t i = 2; i < corners_.size(); ++i)
            across += glm::cross(corners_[i - 1] - corners_[0], corners_[i] - corners_[0]);
        area_ = 0.5f * glm::length(across);
    }

    float irradiance(glm::vec3 place, glm::vec3 normal) const override {
        const bool in_front = glm::dot(glm::dvec3(place) - glm::dvec3(corners_.front()), glm::dvec3(normal_)) > 0;
        return in_front || two_sided_ ? static_cast<float>(polygon_irradiance(corners_, place, normal)) : 0.0f;
    }
    bool is_round() const override { return false; }
    void look(LampView& view) const override {
        const std::vector<glm::vec3>& c = corners_;
        EXPECTS(c.size() <= most_corners);
        for (int i = 0; i < lane_count; ++i) {
            const glm::vec3 place = view.places.at(i);
            view.distance[i] = glm::dot(place - c[0], normal_);
            for (std::size_t k = 0; k < c.size(); ++k) {
                // The next corners but one lie within.
                const glm::vec3 across = glm::cross(c[k] - place, c[(k + 1) % c.size()] - place);
                const float side = glm::dot(across, c[(k + 2) % c.size()] - place);
                put(view.edges[k], i, side < 0 ? -across : across);
            }
        }
    }
    void choose(const LampView& view, const SampleNumbers& numbers, LampSamples& samples) const override {
        choose_on_polygon(corners_, even_, area_, view, numbers, samples);
    }
    void meet(const LampView& view, LampSamples& samples) const override {
        meet_polygon(normal_, area_, corners_.size(), view, samples);
    }
    void aim(const LampView& view, const Vec3Lanes& direction, Vec3Lanes& targets) const override {
        aim_at_polygon(normal_, clearance_, view, direction, targets);
    }
    bool has_area() const { return area_ > 0 && std::isfinite(area_); }

  private:
    std::vector<glm::vec3> corners_;  ///< convex, in order, world
    glm::vec3 normal_;                ///< unit, of its front
    float clearance_, area_ = 0;
    bool two_sided_, even_;  ///< even_: a parallelogram, which keeps the strata
};

}  // namespace

double polygon_irradiance(std::span<const glm::vec3> corners, glm::vec3 place, glm::vec3 normal) {
    EXPECTS_DEBUG(corners.size() + 1 < most_clipped);
    const glm::dvec3 x(place), n(normal);
    // Keep what is above the horizon.
    std::array<glm::dvec3, most_clipped> above;
    std::size_t count = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const glm::dvec3 a = glm::dvec3(corners[i]) - x, b = glm::dvec3(corners[(i + 1) % corners.size()]) - x;
        const double height_a = glm::dot(n, a), height_b = glm::dot(n, b);
        if (height_a > 0) above[count++] = a;
        if ((height_a > 0) != (height_b > 0)) above[count++] = a + (b - a) * (height_a / (height_a - height_b));
    }
    double sum = 0;
    for (std::size_t i = 0; count >= 3 && i < count; ++i) {
        const glm::dvec3 a = above[i], b = above[(i + 1) % count], across = glm::cross(a, b);
        const double sine = glm::length(across);
        if (sine <= no_angle * glm::length(a) * glm::length(b)) continue;
        sum += std::atan2(sine, glm::dot(a, b)) / sine * glm::dot(across, n);
    }
    return std::min(0.5 * std::abs(sum), std::numbers::pi);
}

std::vector<glm::vec3> convex_outline(const scene::Mesh& mesh) {
    if (mesh.triangles.empty() || mesh.triangles.size() > 4096) return {};
    const float size = glm::length(core::Box::about(mesh.positions).size());
    const glm::vec3 normal = core::normalize_or(wound_normal(mesh, mesh.triangles.front()), glm::vec3(0));
    if (normal == glm::vec3(0) || !is_flat(mesh, normal, size)) return {};
    const std::vector<std::uint32_t> welded = scene::weld(mesh);
    bool simple = true;
    const auto next = outline_of(mesh, welded, simple);
    if (!simple || next.empty()) return {};
    // One loop, which takes in all open edges.
    std::vector<glm::vec3> loop;
    std::uint32_t at = next.begin()->first;
    do {
        loop.push_back(mesh.positions[at]);
        const auto found = next.find(at);
        if (found == next.end()) return {};
        at = found->second;
    } while (at != next.begin()->first && loop.size() <= next.size());
    if (loop.size() != next.size()) return {};
    // Corners turn left; points on a straight edge are none.
    std::vector<glm::vec3> corners;
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const glm::vec3 in = loop[i] - loop[(i + loop.size() - 1) % loop.size()],
                        out = loop[(i + 1) % loop.size()] - loop[i];
        const float turn = glm::dot(glm::cross(in, out), normal), straight = 1e-4f * glm::length(in) * glm::length(out);
        if (turn < -straight) return {};
        if (turn > straight) corners.push_back(loop[i]);
    }
    return corners.size() >= 3 && corners.size() <= most_corners ? corners : std::vector<glm::vec3>{};
}

LampShape polygon_shape(const scene::Mesh& mesh, bool two_sided, bool) {
    const std::vector<glm::vec3> outline = convex_outline(mesh);
    if (outline.empty()) return {};
    return [outline, two_sided](const LampPose& pose) -> std::shared_ptr<AreaLamp> {
        std::vector<glm::vec3> corners;
        for (const glm::vec3& corner : outline) corners.push_back(glm::vec3(pose.to_world * glm::vec4(corner, 1)));
        auto lamp = std::make_shared<PolygonLamp>(std::move(corners), two_sided, pose);
        return lamp->has_area() ? lamp : nullptr;
    };
}

}  // namespace render2mpeg::renderer
