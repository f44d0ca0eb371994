// Pixels that are looked at more closely, since edges in them would show.
#include "renderer/view/refine_edges.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/color.h"
#include "core/sampling.h"
#include "parallel/loops.h"
#include "tests/renderer/film_stage.h"

namespace render2mpeg::renderer {
namespace {

using test::FilmStage;
using test::SceneBuilder;

TEST(LookCloser, KnowsHowFarSamplesErrAtEdges) {
    for (const int samples : {4, 16, 64, 256}) {
        const std::vector<glm::vec2> pattern = sample_pattern(samples), fine = sample_pattern(4096);
        double squares = 0;
        constexpr int lines = 400;
        for (std::uint64_t i = 0; i < lines; ++i) {
            const double angle = 2 * std::numbers::pi * core::uniform(1, i), off = core::uniform(2, i) - 0.5;
            const auto share = [&](const std::vector<glm::vec2>& places) {
                double inside = 0;
                for (const glm::vec2 p : places)
                    inside += (p.x - 0.5) * std::cos(angle) + (p.y - 0.5) * std::sin(angle) < off ? 1.0 : 0.0;
                return inside / static_cast<double>(places.size());
            };
            const double error = share(pattern) - share(fine);
            squares += error * error / lines;
        }
        EXPECT_NEAR(std::sqrt(squares) / edge_error(samples), 1.0, 0.25) << samples;
    }
}

constexpr int size = 24;

/// A floor under the sun, and a half plane over it whose shadow ends at x = 0.2 z + 0.03.
SceneBuilder shadow_edge() {
    SceneBuilder b;
    b.add_quad({-50, 0, -50}, {0, 0, 100}, {100, 0, 0}, b.add_material(glm::vec3(0.5f)));
    b.add_quad({-50 - 10 + 0.03f, 2, -50}, {50, 0, 0}, {20, 0, 100}, b.add_material(glm::vec3(0)));
    b.add_sun({0, -1, 0}, 2);
    b.add_camera({0.9f, 1.2f, 0.01f}, {0, 0, 0}, 0.9f);
    return b;
}

/// The share of a pixel that the sun reaches.
double lit_share(const scene::Camera& camera, int x, int y) {
    double lit = 0;
    constexpr int fine = 32;
    for (int i = 0; i < fine * fine; ++i) {
        const glm::vec2 place(static_cast<float>(x) + (static_cast<float>(i % fine) + 0.5f) / fine,
                              static_cast<float>(y) + (static_cast<float>(i / fine) + 0.5f) / fine);
        const scene::Ray ray = camera.ray_through(place);
        const glm::vec3 p = ray.origin - ray.origin.y / ray.direction.y * ray.direction;
        lit += p.x > 0.2f * p.z + 0.03f ? 1.0 / (fine * fine) : 0.0;
    }
    return lit;
}

struct ClosePicture {
    Lit lit;
    double error = 0;  ///< root mean square of lit shares, of pixels that the edge crosses
};

/// Lit after a closer look, where the picture is expected to be what a first look shows.
ClosePicture look(int most_samples, float tolerated) {
    Settings settings = test::small_frame(size, size);
    settings.samples = 4;
    settings.vpls = 0;
    settings.most_samples = most_samples;
    FilmStage stage(shadow_edge(), settings);
    const scene::Snapshot world = stage.at(0);
    ClosePicture picture;
    picture.lit.frame = stage.renderer().look(world);
    const core::Radiance rough =
        stage.renderer()
            .light(world, picture.lit.frame, {core::ToleranceMap::uniform(size, size, {0, 0.02f})})
            .radiance;
    core::ToleranceMap tolerance = core::ToleranceMap::uniform(size, size, {});
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x)
            tolerance.pixels.at(x, y) = {tolerated, 0.001f, core::luminance(rough.combined.at(x, y)) + tolerated};
    picture.lit = stage.renderer().light(world, std::move(picture.lit.frame), {tolerance});
    double squares = 0, pixels = 0;
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            const double lit = lit_share(world.camera, x, y);
            if (lit < 0.02 || lit > 0.98) continue;
            const double error = picture.lit.radiance.combined.at(x, y).x / (2 * 0.5 / std::numbers::pi) - lit;
            squares += error * error;
            pixels += 1;
        }
    EXPECT_GT(pixels, 10);
    picture.error = std::sqrt(squares / pixels);
    return picture;
}

