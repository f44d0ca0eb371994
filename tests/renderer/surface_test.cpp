#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "core/sampling.h"
#include "image/image.h"
#include "renderer/surface/posed_scene.h"
#include "renderer/surface/shading_normal.h"
#include "stage.h"

namespace render2mpeg::test {
namespace {

using renderer::SurfaceFootprint;
using renderer::SurfacePoint;

/// A PNG that lives as long as its test.
class TestImage {
  public:
    TestImage(int width, int height, const std::vector<unsigned char>& rgb)
        : path_(std::filesystem::path(testing::TempDir()) /
                (std::string("surface_") + testing::UnitTest::GetInstance()->current_test_info()->name() + "_" +
                 std::to_string(count_++) + ".png")) {
        image::write_png(path_, width, height, rgb);
    }
    ~TestImage() { std::filesystem::remove(path_); }
    TestImage(const TestImage&) = delete;
    TestImage& operator=(const TestImage&) = delete;

    scene::TextureUse add_to(SceneBuilder& builder) const {
        builder.film().images.push_back({path_.string(), path_, {}});
        scene::TextureUse use;
        use.image = static_cast<int>(builder.film().images.size()) - 1;
        return use;
    }

  private:
    static inline int count_ = 0;
    std::filesystem::path path_;
};

/// The middle of object 0, a quad from (-1, -1, 0) to (1, 1, 0) that faces +z, seen from straight above.
SurfacePoint at_middle(const Stage& stage, glm::vec3 outgoing = {0, 0, 1}, SurfaceFootprint footprint = {}) {
    return stage.posed_scene().surface_at({0, 0, 0.25f, 0.5f}, outgoing, footprint);
}

SceneBuilder quad_of(int (*add)(SceneBuilder&)) {
    SceneBuilder builder;
    const int material = add(builder);
    builder.add_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, material);
    return builder;
}

TEST(SurfacePoints, LieOnTheViewersSide) {
    const Stage stage(quad_of([](SceneBuilder& b) { return b.add_material(); }));
    for (const float side : {1.0f, -1.0f}) {
        const glm::vec3 outgoing = glm::normalize(glm::vec3{0.3f, 0.2f, side});
        const SurfacePoint point = at_middle(stage, outgoing);
        EXPECT_EQ(point.back_side, side < 0);
        EXPECT_EQ(point.geometric_normal, (glm::vec3{0, 0, side}));
        EXPECT_EQ(point.shading_normal, (glm::vec3{0, 0, side}));
        EXPECT_LT(glm::distance(point.position, {0.5f, 0, 0}), 1e-6f);
    }
}

TEST(SurfacePoints, OfMirroredObjectsKeepTheirFront) {
    SceneBuilder builder;
    const int white = builder.add_material();
    const int mesh = builder.add_mesh(SceneBuilder::sphere(1, 24));
    builder.add_object(mesh, white);
    builder.add_object(mesh, white, {0, 0, 0}, {1, 0, 0, 0}, {-1, 1, 1});
    const Stage stage(builder);
    for (std::uint32_t triangle = 0; triangle < 400; triangle += 7) {
        for (const std::uint32_t object : {0u, 1u}) {
            const glm::vec3 front = stage.posed_scene().front_normal(object, triangle);
            const SurfacePoint point = stage.posed_scene().surface_at({object, triangle, 0.3f, 0.3f}, front);
            EXPECT_FALSE(point.back_side);
            EXPECT_GT(glm::dot(front, glm::normalize(point.position)), 0.95f);
            EXPECT_LT(glm::distance(point.shading_normal, glm::normalize(point.position)), 0.02f);
        }
        const SurfacePoint a = stage.posed_scene().surface_at({0, triangle, 0.3f, 0.3f}, {0, 1, 0});
        const SurfacePoint b = stage.posed_scene().surface_at({1, triangle, 0.3f, 0.3f}, {0, 1, 0});
        EXPECT_LT(glm::distance(a.shading_normal * glm::vec3(-1, 1, 1), b.shading_normal), 1e-6f);
    }
}

TEST(ShadingNormals, OnTheWrongSideGiveWayToTheTriangle) {
    SceneBuilder builder;
    const int white = builder.add_material();
    scene::Mesh mesh = SceneBuilder::quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
    mesh.normals.assign(4, {0, 0, -1});
    builder.add_object(builder.add_mesh(mesh), white);
    const Stage stage(builder);
    EXPECT_EQ(at_middle(stage).shading_normal, (glm::vec3{0, 0, 1}));
}

TEST(ShadingNormals, StaySeenFromTheEyeAtAnyAngle) {
    SceneBuilder builder;
    const int white = builder.add_material();
    scene::Mesh mesh = SceneBuilder::quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
    mesh.normals.assign(4, glm::normalize(glm::vec3{1, 0, 0.3f}));
    builder.add_object(builder.add_mesh(mesh), white);
    const Stage stage(builder);
    for (int i = 1; i < 180; ++i) {
        const float angle = static_cast<float>(i) * 3.14159265f / 180.0f;
        const SurfacePoint point = at_middle(stage, {std::cos(angle), 0, std::sin(angle)});
        EXPECT_NEAR(glm::length(point.shading_normal), 1.0f, 1e-5f);
        EXPECT_GT(glm::dot(point.shading_normal, point.outgoing), 0.0f) << i;
        EXPECT_GT(glm::dot(point.shading_normal, point.geometric_normal), 0.0f) << i;
    }
}

TEST(ShadingNormals, OfWhatMirrorsShowNothingBelowTheTriangle) {
    const glm::vec3 geometric(0, 0, 1);
    int turned = 0;
    for (std::uint64_t i = 0; i < 2000; ++i) {
        const float slope = 1.4f * core::halton(0, i), around = 6.2831853f * core::halton(1, i);
        const float height = std::max(core::halton(2, i), 1e-4f), side = std::sqrt(1.0f - height * height);
        const glm::vec3 outgoing(side, 0, height);
        const glm::vec3 tilted(std::sin(slope) * std::cos(around), std::sin(slope) * std::sin(around), std::cos(slope));
        const glm::vec3 before = renderer::turned_to_viewer(tilted, geometric, outgoing);
        const glm::vec3 n = renderer::turned_to_mirror(before, geometric, outgoing);
        const auto mirrored = [&](glm::vec3 by) { return (2.0f * glm::dot(by, outgoing) * by - outgoing).z; };
        const float least = std::min(0.9f * height, 0.01f);
        ASSERT_NEAR(glm::length(n), 1.0f, 1e-5f);
        ASSERT_GT(mirrored(n), least - 1e-5f) << i;
        ASSERT_GT(glm::dot(n, outgoing), 0.0f) << i;
        if (mirrored(before) >= least) {
            ASSERT_EQ(n, before);
            continue;
        }
        ++turned;
        // The least turn, within the plane.
        ASSERT_NEAR(mirrored(n), least, 1e-5f) << i;
        ASSERT_NEAR(glm::dot(n, glm::cross(before, geometric)), 0.0f, 1e-5f) << i;
        ASSERT_GT(glm::dot(n, before), glm::dot(geometric, before) - 1e-5f) << i;
    }
    EXPECT_GT(turned, 500);
    EXPECT_EQ(renderer::turned_to_mirror(geometric, geometric, {1, 0, 0}), geometric);
}

TEST(ShadingNormals, OfMetalAndVarnishTurnTheirLobesAndFresnelTerms) {
    SceneBuilder builder;
    const int metal = builder.add_material(), varnish = builder.add_material({0.5f, 0.5f, 0.5f}),
              matt = builder.add_material();
    builder.material(metal).metallic = 1;
    builder.material(metal).roughness = 0.1f;
    builder.material(varnish).metallic = 0;
    builder.material(varnish).roughness = 0;
    builder.material(varnish).ior = 1.5f;
    builder.material(matt).metallic = 0;
    builder.material(matt).roughness = 0.9f;
    scene::Mesh mesh = SceneBuilder::quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
    mesh.normals.assign(4, glm::normalize(glm::vec3{1, 0, 1}));
    const int shape = builder.add_mesh(mesh);
    for (const int material : {metal, varnish, matt}) builder.add_object(shape, material);
    const Stage stage(builder);
    const auto seen = [&](std::uint32_t object) {
        return stage.posed_scene().surface_at({object, 0, 0.3f, 0.3f}, glm::normalize(glm::vec3(-1, 0, 1)));
    };
    for (const std::uint32_t object : {0u, 1u}) {
        const SurfacePoint p = seen(object);
        EXPECT_NEAR((2.0f * glm::dot(p.shading_normal, p.outgoing) * p.shading_normal - p.outgoing).z, 0.01f, 1e-4f)
            << object;
    }
    EXPECT_LT(glm::dot(seen(2).shading_normal, seen(2).outgoing), 0.02f);
    // Half a right angle away, not grazing.
    EXPECT_LT(seen(1).bsdf.mirror.y, 0.3f);
    EXPECT_GT(seen(1).bsdf.diffuse.y, 0.3f);
}

TEST(Textures, AreAveragedOverTheFootprint) {
    // Stripes, black and white by turns: a wide footprint sees grey, a point sees one of them.
    std::vector<unsigned char> rgb;
    for (int i = 0; i < 64 * 64; ++i) rgb.insert(rgb.end(), 3, i % 2 == 0 ? 0 : 255);
    const TestImage stripes(64, 64, rgb);
    SceneBuilder builder;
    const int material = builder.add_material({1, 1, 1});
    builder.material(material).base_color_texture = stripes.add_to(builder);
    builder.add_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, material);
    const Stage stage(builder);
    float darkest = 1, lightest = 0;
    for (int i = 0; i < 64; ++i) {
        const core::SurfaceAddress address{0, 0, 0.2f + 0.003f * static_cast<float>(i), 0.4f};
        const float sharp = stage.posed_scene().surface_at(address, {0, 0, 1}).bsdf.diffuse.x;
        darkest = std::min(darkest, sharp);
        lightest = std::max(lightest, sharp);
        const SurfaceFootprint wide{{0.5f, 0, 0}, {0, 0.5f, 0}};
        EXPECT_NEAR(stage.posed_scene().surface_at(address, {0, 0, 1}, wide).bsdf.diffuse.x, 0.5f, 0.02f);
        // Along the stripes a footprint may be as long as it likes.
        const SurfaceFootprint along{{1e-4f, 0, 0}, {0, 0.5f, 0}};
        EXPECT_NEAR(stage.posed_scene().surface_at(address, {0, 0, 1}, along).bsdf.diffuse.x, sharp, 0.12f);
    }
    EXPECT_LT(darkest, 0.1f);
    EXPECT_GT(lightest, 0.9f);
}

