#include "renderer/surface/opacity_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "core/sampling.h"
#include "renderer/base/plan.h"
#include "renderer/geometry/strands.h"
#include "renderer/surface/posed_scene.h"
#include "scene/model/png.h"
#include "scene/preparation/traits.h"
#include "tests/support/scene_builder.h"

namespace render2mpeg::test {
namespace {

using renderer::Opacity;

/// Numbers of one random scene, drawn one after another.
class Draws {
  public:
    explicit Draws(std::uint64_t scene) : scene_(scene) {}
    float unit() { return core::uniform(91, scene_, next_++); }
    float between(float low, float high) { return low + (high - low) * unit(); }
    int below(int n) { return std::min(static_cast<int>(unit() * static_cast<float>(n)), n - 1); }

  private:
    std::uint64_t scene_, next_ = 0;
};

/// Patches of alpha 0, 255 and anything, in an image of any shape.
int add_image(SceneBuilder& builder, Draws& draws, int width, int height) {
    const int patch = 1 + draws.below(12);
    std::vector<glm::u8vec4> texels;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const float kind = core::uniform(92, static_cast<std::uint64_t>(x / patch),
                                             static_cast<std::uint64_t>(y / patch), static_cast<std::uint64_t>(patch));
            const int alpha = kind < 0.45f ? 0 : kind < 0.9f ? 255 : draws.below(256);
            texels.push_back({draws.below(256), 128, 7, alpha});
        }
    builder.film().images.push_back({"cards", {}, scene::encode_png(width, height, texels)});
    return static_cast<int>(builder.film().images.size()) - 1;
}

scene::TextureUse random_use(int image, Draws& draws) {
    constexpr core::Wrap wraps[] = {core::Wrap::repeat, core::Wrap::mirrored_repeat, core::Wrap::clamp_to_edge};
    scene::TextureUse use;
    use.image = image;
    use.wrap_u = wraps[draws.below(3)];
    use.wrap_v = wraps[draws.below(3)];
    use.nearest = draws.below(3) == 0;
    if (draws.below(2) == 0)
        for (auto& row : use.transform)
            for (float& entry : row) entry = draws.between(-2, 2);
    return use;
}

/// Triangles whose texture coordinates are as wide as a texel or as thousands of images, on a line, in a point, or no
/// numbers.
scene::Mesh random_cards(Draws& draws, int count) {
    constexpr float widths[] = {0.01f, 0.3f, 1.0f, 1.0f, 7.0f, 3000.0f, 1e30f};
    scene::Mesh mesh;
    for (int i = 0; i < count; ++i) {
        const float width = widths[draws.below(7)];
        const glm::vec2 at(draws.between(-3, 3), draws.between(-3, 3));
        for (int k = 0; k < 3; ++k) {
            mesh.positions.push_back({draws.unit(), draws.unit(), draws.unit()});
            mesh.uv[0].push_back(at + width * glm::vec2(draws.unit(), draws.unit()));
        }
        glm::vec2* const uv = &mesh.uv[0][mesh.uv[0].size() - 3];
        if (i % 9 == 1) uv[2] = uv[1];
        if (i % 9 == 2) uv[2] = uv[1] = uv[0];
        if (i % 9 == 3) uv[1] = 0.5f * (uv[0] + uv[2]);
        if (i % 27 == 4) uv[1].x = std::numeric_limits<float>::quiet_NaN();
        if (i % 27 == 13) uv[2].y = std::numeric_limits<float>::infinity();
        if (i % 9 == 5) uv[0] = {0, 0}, uv[1] = {1, 0}, uv[2] = {1, 1};
        const auto first = static_cast<std::uint32_t>(3 * i);
        mesh.triangles.push_back({first, first + 1, first + 2});
    }
    return mesh;
}

/// A film whose object 0 is cards, and its materials.
struct Cards {
    explicit Cards(const SceneBuilder& builder)
        : film(builder.build()),
          plan(renderer::make_plan(scene::traits_of(film), {})),
          store(film),
          materials(film, plan, store),
          maps(film, materials),
          world(snapshot(film, 0, 16, 16)) {}

