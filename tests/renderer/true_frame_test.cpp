#include "renderer/truth/true_frame.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/color.h"
#include "parallel/loops.h"
#include "tests/renderer/film_stage.h"
#include "tests/renderer/stage.h"

namespace render2mpeg::renderer {
namespace {

using test::SceneBuilder;
using test::Stage;

constexpr int side = 8;

TrueFrame frame_of(const SceneBuilder& builder, float relative_error, std::uint64_t seed = 1,
                   std::uint64_t most_paths = 1u << 14) {
    const Stage stage(builder, side, side);
    SeeSettings see;
    see.format = {side, side, 1.0f};
    return true_frame(stage.posed_scene(), see, stage.plan(), core::Plane<glm::vec3>(side, side, glm::vec3(0)),
                      {relative_error, most_paths, seed});
}

/// The mean luminance and its standard error, as the pixels tell theirs.
struct FrameMean {
    double value = 0, error = 0;
};
FrameMean mean_of(const TrueFrame& frame) {
    FrameMean m;
    constexpr double pixels = side * side;
    for (std::size_t i = 0; i < frame.radiance.combined.size(); ++i) {
        m.value += static_cast<double>(core::luminance(frame.radiance.combined.values()[i])) / pixels;
        m.error += std::pow(static_cast<double>(frame.radiance.error.values()[i]), 2);
    }
    m.error = std::sqrt(m.error) / pixels;
    return m;
}

void expect_mean(const TrueFrame& frame, double expected) {
    const FrameMean m = mean_of(frame);
    EXPECT_NEAR(m.value, expected, 4 * m.error + 2e-3 * expected) << "+- " << m.error;
    EXPECT_LT(m.error, 0.01 * expected);
}

/// A large floor, a spot of it about the origin seen from nearby.
SceneBuilder spot(float albedo) {
    SceneBuilder b;
    b.add_quad({-50, 0, 50}, {100, 0, 0}, {0, 0, -100}, b.add_material(glm::vec3(albedo)));
    b.add_camera({0.3f, 0.5f, 0}, {0, 0, 0}, 0.02f);
    return b;
}

TEST(TrueFrame, OfAFurnaceIsAGeometricSum) {
    SceneBuilder b;
    const int wall = b.add_material(glm::vec3(0.5f));
    b.material(wall).emission = glm::vec3(1);
    b.add_box({-1, -1, -1}, {1, 1, 1}, wall, true);
    b.add_camera({0, 0, 0}, {0.3f, 0.2f, 1});
    expect_mean(frame_of(b, 0.02f), 2.0);
}

TEST(TrueFrame, OfAnEvenSkyOverAFloorIsItsAlbedo) {
    SceneBuilder b = spot(0.5f);
    b.film().sky.color = glm::vec3(1);
    expect_mean(frame_of(b, 0.02f), 0.5);
}

TEST(TrueFrame, UnderARoundLampIsItsSolidAngleSlow) {
    SceneBuilder b = spot(0.5f);
    b.add_sphere({0, 2, 0}, 0.25f, b.add_emitter(glm::vec3(3)), 64);
    expect_mean(frame_of(b, 0.02f), 0.5 * 3 * 0.25 * 0.25 / 4);
}

TEST(TrueFrame, IsTheSameForAnyNumberOfThreads) {
    const SceneBuilder room = test::furnished_room();
    const TrueFrame one = [&] {
        const parallel::ThreadLimit limit(1);
        return frame_of(room, 0.1f);
    }();
    const TrueFrame all = frame_of(room, 0.1f);
    EXPECT_TRUE(test::same_bytes(one.radiance, all.radiance));
    EXPECT_TRUE(std::ranges::equal(one.radiance.half.values(), all.radiance.half.values()));
    EXPECT_EQ(one.paths, all.paths);
}

TEST(TrueFrame, KnowsItsOwnErrorInHalvesThatAreIndependent) {
    const SceneBuilder room = test::furnished_room();
    const TrueFrame one = frame_of(room, 0.1f), two = frame_of(room, 0.1f, 2);
    double apart = 0, told = 0, between_halves = 0, across = 0;
    for (std::size_t i = 0; i < one.radiance.combined.size(); ++i) {
        const auto of = [&](const core::Plane<glm::vec3>& p) {
            return static_cast<double>(core::luminance(p.values()[i]));
        };
        const double a = of(one.radiance.combined), b = of(two.radiance.combined);
        const double halves_a = 2 * (of(one.radiance.half) - a), halves_b = 2 * (of(two.radiance.half) - b);
        apart += (a - b) * (a - b);
        told += std::pow(static_cast<double>(one.radiance.error.values()[i]), 2) +
                std::pow(static_cast<double>(two.radiance.error.values()[i]), 2);
        between_halves += (halves_a * halves_a + halves_b * halves_b) / 4;
        across += (a - b) * (halves_a - halves_b);
    }
    EXPECT_NEAR(apart / told, 1.0, 0.6);
    EXPECT_NEAR(between_halves / told, 1.0, 0.6);
    EXPECT_LT(std::abs(across), apart);
}

TEST(TrueFrame, TakesAsManyPathsAsItsErrorWants) {
    const SceneBuilder room = test::furnished_room();
    const TrueFrame rough = frame_of(room, 0.1f), fine = frame_of(room, 0.03f);
    EXPECT_GT(fine.paths, 3 * rough.paths);
    EXPECT_LT(mean_of(fine).error, 0.6 * mean_of(rough).error);
    EXPECT_EQ(rough.capped, 0u);
    EXPECT_GT(frame_of(room, 0.01f, 1, 1024).capped, 32u);
}

}  // namespace
}  // namespace render2mpeg::renderer