TEST(Textures, FollowTheirTransformAndTheVertexColours) {
    // A red left half and a green right half; the transform shows the right half everywhere.
    std::vector<unsigned char> rgb;
    for (int i = 0; i < 8 * 8; ++i)
        rgb.insert(rgb.end(), {static_cast<unsigned char>(i % 8 < 4 ? 255 : 0),
                               static_cast<unsigned char>(i % 8 < 4 ? 0 : 255), 0});
    const TestImage halves(8, 8, rgb);
    SceneBuilder builder;
    const int material = builder.add_material({1, 1, 1});
    scene::TextureUse use = halves.add_to(builder);
    use.transform[0][0] = 0.25f;
    use.transform[0][2] = 0.625f;
    builder.material(material).base_color_texture = use;
    scene::Mesh mesh = SceneBuilder::quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
    mesh.colors.assign(4, {1, 0.5f, 1, 1});
    builder.add_object(builder.add_mesh(mesh), material);
    const Stage stage(builder);
    for (const float u : {0.01f, 0.3f, 0.9f}) {
        const glm::vec3 diffuse = stage.posed_scene().surface_at({0, 0, u, 0.05f}, {0, 0, 1}).bsdf.diffuse;
        EXPECT_LT(glm::distance(diffuse, {0, 0.5f, 0}), 1e-3f);
    }
}

