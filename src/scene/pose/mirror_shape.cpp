#include "scene/pose/mirror_shape.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace render2mpeg::scene {

Corners corners_of(const Animation& animation, std::uint32_t object, std::uint32_t primitive, const ObjectState& state,
                   const std::vector<DeformedMesh>& deformed) {
    const Mesh& mesh = animation.meshes[static_cast<std::size_t>(animation.objects[object].mesh)];
    Corners out;
    for (int k = 0; k < 3; ++k) {
        const std::uint32_t v = mesh.triangles[primitive][k];
        if (state.deformed >= 0) {
            const DeformedMesh& bent = deformed[static_cast<std::size_t>(state.deformed)];
            out.place[k] = bent.positions[v];
            out.normal[k] = bent.normals.empty() ? glm::dvec3(0) : glm::dvec3(bent.normals[v]);
            continue;
        }
        out.place[k] = glm::dmat4(state.to_world) * glm::dvec4(mesh.positions[v], 1);
        out.normal[k] = mesh.normals.empty() ? glm::dvec3(0) : glm::dvec3(state.normal_to_world * mesh.normals[v]);
        if (const double length = glm::length(out.normal[k]); length > 0) out.normal[k] /= length;
    }
    return out;
}

std::optional<Spot> spot_at(const Animation& animation, const core::SurfaceAddress& a, const ObjectState& state,
                            const std::vector<DeformedMesh>& deformed) {
    const Corners c = corners_of(animation, a.object, a.primitive, state, deformed);
    const double u = static_cast<double>(a.u), v = static_cast<double>(a.v);
    const glm::dvec3 e1 = c.place[1] - c.place[0], e2 = c.place[2] - c.place[0], across = glm::cross(e1, e2);
    const double area2 = glm::length(across);
    if (!(area2 > 0)) return std::nullopt;
    Spot spot;
    spot.place = c.place[0] + u * e1 + v * e2;
    const bool turned = state.deformed < 0 && glm::determinant(glm::dmat3(state.to_world)) < 0;
    spot.front = (turned ? -1.0 : 1.0) / area2 * across;
    spot.normal = (1 - u - v) * c.normal[0] + u * c.normal[1] + v * c.normal[2];
    const double length = glm::length(spot.normal);
    const bool flat = !(length > 0) || !(glm::dot(spot.normal, spot.front) > 0);
    spot.normal = flat ? spot.front : spot.normal / length;
    spot.along[0] = glm::normalize(e1);
    spot.along[1] = glm::cross(across / area2, spot.along[0]);
    for (int k = 0; k < 2; ++k) {
        if (flat) continue;
        const double by1 = glm::dot(glm::cross(spot.along[k], e2), across) / (area2 * area2),
                     by2 = glm::dot(glm::cross(e1, spot.along[k]), across) / (area2 * area2);
        spot.turn[k] = (by1 * (c.normal[1] - c.normal[0]) + by2 * (c.normal[2] - c.normal[0])) / length;
        spot.turn[k] -= glm::dot(spot.turn[k], spot.normal) * spot.normal;
    }
    return spot;
}

glm::dvec2 nearest_weights(glm::dvec3 p, const glm::dvec3 (&corner)[3]) {
    const glm::dvec3 e1 = corner[1] - corner[0], e2 = corner[2] - corner[0], d = p - corner[0];
    const double aa = glm::dot(e1, e1), ab = glm::dot(e1, e2), bb = glm::dot(e2, e2), pa = glm::dot(d, e1),
                 pb = glm::dot(d, e2), area = aa * bb - ab * ab;
    const glm::dvec2 inside((bb * pa - ab * pb) / area, (aa * pb - ab * pa) / area);
    if (area > 0 && inside.x >= 0 && inside.y >= 0 && inside.x + inside.y <= 1) return inside;
    const auto share = [](double over, double whole) { return whole > 0 ? std::clamp(over / whole, 0.0, 1.0) : 0.0; };
    const double third = share(pb - ab - pa + aa, aa + bb - 2 * ab);
    const glm::dvec2 on_edges[3] = {{share(pa, aa), 0}, {0, share(pb, bb)}, {1 - third, third}};
    return *std::min_element(std::begin(on_edges), std::end(on_edges), [&](glm::dvec2 x, glm::dvec2 y) {
        return glm::length(x.x * e1 + x.y * e2 - d) < glm::length(y.x * e1 + y.y * e2 - d);
    });
}

MirroredRay ray_at(const Instant& now, glm::dvec3 place, glm::dvec3 n) {
    const glm::dvec3 i = glm::normalize(now.way_to(place));
    return {i - 2 * glm::dot(i, n) * n, -glm::dot(i, n)};
}

}  // namespace render2mpeg::scene
