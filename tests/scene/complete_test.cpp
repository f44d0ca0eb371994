#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/numeric.h"
#include "scene/load.h"
#include "scene/pose/snapshot.h"
#include "scene/preparation/complete.h"
#include "scene/preparation/traits.h"

namespace render2mpeg::scene {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr PictureFormat format{320, 240, 1};

bool has_note(const Animation& film, const std::string& part) {
    return std::any_of(film.notes.begin(), film.notes.end(),
                       [&](const std::string& n) { return n.find(part) != std::string::npos; });
}

Mesh square() {
    Mesh mesh;
    mesh.name = "square";
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

/// A square at a node, with a camera and a sky.
Animation square_film(double scale = 1, glm::dvec3 offset = glm::dvec3(0)) {
    Animation film;
    film.source = "film";
    film.nodes.resize(3);
    film.nodes[0].translation = offset;
    film.nodes[1].parent = film.nodes[2].parent = 0;
    film.nodes[1].rotation = glm::angleAxis(0.3, glm::normalize(glm::dvec3(1, 2, 3)));
    film.nodes[2].translation = scale * glm::dvec3(0.5, 0.25, 4);
    film.meshes.push_back(square());
    for (glm::vec3& p : film.meshes[0].positions) p *= static_cast<float>(scale);
    film.materials.emplace_back();
    Object object;
    object.node = 1;
    object.mesh = 0;
    film.objects.push_back(object);
    CameraLens lens;
    lens.node = 2;
    film.cameras.push_back(lens);
    film.sky.color = glm::vec3(1);
    return film;
}

void expect_refused(const Animation& broken, const std::string& word) {
    Animation film = broken;
    try {
        complete(film);
        FAIL() << word;
    } catch (const core::Error& error) {
        const std::string line = error.what();
        EXPECT_EQ(line.find("reading film"), 0u) << line;
        EXPECT_NE(line.find(word), std::string::npos) << line;
    }
}

/// Everything that completion may set, as text.
std::string fingerprint(const Animation& film) {
    std::string text = std::to_string(film.nodes.size()) + " " + std::to_string(film.objects.size()) + " " +
                       std::to_string(film.cameras.size()) + " " + std::to_string(film.tracks.size()) + " " +
                       std::to_string(film.duration);
    const auto add = [&](const auto& v) {
        for (int k = 0; k < v.length(); ++k) text += " " + std::to_string(v[k]);
    };
    add(film.origin), add(film.bounds_min), add(film.bounds_max), add(film.sky.color);
    for (const Mesh& mesh : film.meshes) {
        for (const glm::vec3& n : mesh.normals)
            for (int k = 0; k < 3; ++k) text += " " + std::to_string(std::bit_cast<std::uint32_t>(n[k]));
        text += " t" + std::to_string(mesh.triangles.size());
    }
    for (const std::string& note : film.notes) text += "\n" + note;
    return text;
}

TEST(Complete, IsIdempotent) {
    Animation film = square_film(1, {1000, 0, 0});
    film.cameras.clear();
    film.sky = {};
    film.meshes[0].normals = {{3, 1, 2}, {0, 0, 0}, {nan, 0, 1}, {0.1f, 0.2f, 0.3f}};
    film.meshes[0].tangents.assign(4, {3, 4, 5, 0.5f});
    film.meshes[0].triangles.push_back({0, 0, 1});
    film.tracks.push_back(
        {TrackTarget::rotation, 1, Interpolation::linear, 4, {0, 1, 1}, {0, 0, 0, 2, 0, 0, 0, 0, 0, 0, 1, 1}});
    complete(film);
    Animation again = film;
    complete(again);
    EXPECT_EQ(fingerprint(film), fingerprint(again));
    EXPECT_EQ(film.tracks[0].values, again.tracks[0].values);
    EXPECT_EQ(film.meshes[0].tangents, again.meshes[0].tangents);
}

TEST(Complete, DropsAndCountsTrianglesThatCannotBeDrawn) {
    Animation film = square_film();
    Mesh& mesh = film.meshes[0];
    mesh.positions.insert(mesh.positions.end(),
                          {{nan, 0, 0}, {2, 0, 0}, {3, 0, 0}, {0, std::numeric_limits<float>::infinity(), 0}});
    mesh.triangles.insert(mesh.triangles.end(), {{1, 1, 2}, {0, 1, 5}, {1, 5, 6}});
    complete(film);
    EXPECT_EQ(film.meshes[0].triangles.size(), 2u);
    EXPECT_TRUE(has_note(film, "mesh 0 \"square\": dropped 3 triangles without area"));
    for (const glm::vec3& p : film.meshes[0].positions) EXPECT_TRUE(core::is_finite(p));
}

TEST(Complete, RefusesTrianglesWithACornerThatIsNowhere) {
    for (const glm::vec3 nowhere : {glm::vec3(nan, 0, 0), glm::vec3(0, std::numeric_limits<float>::infinity(), 0)}) {
        Animation film = square_film();
        film.meshes[0].positions.push_back(nowhere);
        film.meshes[0].triangles.push_back({0, 1, 4});
        try {
            complete(film);
            FAIL() << "accepted";
        } catch (const core::Error& error) {
            EXPECT_NE(std::string(error.what()).find("mesh 0 \"square\": vertex 4 is not finite"), std::string::npos)
                << error.what();
        }
    }
}

TEST(Complete, KeepsNeedlesAndTrianglesOfAnySize) {
    for (const float size : {1e-20f, 1e-4f, 1.0f, 1e7f, 1e15f}) {
        Animation film = square_film();
        film.meshes[0].positions = {{0, 0, 0}, {size, 0, 0}, {size, size * 1e-6f, 0}, {0, size, 0}};
        complete(film);
        EXPECT_EQ(film.meshes[0].triangles.size(), 2u) << size;
    }
}

TEST(Complete, KeepsFlatTrianglesOfShapesThatBend) {
    Animation film = square_film();
    film.meshes[0].positions[2] = {2, 0, 0};
    film.meshes[0].morph_targets.push_back({{{0, 0, 0}, {0, 0, 0}, {0, 1, 0}, {0, 0, 0}}, {}});
    complete(film);
    EXPECT_EQ(film.meshes[0].triangles.size(), 2u);
}

TEST(Complete, MakesNormalsUnitAndDerivesThoseWithoutDirection) {
    Animation film = square_film();
    film.meshes[0].normals = {{0, 0, 5}, {0, 0, 0}, {nan, 0, 1}, {0, 3, 4}};
    complete(film);
    EXPECT_EQ(film.meshes[0].normals[0], glm::vec3(0, 0, 1));
    EXPECT_EQ(film.meshes[0].normals[1], glm::vec3(0, 0, 1));
    EXPECT_EQ(film.meshes[0].normals[2], glm::vec3(0, 0, 1));
    EXPECT_NEAR(glm::length(film.meshes[0].normals[3] - glm::vec3(0, 0.6f, 0.8f)), 0, 1e-6);
    EXPECT_TRUE(has_note(film, "derived 1 normal"));
}

TEST(Complete, ScalesWeightsToOne) {
    Animation film = square_film();
    film.skins.push_back({{0, 1}, {glm::dmat4(1), glm::dmat4(1)}});
    film.objects[0].skin = 0;
    film.meshes[0].joints.resize(4);
    film.meshes[0].joints[0].weight = {3, 1};
    film.meshes[0].joints[1].weight = {-1, 0.5f};
    film.meshes[0].joints[2].weight = {nan, 2};
    film.meshes[0].joints[2].joint = {0, 1};
    complete(film);
    EXPECT_EQ(film.meshes[0].joints[0].weight[0], 0.75f);
    EXPECT_EQ(film.meshes[0].joints[1].weight[1], 1);
    EXPECT_EQ(film.meshes[0].joints[2].weight[0], 0);
    EXPECT_EQ(film.meshes[0].joints[3].weight[0], 1);
}

TEST(Complete, OfKeysAtOneTimeTheLastStays) {
    Animation film = square_film();
    film.tracks.push_back(
        {TrackTarget::translation, 1, Interpolation::linear, 3, {0, 1, 1, 2}, {0, 0, 0, 5, 5, 5, 1, 0, 0, 2, 0, 0}});
    complete(film);
    EXPECT_EQ(film.tracks[0].times, (std::vector<float>{0, 1, 2}));
    EXPECT_EQ(film.tracks[0].values, (std::vector<float>{0, 0, 0, 1, 0, 0, 2, 0, 0}));
    EXPECT_EQ(film.duration, 2);
}

TEST(Complete, RefusesWhatTheRestReliesOn) {
    const auto broken = [](auto change) {
        Animation film = square_film();
        change(film);
        return film;
    };
    expect_refused(broken([](Animation& f) { f.nodes[0].parent = 2; }), "cycle");
    expect_refused(broken([](Animation& f) { f.nodes[1].parent = 1; }), "cycle");
    expect_refused(broken([](Animation& f) { f.nodes[1].parent = 7; }), "node 7");
    expect_refused(broken([](Animation& f) { f.nodes[1].translation.x = std::nan(""); }), "translation");
    expect_refused(broken([](Animation& f) { f.nodes[1].matrix = glm::dmat4(std::nan("")); }), "matrix");
    expect_refused(broken([](Animation& f) { f.nodes[1].rotation.w = std::nan(""); }), "rotation");
    expect_refused(broken([](Animation& f) { f.meshes[0].triangles[1].y = 4; }), "corner 4");
    expect_refused(broken([](Animation& f) { f.meshes[0].normals.resize(3); }), "normals");
    expect_refused(broken([](Animation& f) { f.meshes[0].uv[1].resize(5); }), "second set");
    expect_refused(broken([](Animation& f) { f.objects[0].mesh = 1; }), "mesh 1");
    expect_refused(broken([](Animation& f) { f.objects[0].material = -1; }), "material -1");
    expect_refused(broken([](Animation& f) { f.objects[0].node = 3; }), "node 3");
    expect_refused(broken([](Animation& f) { f.objects[0].skin = 0; }), "skin 0");
    expect_refused(broken([](Animation& f) { f.objects[0].morph_weights = {1}; }), "morph");
    expect_refused(broken([](Animation& f) { f.materials[0].base_color.x = nan; }), "base colour");
    expect_refused(broken([](Animation& f) { f.materials[0].normal_texture.image = 0; }), "image 0");
    expect_refused(broken([](Animation& f) { f.sky.color.x = -1; }), "sky");
    expect_refused(broken([](Animation& f) { f.sky.image = 2; }), "image 2");
    expect_refused(broken([](Animation& f) { f.cameras[0].vertical_fov = nan; }), "field of view");
    expect_refused(broken([](Animation& f) { f.cameras[0].node = 9; }), "node 9");
    expect_refused(broken([](Animation& f) { f.shots = {{0, 1}}; }), "camera 1");
    expect_refused(broken([](Animation& f) { f.frame_rate = "310"; }), "310");
    expect_refused(broken([](Animation& f) {
                       f.tracks.push_back({TrackTarget::scale, 9, Interpolation::linear, 3, {0}, {1, 1, 1}});
                   }),
                   "node 9");
    expect_refused(broken([](Animation& f) {
                       f.tracks.push_back({TrackTarget::emission, 1, Interpolation::linear, 1, {0}, {1}});
                   }),
                   "material 1");
    expect_refused(broken([](Animation& f) {
                       f.tracks.push_back({TrackTarget::scale, 0, Interpolation::linear, 3, {}, {}});
                   }),
                   "no keys");
    expect_refused(broken([](Animation& f) {
                       f.tracks.push_back({TrackTarget::scale, 0, Interpolation::linear, 3, {0}, {1, 1}});
                   }),
                   "2 values");
    expect_refused(broken([](Animation& f) {
                       f.tracks.push_back({TrackTarget::scale, 0, Interpolation::linear, 2, {0}, {1, 1}});
                   }),
                   "values per key");
    expect_refused(broken([](Animation& f) {
                       f.tracks.push_back({TrackTarget::scale, 0, Interpolation::linear, 3, {nan}, {1, 1, 1}});
                   }),
                   "time of key 0");
    expect_refused(broken([](Animation& f) {
                       f.tracks.push_back({TrackTarget::scale, 0, Interpolation::linear, 3, {0}, {1, nan, 1}});
                   }),
                   "key 0 is not finite");
    expect_refused(broken([](Animation& f) {
                       f.tracks.push_back({TrackTarget::field_of_view, 0, Interpolation::linear, 1, {0}, {0}});
                   }),
                   "field of view");
}

TEST(Complete, TellsStillFromRigidFromDeforming) {
    Animation film = square_film();
    film.objects.push_back(film.objects[0]);
    film.objects.push_back(film.objects[0]);
    film.nodes.resize(5);
    film.nodes[3].parent = 0;
    film.nodes[4].parent = 3;
    film.objects[1].node = 4;
    film.objects[2].node = 0;
    film.meshes.push_back(square());
    film.meshes[1].morph_targets.push_back({std::vector<glm::vec3>(4, glm::vec3(0, 0, 1)), {}});
    film.objects[2].mesh = 1;
    film.tracks.push_back({TrackTarget::translation, 3, Interpolation::linear, 3, {0, 1}, {0, 0, 0, 0, 0, 1}});
    film.tracks.push_back(
        {TrackTarget::translation, 1, Interpolation::linear, 3, {0, 5}, {0, 0, 1, 0, 0, 1}});  // says nothing new
    film.tracks.push_back({TrackTarget::weights, 0, Interpolation::linear, 1, {0, 2}, {0, 1}});
    complete(film);
    EXPECT_EQ(film.objects[0].mobility, Mobility::still);
    EXPECT_EQ(film.objects[1].mobility, Mobility::rigid);
    EXPECT_EQ(film.objects[2].mobility, Mobility::deforming);
    EXPECT_EQ(film.duration, 2);
    const Snapshot now = snapshot_at(film, 0, {1, 1}, format);
    EXPECT_EQ(now.objects[0].deformed, -1);
    EXPECT_EQ(now.objects[2].deformed, 0);
    ASSERT_EQ(now.deformed.size(), 1u);
}

TEST(Complete, LeavesScenesNearTheOriginInTheirOwnCoordinates) {
    Animation near = square_film(1, {5, 0, 0}), far = square_film(1, {1e6, -2e6, 3e6});
    complete(near);
    complete(far);
    EXPECT_EQ(near.origin, glm::dvec3(0));
    EXPECT_LT(glm::length(far.origin - glm::dvec3(1e6, -2e6, 3e6)), 2);
    EXPECT_LT(glm::length(far.bounds_max), 2);
}

TEST(Complete, FarScenesLookLikeNearOnes) {
    Animation near = square_film(), far = square_film(1, {1e6, -2e6, 3e6});
    complete(near);
    complete(far);
    const Snapshot a = snapshot_at(near, 0, {0, 1}, format), b = snapshot_at(far, 0, {0, 1}, format);
    for (const glm::vec2 uv : {glm::vec2(0, 0), glm::vec2(0.5f, 0.25f), glm::vec2(0, 1)}) {
        const core::SurfaceAddress address{0, 1, uv.x, uv.y};
        const auto on_a = a.camera.project(*carry(address, a)), on_b = b.camera.project(*carry(address, b));
        ASSERT_TRUE(on_a && on_b);
        EXPECT_LT(glm::length(on_a->position - on_b->position), 1e-3);
    }
}

TEST(Complete, ScenesScaledByAPowerOfTwoAreTheSameBitForBit) {
    for (const glm::dvec3 offset : {glm::dvec3(0.3, 0.1, -0.7), glm::dvec3(100.3, -27.1, 55.5)}) {
        Animation one = square_film(1, offset);
        complete(one);
        const Snapshot a = snapshot_at(one, 0, {0, 1}, format);
        for (const double scale : {std::ldexp(1.0, -20), 2.0, std::ldexp(1.0, 30)}) {
            Animation other = square_film(scale, scale * offset);
            complete(other);
            EXPECT_EQ(other.origin, scale * one.origin);
            EXPECT_EQ(other.bounds_min, static_cast<float>(scale) * one.bounds_min);
            EXPECT_EQ(other.bounds_max, static_cast<float>(scale) * one.bounds_max);
            const Snapshot b = snapshot_at(other, 0, {0, 1}, format);
            for (std::uint32_t t = 0; t < 2; ++t) {
                const core::SurfaceAddress address{0, t, 0.25f, 0.375f};
                const auto pa = carry(address, a), pb = carry(address, b);
                ASSERT_TRUE(pa && pb);
                EXPECT_EQ(*pb, static_cast<float>(scale) * *pa);
                EXPECT_EQ(b.camera.project(*pb)->position, a.camera.project(*pa)->position);
            }
        }
    }
}

TEST(Complete, LightsAFilmWithoutLightByANeutralSkyAndSaysSo) {
    Animation dark = square_film();
    dark.sky = {};
    complete(dark);
    EXPECT_EQ(dark.sky.color, glm::vec3(1));
    EXPECT_TRUE(has_note(dark, "no light"));

    Animation lamp = square_film();
    lamp.sky = {};
    lamp.lights.emplace_back();
    complete(lamp);
    EXPECT_FALSE(lamp.sky.shines());
    Animation glowing = square_film();
    glowing.sky = {};
    glowing.materials[0].emission = {0, 1, 0};
    complete(glowing);
    EXPECT_FALSE(glowing.sky.shines());
}

TEST(LostObjects, AreNamed) {
    for (const glm::vec3 scale : {glm::vec3(1), glm::vec3(1, 1e-12f, 1), glm::vec3(1, 0, 1), glm::vec3(0)}) {
        Animation film = square_film();
        film.objects[0].name = "flat";
        film.nodes[1].scale = scale;
        complete(film);
        EXPECT_EQ(has_note(film, "object 0 \"flat\": a scale of 0"), scale.y == 0) << scale.y;
    }
    for (const double place : {1e3, 1e6, 1e7, -1e9}) {
        Animation film = square_film();
        // Another square stays, so that there is no other origin.
        film.objects.push_back(film.objects[0]);
        film.objects[1].node = 3;
        film.objects[1].name = "far";
        film.nodes.emplace_back();
        film.nodes[3].translation = {place, 0, 0};
        film.nodes.emplace_back();
        film.nodes[4].translation = {-place, 0, 0};
        film.objects.push_back(film.objects[0]);
        film.objects[2].node = 4;
        complete(film);
        EXPECT_EQ(has_note(film, "object 1 \"far\" and 1 other: too far"), std::abs(place) > 1e6) << place;
    }
}

}  // namespace
}  // namespace render2mpeg::scene