TEST(NormalMaps, TiltRightAndUpAsTheImageSays) {
    // One texel that leans right, one that leans up, both by 45 degrees.
    struct Case {
        unsigned char x, y;
        glm::vec3 expected;
    };
    const float h = std::sqrt(0.5f);
    for (const Case& c : {Case{218, 128, {h, 0, h}}, Case{128, 218, {0, h, h}}, Case{128, 128, {0, 0, 1}}}) {
        std::vector<unsigned char> rgb;
        const unsigned char z = c.x == c.y ? 255 : 218;
        for (int i = 0; i < 16; ++i) rgb.insert(rgb.end(), {c.x, c.y, z});
        const TestImage map(4, 4, rgb);
        for (const bool own_tangents : {false, true}) {
            SceneBuilder builder;
            const int material = builder.add_material({1, 1, 1});
            builder.material(material).normal_texture = map.add_to(builder);
            // uv as glTF has it: v runs down the image, so up the quad it falls.
            scene::Mesh mesh = SceneBuilder::quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
            mesh.uv[0] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
            if (own_tangents) mesh.tangents.assign(4, {1, 0, 0, 1});
            const int mesh_index = builder.add_mesh(mesh);
            builder.add_object(mesh_index, material);
            builder.add_object(mesh_index, material, {5, 0, 0}, {1, 0, 0, 0}, {-1, 1, 1});
            const Stage stage(builder);
            EXPECT_LT(glm::distance(at_middle(stage).shading_normal, c.expected), 0.01f) << own_tangents;
            const glm::vec3 mirrored = stage.posed_scene().surface_at({1, 0, 0.3f, 0.3f}, {0, 0, 1}).shading_normal;
            EXPECT_LT(glm::distance(mirrored, c.expected * glm::vec3(-1, 1, 1)), 0.01f) << own_tangents;
        }
    }
}