    float plain_transmittance(const core::SurfaceAddress& address) const {
        renderer::SurfaceShape shape;
        shape.mesh = &film.meshes[static_cast<std::size_t>(film.objects[address.object].mesh)];
        set_corners(shape, address);
        return materials
            .transmittance_at(static_cast<std::uint32_t>(film.objects[address.object].material), shape, world, 1.0f,
                              nullptr, 0.0f)
            .x;
    }

    scene::Animation film;
    renderer::Plan plan;
    renderer::TextureStore store;
    renderer::SurfaceMaterials materials;
    renderer::OpacityMaps maps;
    scene::Snapshot world;
};

scene::Material& add_cut_out(SceneBuilder& builder, int& material) {
    material = builder.add_material();
    builder.material(material).alpha_mode = scene::AlphaMode::mask;
    builder.material(material).alpha_cutoff = 0.5f;
    return builder.material(material);
}

/// Random cards in a random material.
SceneBuilder random_scene(std::uint64_t number, int triangles) {
    Draws draws(number);
    SceneBuilder builder;
    int material = 0;
    scene::Material& m = add_cut_out(builder, material);
    if (draws.below(2) == 0) m.alpha_mode = scene::AlphaMode::blend;
    m.alpha_cutoff = draws.between(0.02f, 0.98f);
    if (draws.below(3) == 0) m.base_color.a = draws.between(0.0f, 1.2f);
    const int which = draws.below(3);
    const int image = add_image(builder, draws, 1 + draws.below(40), 1 + draws.below(40));
    if (which != 1) builder.material(material).base_color_texture = random_use(image, draws);
    if (which != 0) builder.material(material).alpha_texture = random_use(image, draws);
    builder.add_object(builder.add_mesh(random_cards(draws, triangles)), material);
    return builder;
}

TEST(OpacityMaps, AnswerAsTexturesDoOrNotAtAllSlow) {
    int known = 0, asked = 0;
    for (std::uint64_t number = 0; number < 60; ++number) {
        constexpr int triangles = 54;
        const Cards cards(random_scene(number, triangles));
        Draws draws(number + 1000);
        for (int i = 0; i < 20000; ++i) {
            float u = draws.unit(), v = draws.unit();
            if (i % 3 == 0) u = std::floor(u * 65) / 64, v = std::floor(v * 65) / 64;  // corners of parts
            if (u + v > 1.0f) u = 1.0f - u, v = 1.0f - v;
            if (i % 50 == 1) v = 1.0f - u;
            const core::SurfaceAddress address{0, static_cast<std::uint32_t>(draws.below(triangles)), u, v};
            const Opacity opacity = cards.maps.at(address);
            ++asked;
            if (opacity == Opacity::mixed) continue;
            ++known;
            ASSERT_EQ(cards.plain_transmittance(address), opacity == Opacity::clear ? 1.0f : 0.0f)
                << "scene " << number << " triangle " << address.primitive << " at " << u << ", " << v;
        }
    }
    // Half of the cards are as wide as many texels, or many images: the rest may be known.
    EXPECT_GT(known, asked / 8);
    EXPECT_LT(known, asked / 2);
}

/// A leaf's card: a disc in an image of this size.
SceneBuilder leaf(int size) {
    SceneBuilder builder;
    int material = 0;
    add_cut_out(builder, material);
    std::vector<glm::u8vec4> texels;
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            const float r = std::hypot(static_cast<float>(x) + 0.5f - 0.5f * static_cast<float>(size),
                                       static_cast<float>(y) + 0.5f - 0.5f * static_cast<float>(size));
            texels.push_back({50, 120, 20, r < 0.4f * static_cast<float>(size) ? 255 : 0});
        }
    builder.film().images.push_back({"leaf", {}, scene::encode_png(size, size, texels)});
    builder.material(material).base_color_texture.image = 0;
    builder.add_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, material);
    return builder;
}

