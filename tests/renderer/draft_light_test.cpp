#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "core/color.h"
#include "parallel/loops.h"
#include "renderer/draft/upsample.h"
#include "scene/pose/motion.h"
#include "tests/renderer/film_stage.h"

/// Drafts: a lattice of lit points, and what earlier frames found.
namespace render2mpeg::renderer {
namespace {

using test::FilmStage;
using test::SceneBuilder;

constexpr int side = 64;

Settings draft_settings() {
    Settings settings = test::lightcuts_frame(side, side);
    settings.samples = 1;
    settings.calibrate = false;
    return settings;
}

core::ToleranceMap tenth() {
    return core::ToleranceMap::uniform(side, side, {0.0f, 0.1f});
}

/// Drafts of these seconds, each with motion to the one before.
std::vector<core::Radiance> drafts(FilmStage& film, const std::vector<int>& seconds, bool motion = true) {
    std::vector<core::Radiance> frames;
    film.renderer().start_chunk(film.at(seconds.front()));
    for (std::size_t i = 0; i < seconds.size(); ++i) {
        const scene::Snapshot world = film.at(seconds[i]);
        const Frame seen = film.renderer().look(world);
        core::MotionField field;
        if (i > 0) field = scene::motion_between(seen.visible, world, film.at(seconds[i - 1]));
        frames.push_back(film.renderer()
                             .light(world, seen, {tenth(), LightingMode::draft, {}, i > 0 && motion ? &field : nullptr})
                             .radiance);
    }
    return frames;
}

/// As a picture of 8 bits would show it, mid grey at the mean of the truth.
double psnr_of(const core::Radiance& frame, const core::Radiance& truth) {
    double mean = 0, square = 0;
    for (const glm::vec3& v : truth.combined.values()) mean += core::luminance(v);
    mean /= static_cast<double>(truth.combined.size());
    const auto code = [&](const glm::vec3& v) {
        return 255 * std::pow(std::min(core::luminance(v) / (4 * mean), 1.0), 0.45);
    };
    for (std::size_t i = 0; i < truth.combined.size(); ++i) {
        const double off = code(frame.combined.values()[i]) - code(truth.combined.values()[i]);
        square += off * off / static_cast<double>(truth.combined.size());
    }
    return 10 * std::log10(255 * 255 / square);
}

TEST(Lattice, HasEveryPlaceOfAWindowOnceInSixteen) {
    std::set<std::pair<int, int>> pixels;
    for (std::int64_t n = 0; n < 16; ++n) {
        const glm::ivec2 phase = lattice_phase(n);
        EXPECT_EQ(lattice_phase(n + 32), phase);
        pixels.emplace(phase.x, phase.y);
    }
    EXPECT_EQ(pixels.size(), 16u);
    EXPECT_GE(std::abs(lattice_phase(0).x - lattice_phase(1).x), 2);
}

TEST(Lattice, LightsEveryPixelOnceIn32Frames) {
    for (const int first : {1, 2, 30}) {  // the first frame of a chunk, which carries nothing along, is 0
        std::vector<int> times(16 * 16, 0);
        for (std::int64_t n = first; n < first + 32; ++n) {
            const auto [phase, windows] = lit_pixels_of(n, true);
            const Lattice lattice(16, 16, phase, windows);
            for (int i = 0; i < 16 * 16; ++i) times[static_cast<std::size_t>(i)] += lattice.is_lit(i % 16, i / 16);
        }
        EXPECT_EQ(times, std::vector<int>(16 * 16, 1)) << first;
    }
    EXPECT_EQ(lit_pixels_of(0, false).windows, Windows::all);
}

TEST(Lattice, LightsTheWindowsOfAChessboard) {
    const Lattice all(16, 16, {1, 2}), white(16, 16, {1, 2}, Windows::white), black(16, 16, {1, 2}, Windows::black);
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x) {
            EXPECT_EQ(all.is_lit(x, y), white.is_lit(x, y) || black.is_lit(x, y));
            EXPECT_FALSE(white.is_lit(x, y) && black.is_lit(x, y));
        }
    EXPECT_TRUE(white.is_lit(1, 2));
    EXPECT_TRUE(black.is_lit(5, 2));
    EXPECT_TRUE(white.is_lit(5, 6));
}

TEST(Lattice, InterpolatesAlongASurfaceAndNotAcross) {
    GatherPoint p;
    p.point.geometric_normal = {0, 1, 0};
    p.point.address.object = 1;
    Lattice lattice(16, 16, {0, 0});
    const auto lit = [&](int x, int y, glm::vec3 normal, std::uint32_t object, float light) {
        lattice.add(x, y, {{x * 0.01f, 0, y * 0.01f}, normal, object, direct_path, {glm::vec3(light), glm::vec3(0)}});
    };
    lit(4, 4, {0, 1, 0}, 1, 1.0f);
    lit(8, 4, {0, 1, 0}, 1, 3.0f);
    lit(4, 8, {1, 0, 0}, 2, 100.0f);  // a wall
    lit(8, 8, {1, 0, 0}, 2, 100.0f);
    p.point.position = {0.06f, 0, 0.04f};
    const auto between = lattice.at({6, 4}, p, false, 1.0f);
    EXPECT_NEAR(between.light.irradiance.x, 2.0f, 1e-3f);
    EXPECT_GT(between.weight, 0.1f);
    p.point.geometric_normal = {0, 0, 1};
    EXPECT_EQ(lattice.at({6, 4}, p, false, 1.0f).weight, 0.0f) << "nobody speaks for this surface";
}

TEST(Lattice, AsksFartherWindowsWhereTheNearOnesAreUnlike) {
    GatherPoint p;
    p.point.geometric_normal = {0, 1, 0};
    p.point.address.object = 1;
    p.point.position = {0.06f, 0, 0.06f};
    Lattice lattice(16, 16, {0, 0});
    EXPECT_TRUE(lattice.at_from_afar({6, 6}, p, 1.0f).is_empty);
    for (const glm::ivec2 near : {glm::ivec2(4, 4), {8, 4}, {4, 8}, {8, 8}})
        lattice.add(near.x, near.y, {{0.06f, 0.5f, 0.06f}, {1, 0, 0}, 2, direct_path, {glm::vec3(100), glm::vec3(0)}});
    lattice.add(12, 8, {{0.12f, 0, 0.08f}, {0, 1, 0}, 1, direct_path, {glm::vec3(2), glm::vec3(0)}});
    EXPECT_EQ(lattice.at({6, 6}, p, false, 1.0f).weight, 0.0f);
    const auto found = lattice.at_from_afar({6, 6}, p, 1.0f);
    EXPECT_FALSE(found.is_empty);
    EXPECT_GT(found.weight, 0.0f);
    EXPECT_NEAR(found.light.irradiance.x, 2.0f, 0.05f);
}

TEST(Draft, OfAStillFilmComesToItsLight) {
    FilmStage film(test::furnished_room(), draft_settings());
    film.renderer().start_chunk(film.at(0));
    const core::Radiance truth = film.reference();
    const auto frames = drafts(film, std::vector<int>(16, 0));
    const double first = psnr_of(frames.front(), truth), last = psnr_of(frames.back(), truth);
    EXPECT_GT(last, first);
    EXPECT_GT(last, 36) << first;  // chosen: of a picture of 64x64, where a window is a sixteenth of its side
}

TEST(Draft, DoesNotDependOnTheNumberOfThreads) {
    std::vector<core::Radiance> frames;
    for (const int threads : {1, 3}) {
        const parallel::ThreadLimit limit(threads);
        FilmStage film(test::furnished_room(), draft_settings());
        frames.push_back(drafts(film, {0, 0, 0}).back());
    }
    EXPECT_TRUE(test::same_bytes(frames[0], frames[1]));
}

/// A white ball that crosses a floor under a lamp.
SceneBuilder crossing() {
    SceneBuilder b;
    b.add_box({0, 0, 0}, {5, 3, 5}, b.add_material({0.7f, 0.6f, 0.5f}), true);
    const int ball = b.add_sphere({0, 0, 0}, 0.4f, b.add_material(glm::vec3(0.9f)), 10);
    b.move_object(ball, {{1, 0.6f, 3}, {4.0f, 0.6f, 3}});
    b.add_point_light({2, 2.4f, 3}, 20.0f, {1, 0.8f, 0.6f});
    b.add_camera({2.5f, 1.7f, 4.9f}, {2.5f, 1.0f, 0.0f}, 1.1f);
    return b;
}

TEST(Draft, LeavesNoGhostOfWhatHasMovedOnSlow) {
    FilmStage film(crossing(), draft_settings());
    const double alone = psnr_of(drafts(film, {1}).back(), film.reference(1));
    const double after = psnr_of(drafts(film, {0, 0, 0, 0, 0, 0, 1}).back(), film.reference(1));
    EXPECT_GT(after, alone - 1.0);
    const auto cut = drafts(film, {0, 0, 1}, false), anew = drafts(film, {1}, false);
    EXPECT_GT(psnr_of(cut.back(), film.reference(1)), alone - 1.0) << "without motion nothing is carried";
}

/// A furnished room whose only lamp is shut in a box in the second 1.
SceneBuilder shut_lamp() {
    SceneBuilder b;
    const int white = b.add_material({0.7f, 0.6f, 0.5f});
    b.add_box({0, 0, 0}, {5, 3, 5}, white, true);
    for (int i = 0; i < 12; ++i)
        b.add_sphere({0.4f + 0.4f * static_cast<float>(i), 0.1f, 1.0f + 0.3f * static_cast<float>(i % 7)}, 0.08f, white,
                     6);
    const int shutter = b.add_box({-0.3f, -0.3f, -0.3f}, {0.3f, 0.3f, 0.3f}, b.add_material(glm::vec3(0)));
    b.move_object(shutter, {{2, -5, 3}, {2, 2.4f, 3}});
    b.add_point_light({2, 2.4f, 3}, 20.0f, {1, 0.8f, 0.6f});
    b.add_camera({2.5f, 1.7f, 4.9f}, {2.5f, 1.0f, 0.0f}, 1.1f);
    return b;
}

TEST(Draft, OfALampThatGoesOutIsDark) {
    FilmStage film(shut_lamp(), draft_settings());
    const auto frames = drafts(film, {0, 0, 1});
    EXPECT_GT(psnr_of(frames[1], film.reference(0)), 20);
    for (const glm::vec3& v : frames.back().combined.values()) ASSERT_EQ(v, glm::vec3(0));
    EXPECT_EQ(film.renderer().statistics().non_finite, 0u);
}

}  // namespace
}  // namespace render2mpeg::renderer