TEST(NormalMaps, ThatCannotBeResolvedBecomeRoughness) {
    std::vector<unsigned char> rgb;
    for (int i = 0; i < 32 * 32; ++i)
        rgb.insert(rgb.end(), {static_cast<unsigned char>(i % 2 == 0 ? 200 : 56), 128, 230});
    const TestImage ridges(32, 32, rgb);
    SceneBuilder builder;
    const int material = builder.add_material({1, 1, 1});
    builder.material(material).normal_texture = ridges.add_to(builder);
    builder.material(material).metallic = 1;
    builder.material(material).roughness = 0.3f;
    builder.add_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, material);
    const Stage stage(builder);
    const float far = at_middle(stage, {0, 0, 1}, {{0.5f, 0, 0}, {0, 0.5f, 0}}).bsdf.alpha;
    const SurfacePoint wide = at_middle(stage, {0, 0, 1}, {{0.5f, 0, 0}, {0, 0.5f, 0}});
    EXPECT_NEAR(wide.shading_normal.z, 1.0f, 1e-3f);
    EXPECT_GT(far, 0.3f);
    EXPECT_LT(far, 0.8f);
}

TEST(Emission, IsAveragedOverATexturedTriangle) {
    std::vector<unsigned char> rgb;
    for (int i = 0; i < 16 * 16; ++i) rgb.insert(rgb.end(), 3, i % 16 < 8 ? 255 : 0);
    const TestImage half_lit(16, 16, rgb);
    SceneBuilder builder;
    const int lamp = builder.add_emitter({8, 4, 2});
    scene::TextureUse use = half_lit.add_to(builder);
    use.wrap_u = use.wrap_v = core::Wrap::clamp_to_edge;
    builder.material(lamp).emission_texture = use;
    builder.add_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, lamp);
    const Stage stage(builder);
    // Of the lower right triangle a quarter of the area is lit, of the upper left one three quarters.
    const glm::vec3 lower = stage.posed_scene().mean_emission(0, 0), upper = stage.posed_scene().mean_emission(0, 1);
    EXPECT_NEAR(lower.x, 8 * 0.25f, 0.3f);
    EXPECT_NEAR(upper.x, 8 * 0.75f, 0.3f);
    EXPECT_NEAR(lower.x + upper.x, 8.0f, 0.1f);
    EXPECT_FLOAT_EQ(lower.x, 2 * lower.y);
}

TEST(Emission, ByTheAngleIsItsMeanForLightPoints) {
    SceneBuilder builder;
    const int lamp = builder.add_emitter({8, 4, 2});
    // By the cosine itself.
    scene::AngleCurve curve{scene::AngledInput::emission, glm::vec3(0), {}};
    for (int k = 0; k <= 64; ++k) curve.share.emplace_back(1.0f - static_cast<float>(k * k) / 4096.0f);
    builder.material(lamp).by_angle = {curve};
    builder.add_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, lamp);
    const Stage stage(builder);
    for (const float cosine : {1.0f, 0.7f, 0.3f, 0.05f})
        EXPECT_NEAR(at_middle(stage, {std::sqrt(1 - cosine * cosine), 0, cosine}).emission.x, 8 * cosine, 0.01f);
    EXPECT_NEAR(stage.posed_scene().mean_emission(0, 0).x, 8 * 2 / 3.0f, 0.01f);
    EXPECT_FLOAT_EQ(stage.posed_scene().mean_emission({0, 0, 0.2f, 0.2f}, SurfaceFootprint{}).x,
                    stage.posed_scene().mean_emission(0, 0).x);
}

