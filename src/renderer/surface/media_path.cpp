#include "renderer/surface/media_path.h"

#include "core/numeric.h"
#include "core/sampling.h"

namespace render2mpeg::renderer {

glm::vec3 MediaPath::way_to(const PosedScene& scene, const Hit& hit, glm::vec3 direction) {
    if (!scene.has_bodies()) return glm::vec3{1.0f};
    const std::uint32_t object = hit.address.object;
    const Medium* own = scene.medium_within(object);
    if (own != nullptr && !media.holds(object) &&
        glm::dot(scene.front_normal(object, hit.address.primitive), direction) > 0.0f)
        media.begin_inside(object, *own);
    return media.empty() ? glm::vec3{1.0f} : media.top()->passes(hit.distance);
}

SurfacePoint MediaPath::surface_at(const PosedScene& scene, const Hit& hit, glm::vec3 direction,
                                   const SurfaceFootprint& footprint) const {
    return scene.surface_in(media, band, hit.address, -direction, footprint);
}

glm::vec3 MediaPath::cross(const PosedScene& scene, const SurfacePoint& point, glm::vec3 facet) {
    glm::vec3 to = refracted(-point.outgoing, facet, point.bsdf.ior);
    if (to == glm::vec3{0.0f}) to = refracted(-point.outgoing, point.shading_normal, point.bsdf.ior);
    if (to == glm::vec3{0.0f}) return to;
    const float ahead = -glm::dot(to, point.geometric_normal);
    if (ahead < least_leaving_cosine)
        to = core::normalize_or(to - (least_leaving_cosine - ahead) * point.geometric_normal, -point.outgoing);
    media.cross(point.address.object, *scene.medium_within(point.address.object), point.back_side);
    return to;
}

glm::vec3 facet_of(const SurfacePoint& point, glm::vec2 u) {
    constexpr float smooth = 1.0001f * scene::mirror_roughness * scene::mirror_roughness;
    const glm::vec3 n = point.shading_normal;
    if (!point.bounds_body || !(point.bsdf.alpha > smooth)) return n;
    glm::vec3 right, up;
    core::make_frame(n, right, up);
    const glm::vec3 v(glm::dot(right, point.outgoing), glm::dot(up, point.outgoing), glm::dot(n, point.outgoing));
    const glm::vec3 h = visible_normal(v, point.bsdf.alpha, u);
    return core::normalize_or(h.x * right + h.y * up + h.z * n, n);
}

}  // namespace render2mpeg::renderer
