#include "scene/preparation/default_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <optional>

#include "core/color.h"
#include "scene/model/node.h"
#include "scene/model/png.h"
#include "scene/model/wording.h"
#include "scene/pose/pose.h"
#include "scene/pose/surface_grid.h"

namespace render2mpeg::scene {
namespace {

// All of this is chosen by eye on a dozen models (docs/scenes.md).
constexpr double key_elevation = 0.87, rim_elevation = 0.6;  // radians over the horizon
constexpr double key_heading = 0.95, rim_heading = -2.5;     // to the left of where the camera stands, radians
constexpr double box_elevation = 1.1;                        // above what cameras see that look level
constexpr float key_irradiance = 3.2f, rim_irradiance = 1.2f;
constexpr float key_angle = 0.2f, rim_angle = 0.15f;  // radians: penumbrae of a large soft box
constexpr float fill = 0.11f;                         // radiance of the sky between its soft boxes
constexpr float floor_reflectance = 0.18f;
// A little warm and a little cool, so that shapes are told by colour too; white stays white.
constexpr glm::vec3 sun_tint{1, 0.985f, 0.955f}, sky_tint{0.95f, 0.975f, 1};

struct SoftBox {
    glm::dvec3 towards;
    float radiance;
    float inner, outer;  ///< cosines between which it fades
};

glm::dvec3 direction(double heading, double elevation) {
    return {std::sin(heading) * std::cos(elevation), std::sin(elevation), std::cos(heading) * std::cos(elevation)};
}

float smooth(float low, float high, float x) {
    const float t = std::clamp((x - low) / (high - low), 0.0f, 1.0f);
    return t * t * (3 - 2 * t);
}

/// The sky by direction; `yaw` is the camera's heading.
class StudioSky {
  public:
    static constexpr int width = 256, height = 128;

    explicit StudioSky(double yaw)
        : boxes_{{{direction(yaw + key_heading, box_elevation), 3.2f, 0.97f, 0.90f},
                  {direction(yaw + rim_heading, box_elevation), 2.6f, 0.97f, 0.90f},
                  {direction(yaw - 0.9, box_elevation), 0.8f, 0.97f, 0.90f}}} {
        // The backdrop shows the light reflected by the floor.
        const double by_suns = static_cast<double>(key_irradiance) * std::sin(key_elevation) +
                               static_cast<double>(rim_irradiance) * std::sin(rim_elevation);
        double by_sky = 0;
        const double cell = glm::pi<double>() / height;
        for (int y = 0; y < height / 2; ++y)
            for (int x = 0; x < width; ++x) {
                const glm::dvec3 d = direction_of(x, y);
                by_sky += static_cast<double>(upper(d)) * d.y * cell * cell * std::sqrt(1 - d.y * d.y);
            }
        backdrop_ = floor_reflectance / glm::pi<float>() *
                    (static_cast<float>(by_suns) * sun_tint + static_cast<float>(by_sky) * sky_tint);
    }

    /// Latitude-longitude, as Sky says.
    static glm::dvec3 direction_of(int x, int y) {
        const double from_middle = 2 * glm::pi<double>() * ((x + 0.5) / width - 0.5);
        const double polar = glm::pi<double>() * (y + 0.5) / height;
        return {std::sin(polar) * std::sin(from_middle), std::cos(polar), -std::sin(polar) * std::cos(from_middle)};
    }

    glm::vec3 radiance(glm::dvec3 d) const { return d.y > 0 ? upper(d) * sky_tint : lower(static_cast<float>(d.y)); }

  private:
    /// The backdrop darkens towards the horizon and meets the sky there.
    glm::vec3 lower(float y) const { return glm::mix(backdrop_, horizon * sky_tint, smooth(-0.3f, 0.05f, y)); }

    float upper(glm::dvec3 d) const {
        const auto y = static_cast<float>(d.y);
        float sum = horizon + (fill - horizon) * smooth(0, 0.4f, y);
        for (const SoftBox& box : boxes_)
            sum += box.radiance * smooth(box.outer, box.inner, static_cast<float>(glm::dot(d, box.towards)));
        return sum;
    }

