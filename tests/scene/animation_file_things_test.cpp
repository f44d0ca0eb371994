#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <glm/gtc/constants.hpp>
#include <map>
#include <regex>
#include <string>

#include "core/error.h"
#include "core/sampling.h"
#include "scene/animation_file/shapes.h"
#include "scene/load.h"
#include "scene/pose/snapshot.h"
#include "scene/preparation/complete.h"
#include "tests/support/places.h"

namespace render2mpeg::scene {
namespace {

namespace fs = std::filesystem;
using glm::pi;

Animation parsed(const std::string& text, const std::map<std::string, std::string>& files = {}) {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    const fs::path folder = fs::path(::testing::TempDir()) / (std::string("r2m_things_") + test->name());
    fs::remove_all(folder);
    fs::create_directories(folder);
    std::ofstream(folder / "film.json") << text;
    for (const auto& [name, content] : files) std::ofstream(folder / name, std::ios::binary) << content;
    try {
        Animation animation = load_as_is(folder / "film.json", {});
        complete(animation);
        fs::remove_all(folder);
        return animation;
    } catch (...) {
        fs::remove_all(folder);
        throw;
    }
}

Snapshot thing_at(const Animation& animation, double seconds) {
    return snapshot_at(animation, std::llround(seconds * 25), {std::llround(seconds * 1000), 1000}, {320, 240, 1});
}

double volume(const Mesh& mesh) {
    double sum = 0;
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
        sum += glm::dot(a, glm::cross(b, c)) / 6;
    }
    return sum;
}

double area(const Mesh& mesh) {
    double sum = 0;
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
        sum += glm::length(glm::cross(b - a, c - a)) / 2;
    }
    return sum;
}

/// The normals lie on the side from which the triangles wind counter-clockwise, and have unit length.
void expect_normals_outwards(const Mesh& mesh, double least_cosine) {
    ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
    ASSERT_EQ(mesh.uv[0].size(), mesh.positions.size());
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
        const glm::dvec3 flat = glm::normalize(glm::cross(b - a, c - a));
        for (int k = 0; k < 3; ++k) {
            EXPECT_NEAR(glm::length(mesh.normals[t[k]]), 1, 1e-5);
            EXPECT_GT(glm::dot(flat, glm::dvec3(mesh.normals[t[k]])), least_cosine);
        }
    }
}

TEST(LampMesh, ShinesAsTheTrueSphereInEveryDirection) {
    // Far away a lamp of radiance 1 gives what its shadow's area is.
    const Mesh lamp = lamp_mesh(0.5);
    EXPECT_NEAR(area(lamp), glm::pi<double>(), 1e-5);
    for (int i = 0; i < 100; ++i) {
        const glm::vec3 towards = core::sample_sphere(
            {core::halton(0, static_cast<std::uint64_t>(i)), core::halton(1, static_cast<std::uint64_t>(i))});
        double shadow = 0;
        for (const glm::uvec3 t : lamp.triangles) {
            const glm::vec3 a = lamp.positions[t.x],
                            wound = glm::cross(lamp.positions[t.y] - a, lamp.positions[t.z] - a);
            shadow += 0.5 * std::max(0.0f, glm::dot(wound, towards));
        }
        EXPECT_NEAR(shadow / (0.25 * glm::pi<double>()), 1.0, 1e-3) << i;
    }
}

