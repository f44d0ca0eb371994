#include "scene/preparation/bodies.h"

#include <cmath>

#include "scene/model/wording.h"

namespace render2mpeg::scene {
namespace {

/// chosen: 5 %, as of lamps that shine outwards (docs/model/materials.md); a bottle without its bottom is at 10 %.
constexpr double closed = 0.05;

/// chosen: the rim of a pane of 1 m and 4 mm is 0.8 % of its area; 2 degrees turn a ray of index 1.5 by one.
constexpr double slab_share = 0.99, slab_cosine = 0.99939;

glm::dvec3 vector_area(const Mesh& mesh, glm::uvec3 t) {
    const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
    return 0.5 * glm::cross(b - a, c - a);
}

bool bounds_glass(const Material& m) {
    const bool all_metal = m.metallic >= 1 && !m.metallic_roughness_texture.present();
    return m.thickness != Thickness::thin && m.transmission > 0 && !m.unlit && !m.specular_glossiness && !all_metal;
}

}  // namespace

bool is_closed(const Mesh& mesh) {
    glm::dvec3 sum(0);
    double area = 0;
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::dvec3 part = vector_area(mesh, t);
        sum += part;
        area += glm::length(part);
    }
    return area > 0 && glm::length(sum) < closed * area;
}

bool is_slab(const Mesh& mesh) {
    // The largest triangle's plane, or none.
    glm::dvec3 largest(0);
    double area = 0;
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::dvec3 part = vector_area(mesh, t);
        area += glm::length(part);
        if (glm::length(part) > glm::length(largest)) largest = part;
    }
    if (!(area > 0)) return false;
    const glm::dvec3 normal = glm::normalize(largest);
    double parallel = 0;
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::dvec3 part = vector_area(mesh, t);
        if (std::abs(glm::dot(part, normal)) >= slab_cosine * glm::length(part)) parallel += glm::length(part);
    }
    return parallel >= slab_share * area;
}

void set_bodies(Animation& animation) {
    for (std::size_t i = 0; i < animation.objects.size(); ++i) {
        Object& object = animation.objects[i];
        const Material& material = animation.materials[static_cast<std::size_t>(object.material)];
        object.body = Body::none;
        if (!bounds_glass(material)) continue;
        const Mesh& mesh = animation.meshes[static_cast<std::size_t>(object.mesh)];
        if (!is_closed(mesh)) {
            if (material.thickness == Thickness::solid_where_closed) continue;
            note_once(animation,
                      described("object", i, object.name) + ": is solid glass, but not closed; light may stay inside");
        }
        object.body = is_slab(mesh) ? Body::slab : Body::solid;
    }
}

}  // namespace render2mpeg::scene