TEST(Materials, ThatChangeWithTheAngleAreAsTheyAreSeen) {
    const TestImage own(1, 1, {255, 0, 0}), other(1, 1, {0, 255, 0});
    SceneBuilder builder;
    const int index = builder.add_material({1, 1, 1});
    scene::Material& material = builder.material(index);
    material.base_color_texture = own.add_to(builder);
    material.other_base_color_texture = other.add_to(builder);
    material.alpha_mode = scene::AlphaMode::blend;
    const std::vector<glm::vec3> share{glm::vec3(1), glm::vec3(0.5f), glm::vec3(0)};
    material.by_angle = {{scene::AngledInput::base_color, glm::vec3(0.5f), share},
                         {scene::AngledInput::alpha, glm::vec3(0.2f), share}};
    builder.add_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, index);
    const Stage stage(builder);
    const renderer::PosedScene& scene = stage.posed_scene();
    const auto seen_at = [&](float cosine) { return at_middle(stage, {std::sqrt(1 - cosine * cosine), 0, cosine}); };
    EXPECT_NEAR(seen_at(1).bsdf.diffuse.x, 1, 1e-4f);
    EXPECT_NEAR(seen_at(1).bsdf.diffuse.y, 0, 1e-4f);
    EXPECT_NEAR(seen_at(1).alpha, 1, 1e-4f);
    // The root of a quarter is half way.
    const SurfacePoint oblique = seen_at(0.25f);
    EXPECT_NEAR(oblique.bsdf.diffuse.x, 0.5f, 1e-3f);
    EXPECT_NEAR(oblique.bsdf.diffuse.y, 0.25f, 1e-3f);
    EXPECT_NEAR(oblique.alpha, 0.6f, 1e-3f);
    // Shadow rays ask by their own angle, whatever its side.
    const core::SurfaceAddress place{0, 0, 0.25f, 0.5f};
    EXPECT_NEAR(scene.transmittance_at(place, {0, 0, -1}).x, 0, 1e-4f);
    EXPECT_NEAR(scene.transmittance_at(place, {std::sqrt(1 - 0.0625f), 0, 0.25f}).x, 0.4f, 1e-3f);
}

TEST(Materials, FollowMetallicRoughness) {
    // A rough dielectric: 4 % at normal incidence, the rest of the light meets the colour below.
    const Stage plastic(quad_of([](SceneBuilder& b) {
        const int m = b.add_material({0.5f, 0.25f, 1.0f});
        b.material(m).ior = 1.5f;
        b.material(m).roughness = 0.5f;
        return m;
    }));
    const renderer::Bsdf p = at_middle(plastic).bsdf;
    EXPECT_NEAR(p.f0.x, 0.04f, 1e-6f);
    EXPECT_NEAR(p.alpha, 0.25f, 1e-6f);
    EXPECT_NEAR(p.diffuse.x, 0.5f * 0.96f, 0.005f);
    EXPECT_NEAR(p.diffuse.y, 0.5f * p.diffuse.x, 1e-6f);
    EXPECT_NEAR(p.diffuse.z, 0.96f, 0.005f);
    EXPECT_EQ(p.mirror, glm::vec3{0.0f});

    // A rough metal reflects its colour and has nothing below.
    const Stage metal(quad_of([](SceneBuilder& b) {
        const int m = b.add_material({0.9f, 0.6f, 0.3f});
        b.material(m).ior = 1.5f;
        b.material(m).metallic = 1;
        b.material(m).roughness = 0.2f;
        return m;
    }));
    const renderer::Bsdf g = at_middle(metal).bsdf;
    EXPECT_LT(glm::distance(g.f0, {0.9f, 0.6f, 0.3f}), 0.005f);
    EXPECT_EQ(g.diffuse, glm::vec3{0.0f});

    // A smooth one gives the same to a mirror, all of it at grazing angles.
    const Stage mirror(quad_of([](SceneBuilder& b) {
        const int m = b.add_material({0.9f, 0.6f, 0.3f});
        b.material(m).metallic = 1;
        b.material(m).roughness = 0.05f;
        return m;
    }));
    EXPECT_LT(glm::distance(at_middle(mirror).bsdf.mirror, {0.9f, 0.6f, 0.3f}), 1e-6f);
    EXPECT_FALSE(at_middle(mirror).bsdf.has_glossy());
    EXPECT_GT(at_middle(mirror, glm::normalize(glm::vec3{1, 0, 0.01f})).bsdf.mirror.z, 0.9f);
}

