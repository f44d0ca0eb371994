#include "scene/pose/snapshot.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "core/numeric.h"
#include "scene/pose/pose.h"
#include "scene/preparation/complete.h"
#include "scene/preparation/traits.h"

namespace render2mpeg::scene {
namespace {

constexpr PictureFormat snapshot_format{100, 50, 1};

Animation triangle_film() {
    Animation film;
    film.source = "film";
    film.nodes.resize(2);
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.normals.assign(3, {0, 0, 1});
    mesh.triangles = {{0, 1, 2}};
    film.meshes.push_back(mesh);
    film.materials.emplace_back();
    Object object;
    object.node = 0;
    object.mesh = 0;
    film.objects.push_back(object);
    CameraLens lens;
    lens.node = 1;
    film.cameras.push_back(lens);
    film.sky.color = glm::vec3(1);
    return film;
}

Snapshot numbered(const Animation& film, std::int64_t frame) {
    return snapshot_at(film, frame, {frame, 1}, snapshot_format);
}

TEST(Snapshot, IsAPureFunctionOfTheFrame) {
    Animation film = triangle_film();
    film.tracks.push_back({TrackTarget::translation, 0, Interpolation::linear, 3, {0, 10}, {0, 0, 0, 1, 2, 3}});
    complete(film);
    const glm::mat4 straight = numbered(film, 7).objects[0].to_world;
    numbered(film, 3);
    EXPECT_EQ(numbered(film, 7).objects[0].to_world, straight);
    EXPECT_EQ(numbered(film, 7).frame, 7);
}

TEST(Snapshot, NormalsAreTransformedByTheInverseTranspose) {
    Animation film = triangle_film();
    film.nodes[0].scale = {4, 1, 0.5};
    film.nodes[0].rotation = glm::angleAxis(0.7, glm::normalize(glm::dvec3(1, 1, 1)));
    complete(film);
    const ObjectState state = numbered(film, 0).objects[0];
    const glm::mat3 m(state.to_world);
    const glm::mat3 should_be_one = glm::transpose(m) * state.normal_to_world;
    for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r) EXPECT_NEAR(should_be_one[c][r], c == r, 1e-6);
}

TEST(Snapshot, ShearsAndMirrorsArePresentAndScaleZeroIsNot) {
    const auto presence = [](glm::dmat4 matrix) {
        Animation film = triangle_film();
        film.nodes[0].matrix = matrix;
        complete(film);
        return numbered(film, 0).objects[0].present;
    };
    glm::dmat4 shear(1);
    shear[1][0] = 1e6;
    glm::dmat4 mirror(1);
    mirror[0][0] = -1;
    glm::dmat4 flat(1), none(0), tiny(1e-15), huge(1e15);
    flat[2][2] = 0;
    none[3][3] = tiny[3][3] = huge[3][3] = 1;
    EXPECT_TRUE(presence(shear));
    EXPECT_TRUE(presence(mirror));
    EXPECT_TRUE(presence(tiny));
    EXPECT_TRUE(presence(huge));
    EXPECT_FALSE(presence(flat));
    EXPECT_FALSE(presence(none));
}

TEST(Snapshot, VisibilityIsInheritedByWhatHangsOnANode) {
    Animation film = triangle_film();
    film.nodes.resize(3);
    film.nodes[0].parent = 2;
    film.lights.emplace_back();
    film.lights[0].node = 0;
    film.tracks.push_back({TrackTarget::visibility, 2, Interpolation::step, 1, {0, 5}, {1, 0}});
    complete(film);
    EXPECT_TRUE(numbered(film, 4).objects[0].present);
    EXPECT_EQ(numbered(film, 4).lights[0].intensity, glm::vec3(1));
    EXPECT_FALSE(numbered(film, 5).objects[0].present);
    EXPECT_EQ(numbered(film, 5).lights[0].intensity, glm::vec3(0));
    EXPECT_EQ(numbered(film, 5).lights.size(), 1u);
}

TEST(Snapshot, IntensityAndEmissionFollowTheirTracks) {
    Animation film = triangle_film();
    film.lights.emplace_back();
    film.lights[0].intensity = 3;
    film.materials[0].emission = glm::vec3(1);
    film.tracks.push_back({TrackTarget::light_intensity, 0, Interpolation::linear, 1, {0, 2}, {0, 4}});
    film.tracks.push_back({TrackTarget::emission, 0, Interpolation::linear, 1, {0, 2}, {1, -1}});
    complete(film);
    EXPECT_EQ(numbered(film, 1).lights[0].intensity, glm::vec3(6));
    EXPECT_EQ(numbered(film, 0).emission_factor[0], 1);
    EXPECT_EQ(numbered(film, 2).emission_factor[0], 0);  // never below 0
}

TEST(Snapshot, CamerasLoseTheirNodesScaleAndMirror) {
    for (const glm::dvec3 scale : {glm::dvec3(1), glm::dvec3(7), glm::dvec3(-2, 3, 0.5), glm::dvec3(0)}) {
        Animation film = triangle_film();
        film.nodes[1].scale = scale;
        film.nodes[1].rotation = glm::angleAxis(0.4, glm::dvec3(0, 1, 0));
        complete(film);
        const glm::mat3 axes(numbered(film, 0).camera.to_world());
        EXPECT_NEAR(glm::determinant(axes), 1, 1e-5);
        const glm::mat3 product = glm::transpose(axes) * axes;
        for (int c = 0; c < 3; ++c)
            for (int r = 0; r < 3; ++r) EXPECT_NEAR(product[c][r], c == r, 1e-6);
        if (scale == glm::dvec3(0)) continue;
        EXPECT_NEAR(glm::length(axes[2] - glm::vec3(std::sin(0.4f), 0, std::cos(0.4f))), 0, 1e-6);
    }
}

TEST(Snapshot, ShotsChooseTheCameraAndCutWhereItChanges) {
    Animation film = triangle_film();
    film.nodes[1].translation = {0, 0, 5};
    CameraLens second;
    second.node = 0;
    film.cameras.push_back(second);
    film.shots = {{10, 1}, {0, 0}, {20, 1}, {30, 0}};
    complete(film);
    for (const std::int64_t frame : {0, 5, 9, 30, 31}) EXPECT_EQ(numbered(film, frame).camera.position().z, 5) << frame;
    for (const std::int64_t frame : {10, 15, 20, 29}) EXPECT_EQ(numbered(film, frame).camera.position().z, 0) << frame;
    for (std::int64_t frame = 0; frame < 40; ++frame)
        EXPECT_EQ(numbered(film, frame).cut_before, frame == 10 || frame == 30) << frame;
}

TEST(Snapshot, PixelAspectWidensThePicture) {
    Animation film = triangle_film();
    film.nodes[1].translation = {0, 0, 1};
    complete(film);
    const glm::vec3 right_edge =
        snapshot_at(film, 0, {0, 1}, {720, 576, 16.0f / 15.0f}).camera.ray_through({720, 288}).direction;
    const double tangent = std::tan(0.5 * static_cast<double>(film.cameras[0].vertical_fov));
    EXPECT_NEAR(right_edge.x / -right_edge.z, tangent * 4.0 / 3.0, 1e-6);
}

TEST(Snapshot, DeformedNormalsAreUnitAndFollowTheJoints) {
    Animation film = triangle_film();
    film.skins.push_back({{0}, {glm::dmat4(1)}});
    film.objects[0].skin = 0;
    film.meshes[0].joints.resize(3);
    for (VertexJoints& j : film.meshes[0].joints) j.weight[0] = 1;
    film.nodes[0].rotation = glm::angleAxis(0.5, glm::dvec3(1, 0, 0));
    film.nodes[0].scale = {1, 1, 9};
    complete(film);
    const Snapshot now = numbered(film, 0);
    ASSERT_EQ(now.deformed.size(), 1u);
    EXPECT_EQ(now.objects[0].to_world, glm::mat4(1.0f));
    for (const glm::vec3& n : now.deformed[0].normals)
        EXPECT_NEAR(glm::length(n - glm::vec3(0, -std::sin(0.5f), std::cos(0.5f))), 0, 1e-6);
}

TEST(Snapshot, JointsWithoutExtentLeaveFiniteNormals) {
    Animation film = triangle_film();
    film.skins.push_back({{0}, {glm::dmat4(1)}});
    film.objects[0].skin = 0;
    film.meshes[0].joints.resize(3);
    film.nodes[0].scale = glm::dvec3(0);
    complete(film);
    const Snapshot now = numbered(film, 0);
    for (const DeformedMesh& mesh : now.deformed)
        for (const glm::vec3& n : mesh.normals) EXPECT_NEAR(glm::length(n), 1, 1e-6);
}

TEST(Pose, ComposesDeepHierarchiesWithoutRecursion) {
    Animation film = triangle_film();
    const int depth = 200000;
    film.nodes.resize(2 + depth);
    for (int i = 0; i < depth; ++i) {
        film.nodes[static_cast<std::size_t>(2 + i)].parent = i == 0 ? -1 : 1 + i;
        film.nodes[static_cast<std::size_t>(2 + i)].translation = {1, 0, 0};
    }
    film.objects[0].node = 1 + depth;
    complete(film);
    EXPECT_EQ(pose_at(film, 0).world_of(1 + depth)[3].x, depth);
}

TEST(Snapshot, WhatTransformsMultiplyBeyondAllBoundsIsNotPresentAndBreaksNothing) {
    Animation film = triangle_film();
    film.nodes.resize(6);
    film.lights.emplace_back();
    for (int i = 2; i < 6; ++i) {
        film.nodes[static_cast<std::size_t>(i)].parent = i == 2 ? -1 : i - 1;
        film.nodes[static_cast<std::size_t>(i)].scale = glm::dvec3(1e300);
        film.nodes[static_cast<std::size_t>(i)].translation = glm::dvec3(1e300, 0, -1e300);
    }
    film.nodes[0].parent = film.nodes[1].parent = film.lights[0].node = 5;
    for (const bool has_camera : {true, false}) {
        if (!has_camera) film.cameras.clear();
        Animation whole = film;
        complete(whole);
        const Snapshot now = numbered(whole, 0);
        EXPECT_FALSE(now.objects[0].present);
        EXPECT_TRUE(core::is_finite(now.camera.to_world()));
        EXPECT_TRUE(core::is_finite(now.lights[0].position));
        EXPECT_TRUE(core::is_finite(whole.bounds_min) && core::is_finite(whole.bounds_max));
    }
}

TEST(Snapshot, SplinesOfTheFieldOfViewThatOvershootStayInRange) {
    Animation film = triangle_film();
    film.tracks.push_back(
        {TrackTarget::field_of_view, 0, Interpolation::cubic_spline, 1, {0, 10}, {0, 1, 50, -50, 1, 0}});
    complete(film);
    for (std::int64_t frame = 0; frame < 10; ++frame) EXPECT_GT(numbered(film, frame).camera.pixel_size(), 0) << frame;
}

TEST(NormalMatrix, IsTheInverseTransposeOfAnyScale) {
    for (const double scale : {1e-18, 1.0, 1e18}) {
        const glm::dmat3 m = scale * glm::dmat3(1, 2, 0, 0, 3, 1, 2, 0, 1);
        const NormalMatrix n = normal_matrix(m);
        ASSERT_TRUE(n.finite);
        const glm::dmat3 product = glm::transpose(n.matrix) * m;
        for (int c = 0; c < 3; ++c)
            for (int r = 0; r < 3; ++r) EXPECT_NEAR(product[c][r], c == r, 1e-12);
    }
    EXPECT_FALSE(normal_matrix(glm::dmat3(0)).finite);
    EXPECT_FALSE(normal_matrix(glm::dmat3(1, 2, 3, 2, 4, 6, 0, 0, 1)).finite);
    EXPECT_FALSE(normal_matrix(glm::dmat3(std::nan(""))).finite);
    EXPECT_FALSE(normal_matrix(glm::dmat3(1e-50)).finite);
}

TEST(Traits, AreThoseOfWhatTheFilmShows) {
    Animation film = triangle_film();
    complete(film);
    const Traits plain = traits_of(film);
    EXPECT_TRUE(plain.has_surfaces && plain.has_diffuse_surfaces && plain.has_glossy_surfaces && plain.has_shining_sky);
    EXPECT_FALSE(plain.has_mirrors || plain.has_glass || plain.has_textures || plain.has_alpha_mask ||
                 plain.has_alpha_blend);
    EXPECT_FALSE(plain.has_punctual_lights || plain.has_emissive_surfaces || plain.has_normal_maps || plain.has_cuts);
    EXPECT_FALSE(plain.anything_moves());

    film.materials[0].roughness = 0;
    film.materials[0].metallic = 1;
    film.materials[0].transmission = 0;
    EXPECT_TRUE(traits_of(film).has_mirrors);
    EXPECT_FALSE(traits_of(film).has_diffuse_surfaces || traits_of(film).has_glossy_surfaces);
    film.materials[0].metallic = 0;
    film.materials[0].transmission = 0.5f;
    film.materials[0].alpha_mode = AlphaMode::mask;
    film.materials[0].emission = glm::vec3(1);
    film.materials[0].normal_texture.image = 0;
    const Traits rich = traits_of(film);
    EXPECT_TRUE(rich.has_glass && rich.has_alpha_mask && rich.has_emissive_surfaces && rich.has_textures &&
                rich.has_normal_maps);

    // What no object uses does not count.
    film.objects.clear();
    EXPECT_FALSE(traits_of(film).has_glass || traits_of(film).has_surfaces);
}

TEST(Traits, OfMotionComeFromTracksThatVary) {
    const auto traits_with = [](const Track& track) {
        Animation film = triangle_film();
        film.lights.emplace_back();
        film.nodes.resize(3);
        film.lights[0].node = 2;
        film.tracks.push_back(track);
        complete(film);
        return traits_of(film);
    };
    const auto move = [](int node, float x) {
        return Track{TrackTarget::translation, node, Interpolation::linear, 3, {0, 1}, {0, 0, 0, x, 0, 0}};
    };
    EXPECT_TRUE(traits_with(move(0, 1)).objects_move);
    EXPECT_FALSE(traits_with(move(0, 0)).anything_moves());
    EXPECT_TRUE(traits_with(move(1, 1)).camera_moves);
    EXPECT_TRUE(traits_with(move(2, 1)).lights_change);
    EXPECT_TRUE(traits_with({TrackTarget::field_of_view, 0, Interpolation::linear, 1, {0, 1}, {1, 2}}).camera_moves);
    EXPECT_TRUE(traits_with({TrackTarget::light_intensity, 0, Interpolation::linear, 1, {0, 1}, {1, 2}}).lights_change);
    EXPECT_FALSE(traits_with({TrackTarget::light_intensity, 0, Interpolation::linear, 1, {0, 1}, {1, 2}}).objects_move);
}

}  // namespace
}  // namespace render2mpeg::scene