TEST(AnimationFileShapes, HaveTheVolumeAndAreaOfTheirSolids) {
    EXPECT_NEAR(volume(box_mesh({2, 3, 4}, TextureLayout::fit)), 24, 1e-5);
    EXPECT_NEAR(area(box_mesh({2, 3, 4}, TextureLayout::fit)), 52, 1e-5);
    EXPECT_NEAR(area(plane_mesh({2, 3}, TextureLayout::fit)), 6, 1e-6);
    EXPECT_NEAR(area(quad_mesh({2, 3}, TextureLayout::fit)), 6, 1e-6);
    // Round ones from inside: 256 sides miss about 1e-4 of the area.
    const auto expect_just_below = [](double value, double truth) {
        EXPECT_LT(value, truth);
        EXPECT_GT(value, truth * (1 - 1e-3));
    };
    expect_just_below(volume(sphere_mesh(0.7, 256, TextureLayout::fit)), 4.0 / 3 * pi<double>() * 0.343);
    expect_just_below(volume(cylinder_mesh(0.5, 0.5, 2, 256, TextureLayout::fit)), pi<double>() * 0.5);
    expect_just_below(volume(cylinder_mesh(0.5, 0, 2, 256, TextureLayout::fit)), pi<double>() * 0.5 / 3);
    expect_just_below(area(disc_mesh(2, 256, TextureLayout::fit)), 4 * pi<double>());
    expect_just_below(volume(torus_mesh(1, 0.25, 256, TextureLayout::fit)), 2 * pi<double>() * pi<double>() * 0.0625);
    // The arch has no faces below, where it stands: those of a solid would add nothing at height 0.
    const double opening = 1.2 * 1.4 + pi<double>() * 0.36 / 2;
    const double arch = volume(arch_mesh({2, 3, 0.5}, {1.2, 2}, 256, TextureLayout::fit));
    EXPECT_NEAR(arch, (6 - opening) * 0.5, 1e-3);
}

TEST(AnimationFileShapes, WindAndShadeOutwards) {
    expect_normals_outwards(box_mesh({1, 2, 3}, TextureLayout::units), 0.999);
    expect_normals_outwards(plane_mesh({1, 2}, TextureLayout::fit), 0.999);
    expect_normals_outwards(quad_mesh({1, 2}, TextureLayout::fit), 0.999);
    expect_normals_outwards(sphere_mesh(1, 24, TextureLayout::fit), 0.9);
    expect_normals_outwards(lamp_mesh(1), 0.99);
    expect_normals_outwards(cylinder_mesh(1, 0.5, 1, 24, TextureLayout::fit), 0.9);
    expect_normals_outwards(disc_mesh(1, 24, TextureLayout::fit), 0.999);
    expect_normals_outwards(torus_mesh(1, 0.3, 32, TextureLayout::fit), 0.9);
    expect_normals_outwards(arch_mesh({2, 3, 0.5}, {1.2, 2}, 24, TextureLayout::fit), 0.9);
    EXPECT_EQ(plane_mesh({1, 1}, TextureLayout::fit).normals[0], glm::vec3(0, 1, 0));
    EXPECT_EQ(quad_mesh({1, 1}, TextureLayout::fit).normals[0], glm::vec3(0, 0, 1));
}

TEST(AnimationFileShapes, ShowTexturesUprightAndInScale) {
    const Mesh quad = quad_mesh({4, 2}, TextureLayout::fit);
    for (std::size_t i = 0; i < quad.positions.size(); ++i) {
        EXPECT_NEAR(quad.uv[0][i].x, quad.positions[i].x / 4 + 0.5, 1e-6);
        EXPECT_NEAR(quad.uv[0][i].y, 0.5 - quad.positions[i].y / 2, 1e-6);
    }
    // In units every face of a box has as much texture as it has area.
    const Mesh box = box_mesh({1, 2, 3}, TextureLayout::units);
    for (const glm::uvec3& t : box.triangles) {
        const glm::vec2 u = box.uv[0][t.y] - box.uv[0][t.x], v = box.uv[0][t.z] - box.uv[0][t.x];
        const glm::vec3 p = box.positions[t.y] - box.positions[t.x], q = box.positions[t.z] - box.positions[t.x];
        EXPECT_NEAR(std::abs(u.x * v.y - u.y * v.x), glm::length(glm::cross(p, q)), 1e-5);
    }
}

