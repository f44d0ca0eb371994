// Indirect light: long paths, and what mirrors and lobes show of it.
#include "tests/reference/truth_case.h"

namespace render2mpeg::reference {
namespace {

using test::SceneBuilder;

/// A closed box that emits 1 and reflects `percent`: 1 / (1 - albedo) everywhere.
template <int percent>
TruthCase furnace() {
    TruthCase c;
    const int wall = c.scene.add_material(glm::vec3(0.01f * percent));
    c.scene.material(wall).emission = glm::vec3(1);
    c.scene.add_box({0, 0, 0}, {2, 2, 2}, wall, true);
    c.scene.add_camera({1.6f, 1.5f, 1.4f}, {0, 0.9f, 0.7f}, 0.5f);
    c.vpls = 65536;  // some three thousand paths where surfaces reflect 95 %
    c.finding = Finding::by_chance;
    c.paths = 512;
    c.closed_form = [](glm::dvec3, glm::dvec3) { return glm::dvec3(1 / (1 - 0.01 * percent)); };
    c.closed_form_pixel = 0.045;  // two draws of light points err by 4.06 and 4.08 % at an edge
    c.allowed = {0.02, 0.04};
    return c;
}

/// A white room with a panel below its ceiling, whose middle is seen; half of its light is indirect.
TruthCase white_room() {
    TruthCase c;
    c.scene.add_box({0, 0, 0}, {4, 3, 4}, c.scene.add_material({0.8f, 0.7f, 0.6f}), true);
    c.scene.add_quad({1.5f, 2.6f, 1.5f}, {1, 0, 0}, {0, 0, 1}, c.scene.add_emitter({10, 9, 8}));
    c.scene.add_camera({2, 1.5f, 3.6f}, {2, 0.3f, 0.6f}, 0.5f);
    c.vpls = 65536;  // eight draws of 16,384 err by 1.4 to 4.6 % in a patch
    c.allowed = {0.01, 0.03};
    return c;
}

/// The room in a mirror.
TruthCase white_room_in_a_mirror() {
    TruthCase c = white_room();
    const int mirror = c.scene.add_material({0.9f, 0.8f, 0.7f});
    c.scene.material(mirror).metallic = 1;
    c.scene.material(mirror).roughness = 0;
    c.scene.material(mirror).ior = 1.5f;
    c.scene.add_quad({1.2f, 0.3f, 0.3f}, {1.6f, 0, 0}, {0, 1.8f, 0}, mirror);
    c.scene.film().cameras.clear();
    c.scene.add_camera({2, 1.5f, 3.2f}, {2, 1.2f, 0.3f}, 0.35f);
    // Light that it throws into the room again is a caustic, but where it was scattered before: that is 4 % here, which
    // light points lack, since no shadow ray goes by a mirror.
    c.allowed = {0.045, 0.07};
    return c;
}

/// A satin floor of metal that mirrors a wall which a sun lights.
TruthCase wall_in_satin() {
    TruthCase c;
    SceneBuilder& b = c.scene;
    const int satin = b.add_material({0.8f, 0.75f, 0.7f});
    b.material(satin).metallic = 1;
    b.material(satin).roughness = 0.25f;
    b.add_quad({0, 0, 2}, {4, 0, 0}, {0, 0, -4}, satin);
    b.add_quad({0, 0, 2}, {0, 0, -4}, {0, 3, 0}, b.add_material({0.5f, 0.6f, 0.4f}));
    b.add_sun({-1, 0, 0}, 3);
    b.add_camera({5, 2, 0}, {1.5f, 0, 0}, 0.25f);
    c.vpls = 16384;
    c.allowed = {0.02, 0.05};
    return c;
}

/// A wide lobe of rough metal that mirrors the same wall, by light points.
TruthCase wall_in_rough_metal() {
    TruthCase c = wall_in_satin();
    c.scene.material(0).roughness = 0.5f;
    return c;
}

}  // namespace

std::vector<NamedCase> furnace_cases() {
    return {{"Furnace50", furnace<50>}, {"Furnace80", furnace<80>}, {"Furnace95", furnace<95>}};
}

std::vector<NamedCase> indirect_cases() {
    return {{"WhiteRoom", white_room},
            {"WhiteRoomInAMirror", white_room_in_a_mirror},
            {"WallInSatin", wall_in_satin},
            {"WallInRoughMetal", wall_in_rough_metal}};
}

}  // namespace render2mpeg::reference