TEST(Materials, FollowSpecularGlossiness) {
    const Stage stage(quad_of([](SceneBuilder& b) {
        const int m = b.add_material({0.4f, 0.4f, 0.4f});
        b.material(m).specular_glossiness = true;
        b.material(m).specular = {0.2f, 0.1f, 0.05f};
        b.material(m).glossiness = 0.5f;
        return m;
    }));
    const renderer::Bsdf bsdf = at_middle(stage).bsdf;
    EXPECT_LT(glm::distance(bsdf.f0, {0.2f, 0.1f, 0.05f}), 0.005f);
    EXPECT_NEAR(bsdf.alpha, 0.25f, 1e-6f);
    EXPECT_NEAR(bsdf.diffuse.x, 0.4f * (1 - 0.2f), 0.005f);
}

TEST(Materials, WithoutAnInterfaceReflectAllTheirColour) {
    const Stage stage(quad_of([](SceneBuilder& b) { return b.add_material({0.8f, 0.7f, 0.6f}); }));
    const renderer::Bsdf bsdf = at_middle(stage).bsdf;
    EXPECT_EQ(bsdf.diffuse, (glm::vec3{0.8f, 0.7f, 0.6f}));
    EXPECT_FALSE(bsdf.has_glossy());
}

TEST(Materials, OfBadFilesReflectNoMoreThanTheyReceive) {
    const Stage stage(quad_of([](SceneBuilder& b) { return b.add_material({1.0f, 1.0f, 1.0f}); }));
    const SurfacePoint point = at_middle(stage);
    EXPECT_LE(point.bsdf.diffuse.x + point.bsdf.f0.x + point.bsdf.mirror.x, 1.0f);
}

TEST(Images, ThatCannotBeReadAreNamed) {
    SceneBuilder builder;
    const int material = builder.add_material();
    builder.film().images.push_back({"lost.png", "/nowhere/lost.png", {}});
    builder.material(material).base_color_texture.image = 0;
    builder.add_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, material);
    try {
        const Stage stage(builder);
        FAIL() << "read a file that is not there";
    } catch (const core::Error& error) {
        EXPECT_NE(std::string(error.what()).find("lost.png"), std::string::npos);
    }
}

TEST(Images, WithValuesThatAreNotFiniteAreTold) {
    const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "lamp_with_a_hole.exr";
    constexpr float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    const std::vector<image::Channel> channels{
        {"R", {1, inf, 1, 1}, true}, {"G", {1, 1, nan, 1}, true}, {"B", {1, 1, 1, 1}, true}};
    image::write_exr(file, 2, 2, channels);
    SceneBuilder builder;
    const int lamp = builder.add_emitter({1, 1, 1});
    builder.film().images.push_back({"lamp.exr", file, {}});
    builder.material(lamp).emission_texture.image = 0;
    builder.add_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, lamp);
    const Stage stage(builder);
    ASSERT_EQ(stage.posed_scene().notes().size(), 1u);
    EXPECT_EQ(stage.posed_scene().notes()[0], "lamp.exr: 2 values are not finite: NaN counts as 0, infinity as 65504");
    EXPECT_LT(stage.posed_scene().mean_emission(0, 0).x, 65504.0f) << "a share of the triangle";
    std::filesystem::remove(file);
}

TEST(Images, ThatNobodyLooksAtAreNotRead) {
    SceneBuilder builder;
    const int worn = builder.add_material(), spare = builder.add_material();
    builder.film().images.push_back({"lost.png", "/nowhere/lost.png", {}});
    builder.material(spare).base_color_texture.image = 0;
    builder.material(worn).emission_texture.image = 0;  // of a material that does not shine
    builder.add_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, worn);
    EXPECT_NO_THROW(Stage{builder});
}

}  // namespace
}  // namespace render2mpeg::test