TEST(AnimationFileThings, RepeatsShareOneMeshAndStandInRowsAndRings) {
    const Animation a = parsed(R"({"objects": [
        {"shape": "sphere", "position": [10, 0, 0], "repeat": {"count": [3, 2, 1], "step": [2, 1, 0], "centered": true}},
        {"shape": "group", "repeat": {"ring": {"count": 4, "radius": 5}}, "parts": [{"shape": "box"}, {"shape": "box", "position": [0, 1, 0]}]}]})");
    ASSERT_EQ(a.objects.size(), 6u + 8u);
    EXPECT_EQ(a.meshes.size(), 3u);
    const Snapshot s = thing_at(a, 0);
    const auto place = [&](std::size_t i) { return glm::vec3(s.objects[i].to_world[3]) + glm::vec3(a.origin); };
    EXPECT_EQ(place(0), glm::vec3(8, -0.5f, 0));
    EXPECT_EQ(place(2), glm::vec3(12, -0.5f, 0));
    EXPECT_EQ(place(5), glm::vec3(12, 0.5f, 0));
    EXPECT_LT(glm::length(place(6) - glm::vec3(0, 0, 5)), 1e-5);
    EXPECT_LT(glm::length(place(8) - glm::vec3(5, 0, 0)), 1e-5);
    EXPECT_LT(glm::length(place(9) - glm::vec3(5, 1, 0)), 1e-5);
    EXPECT_LT(glm::length(place(12) - glm::vec3(-5, 0, 0)), 1e-5);
    // Copies on a ring face outwards.
    EXPECT_LT(glm::length(glm::vec3(s.objects[8].to_world[2]) - glm::vec3(1, 0, 0)), 1e-5);
}

TEST(AnimationFileThings, RefuseMoreCopiesThanAFilmCanHoldSlow) {
    EXPECT_THROW(
        parsed(R"({"objects": [{"shape": "box", "repeat": {"count": [10000, 10000, 10000], "step": [1, 1, 1]}}]})"),
        core::Error);
    // Nested repeats multiply.
    EXPECT_THROW(
        parsed(R"({"objects": [{"shape": "group", "repeat": {"count": [1000, 100, 1], "step": [1, 1, 1]}, "parts": [
        {"shape": "box", "repeat": {"count": [1000, 100, 1], "step": [1, 1, 1]}}]}]})"),
        core::Error);
}

TEST(AnimationFileThings, LampsThatAreNotSeenStayInTheFilmAndShine) {
    const Animation film = parsed(R"({"lights": [{"kind": "panel", "seen": false, "intensity": 5},
        {"kind": "sphere", "seen": true}]})");
    ASSERT_EQ(film.objects.size(), 2u);
    const Material& hidden = film.materials[static_cast<std::size_t>(film.objects[0].material)];
    EXPECT_EQ(hidden.alpha_mode, AlphaMode::blend);
    EXPECT_EQ(hidden.base_color.a, 0);
    EXPECT_EQ(hidden.emission, glm::vec3(5));
    EXPECT_EQ(film.materials[static_cast<std::size_t>(film.objects[1].material)].alpha_mode, AlphaMode::opaque);
    EXPECT_FALSE(hidden.mirrored);
    EXPECT_THROW(parsed(R"({"lights": [{"kind": "point", "seen": false}]})"), core::Error);
}

TEST(AnimationFileThings, LampsMayBeSeenInMirrorsAlone) {
    const Animation film = parsed(R"({"lights": [{"kind": "panel", "seen": "mirrors"}, {"kind": "spot", "radius": 0.3},
        {"kind": "sun", "angle": 20, "seen": "mirrors"}, {"kind": "sun", "angle": 20, "seen": true}, {"kind": "spot"},
        {"kind": "sun", "angle": 20}]})");
    const Material& panel = film.materials[static_cast<std::size_t>(film.objects[0].material)];
    EXPECT_TRUE(panel.mirrored);
    EXPECT_EQ(panel.base_color.a, 0);
    const float sun = std::sin(glm::radians(10.0f));
    const std::pair<float, bool> said[] = {{0.3f, false}, {sun, false}, {sun, true}, {0.0f, false}, {0.0f, false}};
    for (std::size_t i = 0; i < 5; ++i) {
        EXPECT_FLOAT_EQ(film.lights[i].disc, said[i].first) << i;
        EXPECT_EQ(film.lights[i].seen, said[i].second) << i;
    }
    EXPECT_THROW(parsed(R"({"lights": [{"kind": "panel", "seen": "mirror"}]})"), core::Error);
    EXPECT_THROW(parsed(R"({"lights": [{"kind": "sun", "seen": "mirrors"}]})"), core::Error);
    EXPECT_THROW(parsed(R"({"lights": [{"kind": "point", "radius": 1}]})"), core::Error);
}

