#include "scene/preparation/default_light.h"

#include <algorithm>
#include <optional>

#include "scene/model/wording.h"
#include "scene/pose/extent.h"
#include "scene/pose/pose.h"
#include "scene/pose/surface_grid.h"
#include "scene/preparation/studio.h"

namespace render2mpeg::scene {
namespace {

/// The object whose own box is as good as the box of everything, and so closes in what is inside: a sky dome, the walls
/// of a room in one piece.
std::optional<std::size_t> shell_of(const Animation& animation, const Extent& all, const Pose& pose) {
    // chosen: domes and rooms in one piece span 0.97 .. 1 of everything along each axis, the largest other object of
    // the scenes tried at most 0.8 along one.
    constexpr double least_share = 0.9;
    for (std::size_t o = 0; o < animation.objects.size(); ++o) {
        const std::vector<glm::dvec3> positions = world_positions(animation, animation.objects[o], pose);
        if (positions.empty()) continue;
        glm::dvec3 low = positions.front(), high = low;
        for (const glm::dvec3& p : positions) low = glm::min(low, p), high = glm::max(high, p);
        if (glm::all(glm::greaterThanEqual(high - low, least_share * (all.high - all.low)))) return o;
    }
    return {};
}

/// Makes an object shine with its own colour, as bright as a neutral sky; others that share its material stay as they
/// are.
void make_shine(Animation& animation, Object& object) {
    Material material = animation.materials[static_cast<std::size_t>(object.material)];
    material.emission = glm::vec3(material.base_color);
    if (material.emission == glm::vec3(0)) material.emission = glm::vec3(1);
    material.emission_texture = material.base_color_texture;
    material.double_sided = true;
    material.unlit = false;
    object.material = static_cast<int>(animation.materials.size());
    animation.materials.push_back(std::move(material));
}

/// Lights an open film by a studio; `to_world` is the camera's.
void light_by_studio(Animation& animation, const glm::dmat4& to_world) {
    const Extent extent = extent_of_film(animation).value();
    const glm::dvec3 eye(to_world[3]);
    // A camera among the things is in a hall, or in a landscape, which has its own ground.
    const bool among = glm::all(glm::greaterThan(eye, extent.low)) && glm::all(glm::lessThan(eye, extent.high));
    add_studio(animation, extent, -glm::dvec3(to_world[2]), eye.y > extent.low.y && !among);
}

}  // namespace

bool has_light(const Animation& animation) {
    if (animation.sky.shines()) return true;
    for (const Light& light : animation.lights)
        if (light.intensity > 0 && light.color != glm::vec3(0)) return true;
    return std::any_of(animation.objects.begin(), animation.objects.end(), [&](const Object& object) {
        const Material& material = animation.materials[static_cast<std::size_t>(object.material)];
        const bool glows = material.emission_texture.present() &&
                           std::max({material.emission.x, material.emission.y, material.emission.z}) <= 1;
        return material.emits() && !glows;
    });
}

std::string add_default_light(Animation& animation, double seconds, DefaultLight kind, View view) {
    const std::optional<Extent> extent = extent_at(animation, seconds);
    const Pose pose = pose_at(animation, seconds);
    const int camera = animation.shots.empty() ? 0 : animation.shots.front().camera;
    const int node = animation.cameras[static_cast<std::size_t>(camera)].node;
    const glm::dvec3 eye(pose.world_of(node)[3]);
    const bool empty = !extent || !(extent->radius() > 0);
    if (empty || !SurfaceGrid(animation, seconds, *extent).closes_in(eye)) {
        if (kind == DefaultLight::studio && !empty && view != View::front) {
            // The automatic camera turns: the lights are for the middle of its way.
            const double middle = seconds + 0.5 * std::min(animation.duration, studio_seconds);
            light_by_studio(animation, pose_at(animation, middle).world_of(node));
            return "light: studio (the file has none; --light even or none)";
        }
        animation.sky.color = glm::vec3(1);
        animation.sky.image = -1;
        return "no light: lit by a neutral sky";
    }
    if (const std::optional<std::size_t> shell = shell_of(animation, *extent, pose)) {
        Object& object = animation.objects[*shell];
        make_shine(animation, object);
        return "no light, and closed all around: lit by " + described("object", *shell, object.name) + ", which shines";
    }
    // A third of the scene away the lamp is as bright as the sky would be.
    Light lamp;
    lamp.name = "lamp at the camera";
    lamp.node = node;
    lamp.intensity = static_cast<float>(3.14159265 * extent->radius() * extent->radius() / 9);
    animation.lights.push_back(lamp);
    return "no light, and closed all around: lit by a lamp at the camera";
}

}  // namespace render2mpeg::scene