TEST(OpacityMaps, KnowAllOfALeafButItsRim) {
    const Cards cards(leaf(64));
    int count[3] = {};
    Draws draws(7);
    for (int i = 0; i < 40000; ++i) {
        float u = draws.unit(), v = draws.unit();
        if (u + v > 1.0f) u = 1.0f - u, v = 1.0f - v;
        ++count[static_cast<int>(cards.maps.at({0, static_cast<std::uint32_t>(i % 2), u, v}))];
    }
    // The disc is pi * 0.16 of the card, its rim some three texels wide of 64.
    EXPECT_NEAR(count[static_cast<int>(Opacity::mixed)] / 40000.0, 2 * 3.1416 * 0.4 * 3 / 64, 0.05);
    EXPECT_NEAR(count[static_cast<int>(Opacity::opaque)] / 40000.0, 3.1416 * 0.16, 0.08);
    EXPECT_EQ(count[0] + count[1] + count[2], 40000);
}

TEST(OpacityMaps, ShareWhatCardsHaveInCommonAndStayBoundedSlow) {
    const std::size_t one = Cards(leaf(64)).maps.bytes();
    SceneBuilder many = leaf(64);
    scene::Mesh cards;
    for (int i = 0; i < 5000; ++i)
        many.append(cards, many.quad({0, 0, 0.01f * static_cast<float>(i)}, {1, 0, 0}, {0, 1, 0}));
    many.add_object(many.add_mesh(cards), 0);
    // Two states' tables for ten thousand triangles.
    EXPECT_EQ(Cards(many).maps.bytes(), one + (one - 2 * sizeof(std::uint32_t)) + 10000 * sizeof(std::uint32_t));

    // Cards that all differ have coarser tables.
    SceneBuilder different = leaf(1024);
    for (std::size_t i = 0; i < 40000; ++i) {
        const scene::Mesh quad = many.quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
        if (i == 0) cards = {};
        many.append(cards, quad);
        for (std::size_t k = 0; k < 4; ++k) cards.uv[0][4 * i + k] += 1e-5f * static_cast<float>(i);
    }
    different.add_object(different.add_mesh(cards), 0);
    const std::size_t most = Cards(different).maps.bytes();
    EXPECT_LE(most, renderer::OpacityMaps::most_bytes);
    EXPECT_GT(most, renderer::OpacityMaps::most_bytes / 8);
}

TEST(OpacityMaps, AreOnlyOfWhatTexturesAloneCutOut) {
    EXPECT_GT(Cards(leaf(64)).maps.bytes(), 0u);
    const auto without = [](auto&& change) {
        SceneBuilder builder = leaf(64);
        change(builder);
        const Cards cards(builder);
        EXPECT_EQ(cards.maps.at({0, 0, 0.3f, 0.3f}), Opacity::mixed);
        return cards.maps.bytes();
    };
    EXPECT_EQ(without([](SceneBuilder& b) { b.material(0).alpha_mode = scene::AlphaMode::opaque; }), 0u);
    EXPECT_EQ(without([](SceneBuilder& b) { b.material(0).transmission = 0.5f; }), 0u);
    EXPECT_EQ(without([](SceneBuilder& b) { b.film().meshes[0].colors.assign(4, glm::vec4(1)); }), 0u);
    EXPECT_EQ(without([](SceneBuilder& b) {
                  b.add_track(scene::TrackTarget::base_color, 0, 4, {0, 1}, {1, 1, 1, 1, 1, 1, 1, 0});
              }),
              0u);
}

TEST(OpacityMaps, LetRaysBeginAsSurfacePointsDo) {
    const SceneBuilder builder = leaf(64);
    const scene::Animation film = builder.build();
    renderer::PosedScene scene(film, core::detect_isa(), renderer::make_plan(scene::traits_of(film), {}));
    const scene::Snapshot world = snapshot(film, 0, 16, 16);
    scene.pose(world);
    for (const glm::vec3 direction : {glm::vec3(0.6f, 0, -0.8f), glm::vec3(0, 0.6f, 0.8f), glm::vec3(1, 0, 0)}) {
        const core::SurfaceAddress address{0, 1, 0.01f, 0.02f};
        EXPECT_EQ(scene.origin_behind(address, direction),
                  offset_origin(scene.surface_at(address, -direction), direction));
    }
}

}  // namespace
}  // namespace render2mpeg::test
