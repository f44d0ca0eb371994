// Round lamps: spheres that shine outwards.
#include "core/box.h"
#include "renderer/lights/area_lamps.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/numeric.h"

namespace render2mpeg::renderer {
namespace {

/// Fewer triangles are a body with corners, not a sphere.
constexpr std::size_t least_sphere_triangles = 200;

/// Solid angle of a triangle as seen from `centre` [VanOosterom1983].
double solid_angle(const scene::Mesh& mesh, glm::uvec3 t, glm::vec3 centre) {
    const glm::dvec3 a(mesh.positions[t.x] - centre), b(mesh.positions[t.y] - centre), c(mesh.positions[t.z] - centre);
    const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
    return 2 * std::atan2(glm::dot(a, glm::cross(b, c)),
                          la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb);
}

/// Whether a mesh is one sphere, whole and once.
bool find_sphere(const scene::Mesh& mesh, glm::vec3& centre, float& radius, float& outer) {
    if (mesh.triangles.size() < least_sphere_triangles) return false;
    const auto box = core::Box::about(mesh.positions);
    centre = box.middle();
    double area = 0, spanned = 0;
    float nearest = glm::length(box.size());
    outer = 0;
    for (const glm::uvec3 t : mesh.triangles) {
        const glm::vec3 normal = wound_normal(mesh, t);
        if (!(glm::dot(normal, mesh.positions[t.x] - centre) > 0)) return false;
        area += 0.5 * glm::length(normal);
        spanned += solid_angle(mesh, t, centre);
        for (int k = 0; k < 3; ++k) {
            const float r = glm::length(mesh.positions[t[k]] - centre);
            nearest = std::min(nearest, r);
            outer = std::max(outer, r);
        }
    }
    radius = static_cast<float>(std::sqrt(area / (4 * std::numbers::pi)));
    return outer - nearest <= shape_error * outer && radius > 0.98f * outer && radius <= outer &&
           std::abs(spanned - 4 * std::numbers::pi) < 1e-4 * 4 * std::numbers::pi;
}

/// Rays end where they enter the sphere.
RENDER2MPEG_CLONES
void aim_at_sphere(float outer, const LampView& __restrict view, const Vec3Lanes& __restrict direction,
                   Vec3Lanes& __restrict targets) {
    const float outer2 = outer * outer;
    for (int i = 0; i < lane_count; ++i) {
        const float far = view.distance[i], along = far * dot(view.cone.axis, direction, i);
        const float x = far * view.cone.axis.x[i] - along * direction.x[i],
                    y = far * view.cone.axis.y[i] - along * direction.y[i];
        const float z = far * view.cone.axis.z[i] - along * direction.z[i];
        const float within = inlined::sqrt(inlined::max(outer2 - (x * x + y * y + z * z), 0.0f));
        const float enters = inlined::max(along - within, 0.0f);
        targets.x[i] = view.places.x[i] + enters * direction.x[i];
        targets.y[i] = view.places.y[i] + enters * direction.y[i];
        targets.z[i] = view.places.z[i] + enters * direction.z[i];
    }
}

class SphereLamp final : public AreaLamp {
  public:
    SphereLamp(glm::vec3 centre, float radius, float clearance)
        : centre_(centre), radius_(radius), clearance_(clearance) {}

    float irradiance(glm::vec3 place, glm::vec3 normal) const override {
        const glm::dvec3 to_lamp = glm::dvec3(centre_) - glm::dvec3(place);
        const double distance = glm::length(to_lamp);
        if (!(distance > radius_)) return 0;
        const double sine = radius_ / distance;
        return static_cast<float>(cone_irradiance(glm::dot(to_lamp, glm::dvec3(normal)) / distance, sine * sine));
    }
    std::optional<LightPoint> ball() const override {
        LightPoint p;
        p.type = LightType::punctual;
        p.position = centre_;
        p.intensity = radiance * (std::numbers::pi_v<float> * radius_ * radius_);
        const float beyond = 1.01f * radius_ + clearance_;
        p.disc2 = beyond * beyond;
        return p;
    }
    void look(LampView& view) const override {
        for (int i = 0; i < lane_count; ++i) {
            const glm::vec3 to_lamp = centre_ - view.places.at(i);
            view.distance[i] = std::max(glm::length(to_lamp), radius_ * 1.0001f);
            span(view, i, core::normalize_or(to_lamp, {0, 0, 1}), radius_ / view.distance[i]);
        }
    }
    void aim(const LampView& view, const Vec3Lanes& direction, Vec3Lanes& targets) const override {
        aim_at_sphere(radius_ + clearance_, view, direction, targets);
    }

  private:
    glm::vec3 centre_;
    float radius_;  ///< of the true sphere
    float clearance_;
};

}  // namespace

std::shared_ptr<AreaLamp> sphere_lamp(glm::vec3 centre, float radius, float clearance) {
    return std::make_shared<SphereLamp>(centre, radius, clearance);
}

LampShape sphere_shape(const scene::Mesh& mesh, bool two_sided, bool stays_round) {
    glm::vec3 centre(0);
    float radius = 0, outer = 0;
    // Within a sphere that shines to both sides nothing is hidden from it: no lamp with an outline.
    if (two_sided || !stays_round || !find_sphere(mesh, centre, radius, outer)) return {};
    return [centre, radius, outer](const LampPose& pose) -> std::shared_ptr<AreaLamp> {
        const float scale = std::cbrt(std::abs(glm::determinant(glm::mat3(pose.to_world))));
        const float r = scale * radius;
        if (!(r * r > 0) || !std::isfinite(r * r)) return nullptr;
        return sphere_lamp(glm::vec3(pose.to_world * glm::vec4(centre, 1)), r,
                           pose.clearance + (scale * (1 + shape_error) * outer - r));
    };
}

}  // namespace render2mpeg::renderer
