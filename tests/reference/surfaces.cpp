#include "tests/reference/surfaces.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "image/image.h"

namespace render2mpeg::reference {

/// The triangle at an address, posed.
struct Surfaces::Triangle {
    const scene::Mesh* mesh = nullptr;
    glm::uvec3 corners{0};
    glm::dvec3 weights{0};
    glm::dvec3 a{0}, b{0}, c{0};  ///< world

    template <class Values>
    auto mix(const Values& values) const {
        using Mixed = std::conditional_t<
            std::is_same_v<typename Values::value_type, glm::vec2>, glm::dvec2,
            std::conditional_t<std::is_same_v<typename Values::value_type, glm::vec3>, glm::dvec3, glm::dvec4>>;
        return weights.x * Mixed(values[corners.x]) + weights.y * Mixed(values[corners.y]) +
               weights.z * Mixed(values[corners.z]);
    }
};

Surfaces::Surfaces(const renderer::PosedScene& posed_scene) : posed_scene_(posed_scene) {
    const scene::Animation& film = posed_scene.animation();
    const auto read = [&](const scene::TextureUse& use, bool srgb) {
        if (!use.present() || texels_.contains({use.image, srgb})) return;
        const scene::ImageSource& source = film.images[static_cast<std::size_t>(use.image)];
        texels_.emplace(std::pair(use.image, srgb),
                        Texels(image::read_image(source.path, source.bytes, source.name), srgb));
    };
    for (const scene::Material& m : film.materials) {
        for (const scene::TextureUse* use :
             {&m.base_color_texture, &m.emission_texture, &m.specular_glossiness_texture})
            read(*use, true);
        for (const scene::TextureUse* use :
             {&m.metallic_roughness_texture, &m.normal_texture, &m.alpha_texture, &m.transmission_texture})
            read(*use, false);
    }
}

glm::dvec4 Surfaces::look_up(const scene::TextureUse& use, const Triangle& triangle, bool srgb, bool covers) const {
    if (!use.present()) return glm::dvec4(1);
    const auto& coordinates = triangle.mesh->uv[static_cast<std::size_t>(use.uv_set)];
    const glm::dvec2 uv = coordinates.empty() ? glm::dvec2(0) : triangle.mix(coordinates);
    const auto& m = use.transform;
    const glm::dvec2 moved{m[0][0] * uv.x + m[0][1] * uv.y + m[0][2], m[1][0] * uv.x + m[1][1] * uv.y + m[1][2]};
    return texels_.at({use.image, srgb}).at(moved, use.wrap_u, use.wrap_v, use.nearest, covers);
}

Look Surfaces::look_at(const scene::Material& m, const Triangle& triangle) const {
    Look look;
    const bool covers = m.alpha_mode != scene::AlphaMode::opaque;
    glm::dvec4 base = glm::dvec4(m.base_color) * look_up(m.base_color_texture, triangle, true, covers);
    if (!triangle.mesh->colors.empty()) base *= triangle.mix(triangle.mesh->colors);
    look.base = glm::clamp(glm::dvec3(base), 0.0, 1.0);
    if (covers) {
        const double alpha = base.a * look_up(m.alpha_texture, triangle, false).r;
        const bool is_mask = m.alpha_mode == scene::AlphaMode::mask;
        look.coverage = is_mask ? (alpha >= m.alpha_cutoff ? 1.0 : 0.0) : std::clamp(alpha, 0.0, 1.0);
    }
    look.unlit = m.unlit;
    look.ior = m.ior;
    look.specular_glossiness = m.specular_glossiness;
    if (m.specular_glossiness) {
        const glm::dvec4 texel = look_up(m.specular_glossiness_texture, triangle, true);
        look.specular = glm::clamp(glm::dvec3(m.specular) * glm::dvec3(texel), 0.0, 1.0);
        look.roughness = 1 - std::clamp(m.glossiness * texel.a, 0.0, 1.0);
        return look;
    }
    const glm::dvec4 texel = look_up(m.metallic_roughness_texture, triangle, false);
    look.metallic = std::clamp(m.metallic * texel.b, 0.0, 1.0);
    look.roughness = std::clamp(m.roughness * texel.g, 0.0, 1.0);
    look.transmission = std::clamp(m.transmission * look_up(m.transmission_texture, triangle, false).r, 0.0, 1.0);
    return look;
}

/// The normal map's, in the directions in which the image runs right and up [glTF2, 3.9.3].
glm::dvec3 Surfaces::mapped_normal(const scene::Material& m, const Triangle& t, glm::dvec3 normal) const {
    const auto& coordinates = t.mesh->uv[static_cast<std::size_t>(m.normal_texture.uv_set)];
    if (!m.normal_texture.present() || coordinates.empty()) return normal;
    // How the place changes with the coordinates: d place = (d place / d uv) d uv.
    const glm::dvec2 first = coordinates[t.corners.x];
    const glm::dvec2 e = glm::dvec2(coordinates[t.corners.y]) - first, f = glm::dvec2(coordinates[t.corners.z]) - first;
    const double determinant = e.x * f.y - e.y * f.x;
    if (determinant == 0) return normal;
    glm::dvec3 right = ((t.b - t.a) * f.y - (t.c - t.a) * e.y) / determinant;
    glm::dvec3 down = ((t.c - t.a) * e.x - (t.b - t.a) * f.x) / determinant;
    right = glm::normalize(right - glm::dot(right, normal) * normal);
    down = glm::normalize(down - glm::dot(down, normal) * normal);
    const glm::dvec3 bent = 2.0 * glm::dvec3(look_up(m.normal_texture, t, false)) - 1.0;
    return glm::normalize(static_cast<double>(m.normal_scale) * (bent.x * right - bent.y * down) + bent.z * normal);
}

Surface Surfaces::at(const core::SurfaceAddress& address, glm::dvec3 outgoing) const {
    const scene::Animation& film = posed_scene_.animation();
    const scene::Snapshot& now = posed_scene_.posed();
    const scene::Object& object = film.objects[address.object];
    const scene::ObjectState& state = now.objects[address.object];
    const scene::Material& material = film.materials[static_cast<std::size_t>(object.material)];
    Triangle t;
    t.mesh = &film.meshes[static_cast<std::size_t>(object.mesh)];
    t.corners = t.mesh->triangles[address.primitive];
    const double u = address.u, v = address.v;
    t.weights = {1 - u - v, u, v};
    const scene::Triangle corners = scene::triangle_of(now, address.object, address.primitive);
    t.a = corners.a;
    t.b = corners.b;
    t.c = corners.c;

    // The front is where the triangle runs counter-clockwise; a mirroring transform turns it.
    Surface s;
    s.outgoing = outgoing;
    s.position = t.weights.x * t.a + t.weights.y * t.b + t.weights.z * t.c;
    const bool is_mirrored = glm::determinant(glm::dmat3(glm::mat3(state.to_world))) < 0;
    glm::dvec3 front = glm::normalize(glm::cross(t.b - t.a, t.c - t.a));
    if (is_mirrored) front = -front;
    const auto& normals =
        state.deformed >= 0 ? now.deformed[static_cast<std::size_t>(state.deformed)].normals : t.mesh->normals;
    glm::dvec3 normal = front;
    if (!normals.empty()) {
        normal = t.mix(normals);
        if (state.deformed < 0) normal = glm::dmat3(state.normal_to_world) * normal;
        normal = glm::normalize(normal);
    }
    normal = mapped_normal(material, t, normal);
    const bool from_behind = glm::dot(front, outgoing) < 0;
    s.object = address.object;
    s.from_behind = from_behind;
    s.front = from_behind ? -front : front;
    s.normal = from_behind ? -normal : normal;
    if (!(glm::dot(s.normal, s.front) > 0) || !(glm::dot(s.normal, outgoing) > 0)) s.normal = s.front;

    // Single precision holds a place to 6e-8 of its coordinates.
    const glm::dvec3 reach = glm::max(glm::max(glm::abs(t.a), glm::abs(t.b)), glm::abs(t.c));
    s.clearance = 2e-6 * std::max({reach.x, reach.y, reach.z, 1e-6});

    s.look = look_at(material, t);
    s.look.solid = object.body != scene::Body::none;
    if (material.attenuation_distance > 0)
        s.look.absorption = -glm::log(glm::max(glm::dvec3(material.attenuation_color), 1e-30)) /
                            static_cast<double>(material.attenuation_distance);
    if (material.unlit) {
        s.look.emission = s.look.base;
    } else if (!from_behind || material.double_sided) {
        const double factor = now.emission_factor[static_cast<std::size_t>(object.material)];
        s.look.emission =
            factor * glm::dvec3(material.emission) * glm::dvec3(look_up(material.emission_texture, t, true));
    }
    return s;
}

}  // namespace render2mpeg::reference
