#include "tests/support/scene_builder.h"

#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

#include "scene/preparation/complete.h"

namespace render2mpeg::test {

int SceneBuilder::add_material(glm::vec3 color) {
    scene::Material m;
    m.name = "material " + std::to_string(film_.materials.size());
    m.base_color = {color, 1.0f};
    m.ior = 1.0f;
    film_.materials.push_back(m);
    return static_cast<int>(film_.materials.size()) - 1;
}

int SceneBuilder::add_emitter(glm::vec3 radiance) {
    const int m = add_material({0, 0, 0});
    material(m).emission = radiance;
    return m;
}

int SceneBuilder::add_mesh(scene::Mesh mesh) {
    if (mesh.name.empty()) mesh.name = "mesh " + std::to_string(film_.meshes.size());
    film_.meshes.push_back(std::move(mesh));
    return static_cast<int>(film_.meshes.size()) - 1;
}

int SceneBuilder::add_object(int mesh, int material_index, glm::dvec3 at, glm::dquat turned, glm::dvec3 scaled) {
    scene::Object object;
    object.name = "object " + std::to_string(film_.objects.size());
    object.node = add_node(at, turned, scaled);
    object.mesh = mesh;
    object.material = material_index;
    film_.objects.push_back(object);
    return static_cast<int>(film_.objects.size()) - 1;
}

int SceneBuilder::add_quad(glm::vec3 corner, glm::vec3 edge_u, glm::vec3 edge_v, int material_index) {
    return add_object(add_mesh(quad(corner, edge_u, edge_v)), material_index);
}

int SceneBuilder::add_box(glm::vec3 low, glm::vec3 high, int material_index, bool inside) {
    return add_object(add_mesh(box(low, high, inside)), material_index);
}

int SceneBuilder::add_sphere(glm::vec3 centre, float radius, int material_index, int rings) {
    return add_object(add_mesh(sphere(radius, rings)), material_index, glm::dvec3(centre));
}

int SceneBuilder::add_point_light(glm::vec3 at, float intensity, glm::vec3 color) {
    scene::Light light;
    light.kind = scene::LightKind::point;
    light.color = color;
    light.intensity = intensity;
    light.node = add_node(glm::dvec3(at), {1, 0, 0, 0}, {1, 1, 1});
    return add_light(light);
}

int SceneBuilder::add_sun(glm::vec3 direction, float irradiance, glm::vec3 color) {
    scene::Light light;
    light.kind = scene::LightKind::directional;
    light.color = color;
    light.intensity = irradiance;
    light.node = add_node({0, 0, 0}, looking_along(glm::dvec3(direction)), {1, 1, 1});
    return add_light(light);
}

int SceneBuilder::add_light(scene::Light light) {
    light.name = "light " + std::to_string(film_.lights.size());
    film_.lights.push_back(light);
    return static_cast<int>(film_.lights.size()) - 1;
}

int SceneBuilder::add_camera(glm::vec3 eye, glm::vec3 target, float vertical_fov) {
    scene::CameraLens lens;
    lens.vertical_fov = vertical_fov;
    return add_camera(lens, eye, target);
}

int SceneBuilder::add_camera(scene::CameraLens lens, glm::vec3 eye, glm::vec3 target) {
    lens.name = "camera " + std::to_string(film_.cameras.size());
    lens.node = add_node(glm::dvec3(eye), looking_along(glm::dvec3(target) - glm::dvec3(eye)), {1, 1, 1});
    film_.cameras.push_back(lens);
    return static_cast<int>(film_.cameras.size()) - 1;
}

void SceneBuilder::add_track(scene::TrackTarget target, int index, int width, std::vector<float> times,
                             std::vector<float> values) {
    scene::Track track;
    track.target = target;
    track.index = index;
    track.width = width;
    track.times = std::move(times);
    track.values = std::move(values);
    film_.tracks.push_back(std::move(track));
}

void SceneBuilder::move_object(int object, const std::vector<glm::vec3>& places) {
    std::vector<float> times, values;
    for (std::size_t k = 0; k < places.size(); ++k) {
        times.push_back(static_cast<float>(k));
        for (int i = 0; i < 3; ++i) values.push_back(places[k][i]);
    }
    add_track(scene::TrackTarget::translation, film_.objects.at(static_cast<std::size_t>(object)).node, 3,
              std::move(times), std::move(values));
}

scene::Animation SceneBuilder::build() const {
    scene::Animation film = film_;
    film.source = "built";
    scene::complete(film);
    return film;
}

scene::Mesh SceneBuilder::quad(glm::vec3 corner, glm::vec3 edge_u, glm::vec3 edge_v) {
    scene::Mesh mesh;
    mesh.positions = {corner, corner + edge_u, corner + edge_u + edge_v, corner + edge_v};
    mesh.uv[0] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

scene::Mesh SceneBuilder::box(glm::vec3 low, glm::vec3 high, bool inside) {
    scene::Mesh mesh;
    const glm::vec3 size = high - low;
    for (int axis = 0; axis < 3; ++axis) {
        for (int side = 0; side < 2; ++side) {
            glm::vec3 u{0}, v{0}, corner = low;
            u[(axis + 1) % 3] = size[(axis + 1) % 3];
            v[(axis + 2) % 3] = size[(axis + 2) % 3];
            if (side == 1) corner[axis] = high[axis];
            if ((side == 1) == inside) std::swap(u, v);
            append(mesh, quad(corner, u, v));
        }
    }
    return mesh;
}

scene::Mesh SceneBuilder::sphere(float radius, int rings) {
    scene::Mesh mesh;
    const int columns = 2 * rings;
    for (int r = 0; r <= rings; ++r) {
        for (int c = 0; c <= columns; ++c) {
            const float theta = std::numbers::pi_v<float> * static_cast<float>(r) / static_cast<float>(rings);
            const float phi =
                2 * std::numbers::pi_v<float> * static_cast<float>(c % columns) / static_cast<float>(columns);
            const float ring = r == 0 || r == rings ? 0.0f : std::sin(theta);
            const glm::vec3 n{ring * std::cos(phi), std::cos(theta), -ring * std::sin(phi)};
            mesh.positions.push_back(radius * n);
            mesh.normals.push_back(glm::normalize(n));
            mesh.uv[0].push_back({static_cast<float>(c) / static_cast<float>(columns),
                                  static_cast<float>(r) / static_cast<float>(rings)});
        }
    }
    for (int r = 0; r < rings; ++r) {
        for (int c = 0; c < columns; ++c) {
            const auto i = static_cast<std::uint32_t>(r * (columns + 1) + c);
            const auto below = i + static_cast<std::uint32_t>(columns) + 1;
            if (r > 0) mesh.triangles.push_back({i, below, i + 1});
            if (r + 1 < rings) mesh.triangles.push_back({i + 1, below, below + 1});
        }
    }
    return mesh;
}

void SceneBuilder::append(scene::Mesh& mesh, const scene::Mesh& more) {
    const auto base = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), more.positions.begin(), more.positions.end());
    mesh.normals.insert(mesh.normals.end(), more.normals.begin(), more.normals.end());
    mesh.uv[0].insert(mesh.uv[0].end(), more.uv[0].begin(), more.uv[0].end());
    for (const glm::uvec3& t : more.triangles) mesh.triangles.push_back(t + base);
}

glm::dquat SceneBuilder::looking_along(glm::dvec3 direction) {
    const glm::dvec3 z = -glm::normalize(direction);
    const glm::dvec3 up = std::abs(z.y) > 0.999 ? glm::dvec3{0, 0, z.y > 0 ? -1 : 1} : glm::dvec3{0, 1, 0};
    const glm::dvec3 x = glm::normalize(glm::cross(up, z));
    return glm::quat_cast(glm::dmat3(x, glm::cross(z, x), z));
}

int SceneBuilder::add_node(glm::dvec3 at, glm::dquat turned, glm::dvec3 scaled) {
    scene::Node node;
    node.name = "node " + std::to_string(film_.nodes.size());
    node.translation = at;
    node.rotation = turned;
    node.scale = scaled;
    film_.nodes.push_back(node);
    return static_cast<int>(film_.nodes.size()) - 1;
}

scene::Snapshot snapshot(const scene::Animation& film, int seconds, int width, int height) {
    return scene::snapshot_at(film, seconds, {seconds, 1}, {width, height, 1.0f},
                              scene::interval_of(film.shutter, 1.0));
}

}  // namespace render2mpeg::test