TEST(AnimationFileThings, RoundPanelsAreOctagonsOfTheEllipsesAreaThatShineAlongTheirSight) {
    const Animation film = parsed(R"({"lights": [{"kind": "panel", "round": true, "size": [3, 0.5]}]})");
    const Snapshot s = thing_at(film, 0);
    double area = 0;
    float widest = 0;
    for (std::uint32_t t = 0; t < 8; ++t) {
        const Triangle triangle = triangle_of(s, 0, t);
        const glm::vec3 twice = glm::cross(triangle.b - triangle.a, triangle.c - triangle.a);
        EXPECT_LT(glm::length(glm::normalize(twice) - glm::vec3(0, 0, -1)), 1e-5);
        area += glm::length(twice) / 2;
        for (const glm::vec3 corner : {triangle.a, triangle.b, triangle.c}) widest = std::max(widest, corner.x);
    }
    EXPECT_NEAR(area, 3.14159265 * 3 * 0.5 / 4, 1e-5);
    EXPECT_NEAR(widest, 1.5f, 0.1f);
    EXPECT_THROW(parsed(R"({"lights": [{"kind": "sphere", "round": true}]})"), core::Error);
}

TEST(AnimationFileThings, LightsShineAlongTheirSightWithTheirOwnUnits) {
    const Animation a = parsed(R"({"objects": [{"shape": "plane"}], "lights": [
        {"kind": "sun", "elevation": 30, "azimuth": 90, "intensity": 4, "color": [1, 0.5, 0]},
        {"kind": "spot", "position": [0, 3, 0], "look_at": [0, 0, 0], "angle": 40, "softness": 0.5, "intensity": 7, "falloff": "blender-3"},
        {"kind": "point", "position": [1, 2, 3], "keys": [{"at": 0, "power": 1}, {"at": 1, "power": 0}], "interpolation": "step"}]})");
    const Snapshot s = thing_at(a, 0.5);
    ASSERT_EQ(s.lights.size(), 3u);
    // The sun stands over +x: its light comes down from there.
    const glm::vec3 wanted(-std::cos(pi<float>() / 6), -0.5f, 0);
    EXPECT_LT(glm::length(s.lights[0].direction - wanted), 1e-5);
    EXPECT_LT(glm::length(s.lights[0].intensity - glm::vec3(4, 2, 0)), 1e-5);
    EXPECT_LT(glm::length(s.lights[1].direction - glm::vec3(0, -1, 0)), 1e-5);
    EXPECT_NEAR(s.lights[1].cos_outer, std::cos(glm::radians(20.0f)), 1e-5);
    EXPECT_NEAR(s.lights[1].cos_inner, std::cos(glm::radians(10.0f)), 1e-5);
    EXPECT_TRUE(s.lights[1].smooth_cosine);
    EXPECT_THROW(parsed(R"({"lights": [{"kind": "point", "falloff": "gltf"}]})"), core::Error);
    EXPECT_EQ(s.lights[2].position, glm::vec3(1, 2, 3));
    EXPECT_GT(s.lights[2].intensity.x, 0);
    EXPECT_EQ(thing_at(a, 1.0).lights[2].intensity, glm::vec3(0));
}

TEST(AnimationFileThings, PanelsShineToOneSideAndSpheresOutwards) {
    const Animation a = parsed(R"({"lights": [
        {"kind": "panel", "position": [0, 2, 0], "rotate": [-90, 0, 0], "size": [2, 1], "intensity": 5, "color": "#ff0000"},
        {"kind": "sphere", "position": [0, 1, 0], "radius": 0.2, "intensity": 3}]})");
    ASSERT_EQ(a.objects.size(), 2u);
    EXPECT_EQ(a.materials[static_cast<std::size_t>(a.objects[0].material)].emission, glm::vec3(5, 0, 0));
    EXPECT_FALSE(a.materials[static_cast<std::size_t>(a.objects[0].material)].double_sided);
    const Snapshot s = thing_at(a, 0);
    double lit = 0;
    for (std::uint32_t t = 0; t < 2; ++t) {
        const Triangle triangle = triangle_of(s, 0, t);
        const glm::vec3 twice = glm::cross(triangle.b - triangle.a, triangle.c - triangle.a);
        EXPECT_LT(glm::length(glm::normalize(twice) - glm::vec3(0, -1, 0)), 1e-5);
        lit += glm::length(twice) / 2;
    }
    EXPECT_NEAR(lit, 2, 1e-5);
    EXPECT_GT(volume(a.meshes[static_cast<std::size_t>(a.objects[1].mesh)]), 0);
}

