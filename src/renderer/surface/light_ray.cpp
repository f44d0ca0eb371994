#include "renderer/surface/light_ray.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/numeric.h"
#include "core/sampling.h"

namespace render2mpeg::renderer {
namespace {

/// A direction that leaves a surface less than this above its geometric normal is lifted to it: bent normals must not
/// send it to the other side. chosen: above the rounding of the reflection; tried 1e-5..1e-2.
constexpr float least_leaving_cosine = 1e-3f;

constexpr float sharp_alpha = scene::mirror_roughness * scene::mirror_roughness;

/// The direction, kept on the side of `normal`.
glm::vec3 lifted(glm::vec3 direction, glm::vec3 normal, glm::vec3 otherwise) {
    const float cosine = glm::dot(direction, normal);
    if (!(cosine < least_leaving_cosine)) return direction;
    return core::normalize_or(direction + (least_leaving_cosine - cosine) * normal, otherwise);
}

}  // namespace

Hit LightRay::meet(const PosedScene& scene, float far) const {
    return scene.tracer().nearest(origin, direction, far, time);
}

glm::vec3 LightRay::left_by_bodies(const PosedScene& scene, const Hit& hit) {
    if (!scene.has_bodies()) return glm::vec3{1.0f};
    const std::uint32_t object = hit.address.object;
    const Medium* own = scene.medium_within(object);
    if (own != nullptr && !media.holds(object) &&
        glm::dot(scene.front_normal(object, hit.address.primitive), direction) > 0.0f)
        media.begin_inside(object, *own);
    return media.empty() ? glm::vec3{1.0f} : media.top()->passes(hit.distance);
}

glm::vec3 LightRay::left_by_air(const PosedScene& scene, float distance) const {
    const Air* air = scene.air();
    if (air == nullptr || !media.empty()) return glm::vec3(1);
    if (!from_far) return air->left_of_light(origin, direction, distance);
    return air->left_of_light(origin + distance * direction, -direction, std::numeric_limits<float>::infinity());
}

SurfacePoint LightRay::surface_at(const PosedScene& scene, const Hit& hit, const SurfaceFootprint& footprint,
                                  Holes holes) const {
    return scene.surface_in(media, band, hit.address, -direction, footprint, time, holes);
}

void LightRay::leave(const SurfacePoint& point, glm::vec3 to) {
    origin = offset_origin(point, to);
    direction = to;
    from_far = false;
}

void LightRay::pass(const PosedScene& scene, const SurfacePoint& point) {
    if (point.bounds_body)
        media.cross(point.address.object, *scene.medium_within(point.address.object), point.back_side);
    // Air in front of the layer has dimmed it already.
    origin = offset_origin(point, direction);
    from_far = false;
}

void LightRay::reflect(const SurfacePoint& point, glm::vec3 facet) {
    const glm::vec3 mirrored = 2.0f * glm::dot(facet, point.outgoing) * facet - point.outgoing;
    leave(point, lifted(core::normalize_or(mirrored, facet), point.geometric_normal, point.geometric_normal));
}

bool LightRay::refract(const PosedScene& scene, const SurfacePoint& point, glm::vec3 facet) {
    glm::vec3 to = refracted(-point.outgoing, facet, point.bsdf.ior);
    if (to == glm::vec3{0.0f}) to = refracted(-point.outgoing, point.shading_normal, point.bsdf.ior);
    if (to == glm::vec3{0.0f}) return false;
    media.cross(point.address.object, *scene.medium_within(point.address.object), point.back_side);
    leave(point, lifted(to, -point.geometric_normal, -point.outgoing));
    return true;
}

bool bends_light(const PosedScene& scene, const SurfacePoint& point) {
    return point.bounds_body && scene.animation().objects[point.address.object].body == scene::Body::solid;
}

glm::vec3 mirrored_by_pane(const PosedScene& scene, const SurfacePoint& point) {
    if (point.unlit || !scene.passes_straight(point.address.object)) return glm::vec3{0.0f};
    return mirrored_beside_straight(scene, point);
}

glm::vec3 mirrored_beside_straight(const PosedScene& scene, const SurfacePoint& point) {
    const glm::vec3 face = point.bsdf.mirror;
    if (!point.bounds_body) return face;
    if (point.back_side) return glm::vec3{0.0f};
    // What the other face mirrors passes this one twice, and is mirrored between them [BornWolf, 7.6.1].
    const glm::vec3 passing = scene.transmittance_at(point.address, -point.outgoing);
    return face * (1.0f + passing * passing);
}

glm::vec3 facet_of(const SurfacePoint& point, glm::vec2 u) {
    const glm::vec3 n = point.shading_normal;
    if (!point.bounds_body || !(point.bsdf.alpha > 1.0001f * sharp_alpha)) return n;
    glm::vec3 right, up;
    core::make_frame(n, right, up);
    const glm::vec3 v(glm::dot(right, point.outgoing), glm::dot(up, point.outgoing), glm::dot(n, point.outgoing));
    const glm::vec3 h = visible_normal(v, point.bsdf.alpha, u);
    return core::normalize_or(h.x * right + h.y * up + h.z * n, n);
}

float widening_of(const SurfacePoint& point) {
    return 0.5f * std::max(point.bsdf.alpha - sharp_alpha, 0.0f);
}

glm::vec3 transferred(glm::vec3 place, glm::vec3 turn, float distance, glm::vec3 direction, glm::vec3 normal) {
    const glm::vec3 moved = place + distance * turn;
    const glm::vec3 slid =
        moved - core::divide_or(glm::dot(moved, normal), glm::dot(direction, normal), 0.0f) * direction;
    return core::is_finite(slid) ? slid : glm::vec3{0.0f};
}

glm::vec3 ScatteringShares::sum() const {
    glm::vec3 all(0);
    for (const glm::vec3& share : of) all += share;
    return all;
}

std::array<float, scatterings> ScatteringShares::chances(glm::vec3 light) const {
    std::array<float, scatterings> result{};
    const float before = light.x + light.y + light.z;
    for (std::size_t k = 0; k < scatterings; ++k) result[k] = core::divide_or(glm::dot(light, of[k]), before, 0.0f);
    return result;
}

ScatteringShares specular_shares(const SurfacePoint& point) {
    ScatteringShares shares;
    shares[Scattering::layer] = glm::vec3(1.0f - point.alpha);
    shares[Scattering::mirror] = point.alpha * point.bsdf.mirror;
    shares[Scattering::glass] = point.alpha * point.bsdf.transmission;
    return shares;
}

std::size_t chosen(std::span<const float> chances, float number) {
    std::size_t k = 0;
    for (; k < chances.size() && !(number < chances[k]); ++k) number -= chances[k];
    return k;
}

}  // namespace render2mpeg::renderer