    static constexpr float horizon = 0.1f;
    std::array<SoftBox, 3> boxes_;
    glm::vec3 backdrop_{0};
};

void add_sky(Animation& animation, const StudioSky& sky) {
    float peak = 0;
    for (int y = 0; y < StudioSky::height; ++y)
        for (int x = 0; x < StudioSky::width; ++x)
            for (int k = 0; k < 3; ++k) peak = std::max(peak, sky.radiance(StudioSky::direction_of(x, y))[k]);
    std::vector<glm::u8vec4> texels;
    for (int y = 0; y < StudioSky::height; ++y)
        for (int x = 0; x < StudioSky::width; ++x) {
            const glm::vec3 share = sky.radiance(StudioSky::direction_of(x, y)) / peak;
            glm::u8vec4 texel(255);
            for (int k = 0; k < 3; ++k)
                texel[k] = static_cast<glm::uint8>(std::lround(255 * core::linear_to_srgb(share[k])));
            texels.push_back(texel);
        }
    animation.sky.image = static_cast<int>(animation.images.size());
    animation.sky.color = glm::vec3(peak);
    animation.sky.rotation = 0;
    animation.images.push_back({"studio", {}, encode_png(StudioSky::width, StudioSky::height, texels)});
}

void add_sun(Animation& animation, const char* name, glm::dvec3 towards, float irradiance, float angle) {
    Node node;
    node.name = name;
    node.rotation = turn_towards(-towards, glm::dvec3(0, 1, 0));
    Light sun;
    sun.name = name;
    sun.node = static_cast<int>(animation.nodes.size());
    sun.kind = LightKind::directional;
    sun.color = sun_tint;
    sun.intensity = irradiance;
    sun.angle = angle;
    animation.nodes.push_back(std::move(node));
    animation.lights.push_back(std::move(sun));
}

/// A disc in the plane y = 0 that is covered within `inner` and gone at `outer`.
Mesh disc(float inner, float outer) {
    constexpr int spokes = 48, rings = 24;
    Mesh mesh;
    mesh.name = "studio floor";
    const auto add = [&](float radius, float angle, float alpha) {
        mesh.positions.emplace_back(radius * std::cos(angle), 0, -radius * std::sin(angle));
        mesh.normals.emplace_back(0, 1, 0);
        mesh.colors.emplace_back(1, 1, 1, alpha);
    };
    add(0, 0, 1);
    for (int r = 0; r <= rings; ++r)
        for (int s = 0; s < spokes; ++s) {
            const float radius = inner + (outer - inner) * static_cast<float>(r) / rings;
            add(radius, 2 * glm::pi<float>() * static_cast<float>(s) / spokes, 1 - smooth(inner, outer, radius));
        }
    const auto at = [](int r, int s) { return static_cast<unsigned>(1 + r * spokes + s % spokes); };
    for (int s = 0; s < spokes; ++s) mesh.triangles.emplace_back(0, at(0, s), at(0, s + 1));
    for (int r = 0; r < rings; ++r)
        for (int s = 0; s < spokes; ++s) {
            mesh.triangles.emplace_back(at(r, s), at(r + 1, s), at(r + 1, s + 1));
            mesh.triangles.emplace_back(at(r, s), at(r + 1, s + 1), at(r, s + 1));
        }
    return mesh;
}

void add_floor(Animation& animation, const Extent& extent) {
    Material floor = matt("studio floor", glm::vec3(floor_reflectance));
    floor.alpha_mode = AlphaMode::blend;

    const glm::dvec3 size = extent.high - extent.low;
    const double reach = 0.5 * std::hypot(size.x, size.z) + 0.5 * size.y;
    Node node;
    node.name = "studio floor";
    // A little below, so that what lies on the ground keeps its underside to itself.
    node.translation = extent.centre();
    node.translation.y = extent.low.y - 1e-3 * extent.radius();
    Object object;
    object.name = "studio floor";
    object.node = static_cast<int>(animation.nodes.size());
    object.mesh = static_cast<int>(animation.meshes.size());
    object.material = static_cast<int>(animation.materials.size());
    animation.stage = static_cast<int>(animation.objects.size());
    animation.meshes.push_back(disc(static_cast<float>(1.2 * reach), static_cast<float>(3.5 * reach)));
    animation.nodes.push_back(std::move(node));
    animation.materials.push_back(std::move(floor));
    animation.objects.push_back(std::move(object));
}

/// The object whose own box is as good as the box of everything, and so closes in what is inside: a sky dome, the walls
/// of a room in one piece.
std::optional<std::size_t> shell_of(const Animation& animation, const Extent& all, const Pose& pose) {
    // chosen: domes and rooms in one piece span 0.97 .. 1 of everything along each axis, the largest other object of
    // the scenes tried at most 0.8 along one.
    constexpr double least_share = 0.9;
    for (std::size_t o = 0; o < animation.objects.size(); ++o) {
        const std::vector<glm::dvec3> positions = world_positions(animation, animation.objects[o], pose);
        if (positions.empty()) continue;
        Extent own{positions.front(), positions.front()};
        for (const glm::dvec3& p : positions) own.hold(p);
        if (glm::all(glm::greaterThanEqual(own.high - own.low, least_share * (all.high - all.low)))) return o;
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

void add_studio(Animation& animation, const Extent& extent, glm::dvec3 forward, bool floor) {
    const double yaw = std::atan2(-forward.x, -forward.z);  // of where the camera stands
    add_sky(animation, StudioSky(yaw));
    add_sun(animation, "studio key light", direction(yaw + key_heading, key_elevation), key_irradiance, key_angle);
    add_sun(animation, "studio rim light", direction(yaw + rim_heading, rim_elevation), rim_irradiance, rim_angle);
    if (floor) add_floor(animation, extent);
}

bool has_light(const Animation& animation) {
    if (animation.sky.shines()) return true;
    for (const Light& light : animation.lights)
        if (light.intensity > 0 && light.color != glm::vec3(0)) return true;
    for (const Volume& volume : animation.volumes)
        if (volume.emits()) return true;
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