int pixels_with(const Frame& seen, int samples) {
    int count = 0;
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) count += seen.samples.empty() || seen.samples.at(x, y) == samples ? 1 : 0;
    return count;
}

TEST(LookCloser, MakesShadowEdgesAsFineAsTheyMayBe) {
    // Light is 0.32 where the sun shines.
    const ClosePicture first = look(0, 0.001f), some = look(64, 0.001f), most = look(256, 0.001f);
    EXPECT_GT(first.error, 0.04);
    EXPECT_LT(some.error, 1.5 * edge_error(64));
    EXPECT_LT(most.error, 1.5 * edge_error(256));
    EXPECT_GT(pixels_with(most.lit.frame, 256), 20);
    // At most three pixels of each row, of 24.
    EXPECT_GT(pixels_with(most.lit.frame, 4), size * size / 2);
    // What may err by more is not looked at again.
    EXPECT_EQ(pixels_with(look(256, 0.1f).lit.frame, 4), size * size);
}

/// Leaves of four by four in a pixel, dark and light, tilted at random.
SceneBuilder foliage() {
    constexpr int across = 4 * size;
    SceneBuilder b;
    const int dark = b.add_material(glm::vec3(0.1f)), light = b.add_material(glm::vec3(0.9f));
    for (int i = 0; i < across * across; ++i) {
        const auto dice = [&](std::uint64_t k) { return core::uniform(5, static_cast<std::uint64_t>(i), k); };
        const float leaf = 1.0f / across;
        const glm::vec3 corner(leaf * static_cast<float>(i % across) - 0.5f, 0.02f * dice(0),
                               leaf * static_cast<float>(i / across) - 0.5f);
        b.add_quad(corner, {0, 0.6f * leaf * (dice(1) - 0.5f), leaf}, {leaf, 0.6f * leaf * (dice(2) - 0.5f), 0},
                   dice(3) < 0.5f ? dark : light);
    }
    b.add_sun({0, -1, 0}, 2);
    b.add_camera({0, 1.1f, 0.001f}, {0, 0, 0}, 0.82f);
    return b;
}

/// Foliage lit with so many samples, and with more where `expected` says that they are wanted.
core::Plane<glm::vec3> leaves(int samples, int most_samples, const core::Plane<glm::vec3>* expected, float tolerated) {
    Settings settings = test::small_frame(size, size);
    settings.samples = settings.edge_samples = samples;
    settings.vpls = 0;
    settings.most_samples = most_samples;
    FilmStage stage(foliage(), settings);
    core::ToleranceMap tolerance = core::ToleranceMap::uniform(size, size, {tolerated, 0.001f});
    for (std::size_t i = 0; expected != nullptr && i < expected->size(); ++i)
        tolerance.pixels.values()[i].background = core::luminance(expected->values()[i]) + tolerated;
    const scene::Snapshot world = stage.at(0);
    return stage.renderer().light(world, stage.renderer().look(world), {tolerance}).radiance.combined;
}

TEST(LookCloser, SeesLeavesOfWhichPixelsShowManyAsWellAsTheyMayErr) {
    constexpr float tolerated = 0.02f;
    const core::Plane<glm::vec3> truth = leaves(256, 0, nullptr, tolerated);
    const auto error = [&](const core::Plane<glm::vec3>& picture) {
        double squares = 0;
        for (std::size_t i = 0; i < truth.size(); ++i)
            squares += std::pow(core::luminance(picture.values()[i] - truth.values()[i]), 2);
        return std::sqrt(squares / static_cast<double>(truth.size()));
    };
    EXPECT_GT(error(leaves(16, 0, &truth, tolerated)), 2.0 * tolerated);
    EXPECT_LT(error(leaves(16, 64, &truth, tolerated)), 1.3 * tolerated);
}

TEST(LookCloser, DoesNotDependOnThreads) {
    ClosePicture pictures[2];
    for (const int threads : {1, 4}) {
        const parallel::ThreadLimit limit(threads);
        pictures[threads / 4] = look(256, 0.001f);
    }
    EXPECT_TRUE(test::same_bytes(pictures[0].lit.radiance, pictures[1].lit.radiance));
}

}  // namespace
}  // namespace render2mpeg::renderer