TEST(AnimationFileThings, StaggeredCopiesFollowEachOther) {
    const Animation a = parsed(
        R"({"objects": [{"shape": "plane"}], "lights": [{"kind": "point", "intensity": 1, "stagger": 0.5, "interpolation": "step",
        "repeat": {"count": [3, 1, 1], "step": [1, 0, 0]}, "colors": ["#ff0000", "#0000ff"], "keys": [{"at": 0, "power": 0}, {"at": 1, "power": 1}]}]})");
    ASSERT_EQ(a.lights.size(), 3u);
    for (int i = 0; i < 3; ++i) {
        const auto lit = [&](double t) {
            return thing_at(a, t).lights[static_cast<std::size_t>(i)].intensity != glm::vec3(0);
        };
        EXPECT_FALSE(lit(0.96 + 0.5 * i));
        EXPECT_TRUE(lit(1.04 + 0.5 * i));
    }
    EXPECT_EQ(a.lights[1].color, glm::vec3(0, 0, 1));
    EXPECT_EQ(a.lights[2].color, glm::vec3(1, 0, 0));
}

TEST(AnimationFileThings, MaterialsAreMattUntilTheySayOtherwise) {
    const Animation a = parsed(
        R"({"objects": [{"shape": "box", "material": "m"}, {"shape": "box", "material": {"roughness": 0.3}}, {"shape": "box"},
            {"shape": "box", "material": "lamp"}],
        "materials": {"m": {"base_color": "#808080", "texture": {"checker": [0, 1], "squares": 4}, "texture_scale": [2, 3]},
                      "lamp": {"emission": [3, 2, 1], "keys": [{"at": 0, "power": 1}, {"at": 1, "power": 0}], "interpolation": "linear"}}})");
    const auto material = [&](std::size_t object) {
        return a.materials[static_cast<std::size_t>(a.objects[object].material)];
    };
    EXPECT_TRUE(material(0).specular_glossiness);
    EXPECT_EQ(material(0).specular, glm::vec3(0));
    EXPECT_NEAR(material(0).base_color.x, 0.2158605, 1e-5);  // [sRGB] of 128 / 255
    EXPECT_EQ(material(0).base_color_texture.transform[1][1], 3);
    ASSERT_TRUE(material(0).base_color_texture.present());
    EXPECT_GT(a.images[static_cast<std::size_t>(material(0).base_color_texture.image)].bytes.size(), 1000u);
    EXPECT_FALSE(material(1).specular_glossiness);
    EXPECT_EQ(material(1).roughness, 0.3f);
    EXPECT_TRUE(material(2).specular_glossiness);
    EXPECT_NEAR(thing_at(a, 0.5).emission_factor[static_cast<std::size_t>(a.objects[3].material)], 0.5, 1e-5);
}

TEST(AnimationFileThings, MaterialsAreOfTheModelThatTheySay) {
    const Animation a = parsed(
        R"({"objects": [{"shape": "box", "material": "three"}, {"shape": "box", "material": "four"}, {"shape": "box", "material": "own"}],
        "materials": {"three": {"model": "principled-3", "specular": 0.7, "roughness": 0.9},
                      "four": {"model": "principled-4", "coat_ior": 1.4, "coat_tint": [1, 0.5, 0], "gloss": 0.2, "diffuse_roughness": 0.5},
                      "own": {"roughness": 0.3}}})");
    const auto material = [&](std::size_t object) {
        return a.materials[static_cast<std::size_t>(a.objects[object].material)];
    };
    EXPECT_EQ(material(0).model, SurfaceModel::principled_3);
    EXPECT_FALSE(material(0).specular_glossiness);
    EXPECT_EQ(material(0).specular_level, 0.7f);
    EXPECT_FALSE(material(0).multiscatter);
    EXPECT_EQ(material(1).model, SurfaceModel::principled_4);
    EXPECT_TRUE(material(1).multiscatter) << "Blender 4's own";
    EXPECT_EQ(material(1).coat_ior, 1.4f);
    EXPECT_EQ(material(1).coat_tint, glm::vec3(1, 0.5f, 0));
    EXPECT_EQ(material(1).gloss, glm::vec3(0.2f));
    EXPECT_EQ(material(1).diffuse_roughness, 0.5f);
    EXPECT_EQ(material(2).model, SurfaceModel::gltf);
    EXPECT_THROW(parsed(R"({"objects": [{"shape": "box", "material": {"specular": 0.5}}]})"), core::Error);
    EXPECT_THROW(parsed(R"({"objects": [{"shape": "box", "material": {"model": "principled-2"}}]})"), core::Error);
}

TEST(AnimationFileThings, ChangesMoveHideAndRepaintWhatTheSceneHas) {
    const std::string obj = "o left\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\no right\nv 5 0 0\nv 6 0 0\nv 5 1 0\nf 4 5 6\n";
    const Animation a = parsed(R"({"scene": "two.obj", "change": {
        "left": {"keys": [{"at": 0, "position": [0, 0, 0]}, {"at": 1, "position": [0, 4, 0]}], "interpolation": "linear"},
        "right": {"visible": false, "material": {"base_color": [1, 0, 0]}}}})",
                               {{"two.obj", obj}});
    ASSERT_EQ(a.objects.size(), 2u);
    const std::size_t left = a.objects[0].name == "left" ? 0 : 1;
    EXPECT_NEAR(thing_at(a, 0.5).objects[left].to_world[3].y, 2, 1e-5);
    EXPECT_FALSE(thing_at(a, 0.5).objects[1 - left].present);
    EXPECT_EQ(glm::vec3(a.materials[static_cast<std::size_t>(a.objects[1 - left].material)].base_color),
              glm::vec3(1, 0, 0));
    EXPECT_NE(a.objects[0].material, a.objects[1].material);
}

TEST(AnimationFileThings, SkiesAreColoursImagesOrGradients) {
    EXPECT_EQ(parsed(R"({"sky": [1, 2, 3]})").sky.color, glm::vec3(1, 2, 3));
    const Animation gradient = parsed(R"({"sky": {"zenith": [0, 0, 4], "horizon": 2, "strength": 0.5}})");
    EXPECT_EQ(gradient.sky.color, glm::vec3(2));
    ASSERT_GE(gradient.sky.image, 0);
    EXPECT_GT(gradient.images[static_cast<std::size_t>(gradient.sky.image)].bytes.size(), 1000u);
    EXPECT_THROW(parsed(R"({"sky": {"zenith": 1, "horizon": 1, "color": 1}})"), core::Error);
    EXPECT_THROW(parsed(R"({"sky": {"zenith": 1}})"), core::Error);
}

TEST(AnimationFileThings, NoCutFileEndsInAnythingButAnError) {
    std::ifstream in(support::source_folder() / "animations/mirror_and_glass/film.json");
    std::string whole((std::istreambuf_iterator<char>(in)), {});
    ASSERT_GT(whole.size(), 1000u);
    whole = std::regex_replace(whole, std::regex(R"("[a-z]+\.png")"), R"({"checker": [0, 1], "squares": 2})");
    ASSERT_GT(parsed(whole).objects.size(), 10u);
    for (std::size_t i = 0; i < 200; ++i) {
        // Cut somewhere, or change one byte: either an error or a film, never a crash.
        const auto where = static_cast<std::size_t>(core::uniform(1, i) * static_cast<float>(whole.size()));
        std::string broken = whole;
        if (i % 2)
            broken.resize(where);
        else
            broken[where] = static_cast<char>(static_cast<int>(core::uniform(2, i) * 256));
        try {
            parsed(broken);
            EXPECT_EQ(i % 2, 0u) << "a cut file was accepted";
        } catch (const core::Error& e) {
            EXPECT_GT(std::string(e.what()).size(), 10u);
        }
    }
}

}  // namespace
}  // namespace render2mpeg::scene
