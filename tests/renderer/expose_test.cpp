// What the open shutter and the lens blur.
#include "renderer/view/expose.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "core/color.h"
#include "parallel/loops.h"
#include "renderer/view/exposure_pattern.h"
#include "tests/renderer/film_stage.h"

namespace render2mpeg::renderer {
namespace {

using test::FilmStage;
using test::SceneBuilder;

constexpr int size = 32;

Settings exposed_frame(int vpls = 0) {
    Settings s = test::small_frame(size, size);
    s.samples = 16;
    s.vpls = vpls;
    return s;
}

core::Radiance expose_frame(FilmStage& stage, int samples, int second = 1,
                            const core::ToleranceMap& tolerance = core::ToleranceMap::reference()) {
    const scene::Snapshot world = stage.at(second);
    const ExposureSamples exposure{samples, samples};
    return stage.renderer()
        .light(world, stage.renderer().look(world), {tolerance, LightingMode::film, exposure})
        .radiance;
}

int add_unlit(SceneBuilder& b, glm::vec3 color = glm::vec3(1)) {
    const int m = b.add_material(color);
    b.material(m).unlit = true;
    // Else a film without light gets a bright sky.
    if (b.unfinished().lights.empty()) b.add_sun({0, 0, -1}, 1);
    return m;
}

/// A parallel camera that shows one unit in each pixel, from z = 50 down.
void add_plan_view(SceneBuilder& b) {
    scene::CameraLens lens;
    lens.projection = scene::ProjectionKind::orthographic;
    lens.y_magnification = size / 2.0f;
    b.add_camera(lens, {0, 0, 50}, {0, 0, 0});
}

/// A checked quad about the origin, each field this wide.
void add_checks(SceneBuilder& b, float z, float half, int fields) {
    const int light = b.add_material(glm::vec3(0.8f)), dark = b.add_material(glm::vec3(0.2f));
    const float field = 2 * half / static_cast<float>(fields);
    for (int j = 0; j < fields; ++j)
        for (int i = 0; i < fields; ++i)
            b.add_quad({-half + field * static_cast<float>(i), -half + field * static_cast<float>(j), z}, {field, 0, 0},
                       {0, field, 0}, (i + j) % 2 == 0 ? light : dark);
}

double rms_difference(const core::Radiance& a, const core::Plane<glm::dvec3>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < b.size(); ++i) {
        const glm::dvec3 d = glm::dvec3(a.combined.values()[i]) - b.values()[i];
        sum += glm::dot(d, d) / 3;
    }
    return std::sqrt(sum / static_cast<double>(b.size()));
}

/// Mean of sharp pictures of films that are changed step by step. What exposed frames are off from it is the shadow's
/// edge behind the box: a point that the middle shows in part has one light, that of the part.
core::Plane<glm::dvec3> mean_of_pictures(const std::function<SceneBuilder(int)>& film_at, int steps,
                                         const Settings& settings) {
    core::Plane<glm::dvec3> mean(size, size, glm::dvec3(0));
    for (int k = 0; k < steps; ++k) {
        Settings fine = settings;
        fine.samples = 64;
        FilmStage stage(film_at(k), fine);
        const core::Radiance sharp = stage.shade(1, core::ToleranceMap::reference());
        for (std::size_t i = 0; i < mean.size(); ++i)
            mean.values()[i] += glm::dvec3(sharp.combined.values()[i]) / static_cast<double>(steps);
    }
    return mean;
}

TEST(Expose, MovingEdgeIsAStraightRamp) {
    constexpr int samples = 16;
    constexpr float speed = 16;  // pixels from frame to frame
    SceneBuilder b;
    const int edge = b.add_quad({-100, -100, 0}, {100, 0, 0}, {0, 200, 0}, add_unlit(b));
    b.move_object(edge, {{-speed, 0, 0}, {0.3f, 0, 0}, {speed + 0.6f, 0, 0}});
    add_plan_view(b);
    b.film().shutter.angle = 180;
    FilmStage stage(b, exposed_frame());
    const core::Radiance frame = expose_frame(stage, samples);
    // The edge goes from -4 to 4 about x = 0.3.
    const double way = 0.5 * (static_cast<double>(speed) + 0.3), from = 0.3 - way / 2;
    stage.restart(true);
    const core::Plane<float> coverage = expose_frame(stage, samples).coverage;
    double sum = 0, expected_sum = 0, squares = 0;
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            const double left = x - size / 2.0;
            double expected = 0;
            constexpr int fine = 1024;
            for (int k = 0; k < fine; ++k)
                expected += std::clamp(from + way * (k + 0.5) / fine - left, 0.0, 1.0) / fine;
            const double shown = static_cast<double>(frame.combined.at(x, y).y);
            // A pixel's place samples and its times are not even in every mixture of both.
            EXPECT_NEAR(shown, expected, 1.5 / samples) << x << ", " << y;
            // What lies to the left in the middle takes as much as is lit.
            EXPECT_NEAR(static_cast<double>(coverage.at(x, y)), left + 0.5 < 0.3 ? shown : 1 - shown, 1e-5);
            squares += (shown - expected) * (shown - expected) / (size * size);
            sum += shown;
            expected_sum += expected;
        }
    EXPECT_LT(std::sqrt(squares), 0.5 / samples);
    EXPECT_NEAR(sum / expected_sum, 1.0, 0.006);
}

TEST(Expose, RollingShutterLeansWhatMoves) {
    constexpr float speed = 16, rolling = 0.5f;
    SceneBuilder b;
    const int edge = b.add_quad({-100, -100, 0}, {100, 0, 0}, {0, 200, 0}, add_unlit(b));
    b.move_object(edge, {{-speed, 0, 0}, {0, 0, 0}, {speed, 0, 0}});
    add_plan_view(b);
    b.film().shutter = {36, 0, rolling};
    FilmStage stage(b, exposed_frame());
    const core::Radiance frame = expose_frame(stage, 64);
    for (int y = 0; y < size; ++y) {
        double lit = 0, half = 0;
        for (int x = 0; x < size; ++x) {
            const auto light = static_cast<double>(frame.combined.at(x, y).y);
            lit += light;
            half += light > 0.02 && light < 0.98 ? 1 : 0;
        }
        const double late = static_cast<double>(rolling) * ((y + 0.5) / size - 0.5);
        EXPECT_NEAR(lit, size / 2.0 + static_cast<double>(speed) * late, 0.1) << y;
        // A tenth of a frame's way, and the pixels at its ends.
        EXPECT_LE(half, 3) << y;
    }
}

TEST(Expose, PointOutOfFocusIsADiscOfTheFormula) {
    SceneBuilder b;
    constexpr float depth = 6, focus = 2;
    constexpr float dot = 0.05f;
    b.add_quad({-dot, -dot, -depth}, {2 * dot, 0, 0}, {0, 2 * dot, 0}, add_unlit(b, glm::vec3(1)));
    scene::CameraLens lens;
    lens.vertical_fov = 0.8f;
    lens.f_stop = 1.4f;
    lens.focus_distance = focus;
    lens.sensor_height = 0.9f;
    b.add_camera(lens, {0, 0, 0}, {0, 0, -1});
    Settings fine = exposed_frame();
    fine.samples = 1024;
    FilmStage stage(b, fine);
    const core::Radiance disc = expose_frame(stage, 1024), point = stage.shade(1, core::ToleranceMap::reference());
    const auto moments = [](const core::Radiance& r) {
        double flux = 0, second = 0;
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x) {
                const auto light = static_cast<double>(r.combined.at(x, y).y);
                flux += light;
                second += light * std::pow(x + 0.5 - size / 2.0, 2);
            }
        return std::pair(flux, second / flux);
    };
    const auto [flux, width2] = moments(disc);
    const auto [point_flux, point_width2] = moments(point);
    EXPECT_NEAR(flux / point_flux, 1.0, 0.01);
    // The thin lens' circle, by the film's formula [A |d - d_f| / d x f / (d_f - f)].
    const double f = 0.9 / (2 * std::tan(0.4)), aperture = f / 1.4;
    const double of_film = aperture * (depth - focus) / depth * f / (focus - f), magnified = (focus - f) / focus;
    const double diameter = of_film * magnified / 0.9 * size;
    EXPECT_GT(diameter, 8);
    EXPECT_NEAR(4 * std::sqrt(width2 - point_width2), diameter, 0.5);
    EXPECT_NEAR(static_cast<double>(stage.at(1).camera.circle_of_confusion(depth)), diameter, 0.1);
}

/// Lit things before a wall, of which some move.
SceneBuilder lit_film(const std::function<void(SceneBuilder&, int)>& move) {
    SceneBuilder b;
    add_checks(b, -6, 6, 8);
    const int box = b.add_box({-0.5f, -0.5f, -3.5f}, {0.5f, 0.5f, -2.5f}, b.add_material({0.7f, 0.3f, 0.2f}));
    b.add_point_light({0, 0, 0.2f}, 100);  // what it leaves in shadow is hidden
    move(b, box);
    return b;
}

scene::CameraLens plain_lens() {
    scene::CameraLens lens;
    lens.vertical_fov = 0.9f;
    return lens;
}

TEST(Expose, LampsOutOfFocusAreSampledAgainSlow) {
    // A small lamp, 24 times as bright as white, behind the plane in focus: a disc of eleven pixels.
    SceneBuilder b;
    const int bright = add_unlit(b, glm::vec3(24));
    b.add_quad({-0.25f, -0.25f, -8}, {0.5f, 0, 0}, {0, 0.5f, 0}, bright);
    scene::CameraLens lens;
    lens.vertical_fov = 0.8f;
    lens.f_stop = 1.4f;
    lens.focus_distance = 2;
    lens.sensor_height = 0.9f;
    b.add_camera(lens, {0, 0, 2}, {0, 0, 0});
    FilmStage stage(b, exposed_frame());
    const auto frame = [&](const ExposureSamples& samples) {
        const scene::Snapshot world = stage.at(1);
        const core::ToleranceMap exact = core::ToleranceMap::reference();
        return stage.renderer()
            .light(world, stage.renderer().look(world), {exact, LightingMode::film, samples})
            .radiance;
    };
    const core::Radiance truth = frame({4096, 4096}), few = frame({16, 16});
    const auto code = [](float luminance) { return 16 + 219 * std::sqrt(std::min(luminance, 1.0f)); };
    const core::Radiance again = frame({16, 16, code, 2.0f});
    double few_error = 0, again_error = 0;
    for (std::size_t i = 0; i < truth.combined.size(); ++i) {
        const auto of = [&](const core::Radiance& r) { return code(core::luminance(r.combined.values()[i])); };
        few_error = std::max(few_error, static_cast<double>(std::abs(of(few) - of(truth))));
        again_error = std::max(again_error, static_cast<double>(std::abs(of(again) - of(truth))));
    }
    EXPECT_GT(few_error, 30);  // the rim is ragged
    EXPECT_LT(again_error, 0.4 * few_error);
}

TEST(Expose, MovingCameraShowsTheMeanOfItsPicturesSlow) {
    // It moves by 1.2 to the side from frame to frame; half of that is exposed.
    constexpr int steps = 48;
    constexpr float speed = 1.2f;
    const auto film = [&](float angle, float at) {
        return lit_film([&](SceneBuilder& b, int) {
            b.add_camera(plain_lens(), {0, 0, 0}, {0, 0, -1});
            const int node = b.unfinished().cameras[0].node;
            b.add_track(scene::TrackTarget::translation, node, 3, {0, 1, 2},
                        {-speed + at, 0, 0, at, 0, 0, speed + at, 0, 0});
            b.film().shutter.angle = angle;
        });
    };
    FilmStage stage(film(180, 0), exposed_frame());
    const core::Radiance frame = expose_frame(stage, 256);
    const auto mean =
        mean_of_pictures([&](int k) { return film(0, speed / 2 * ((static_cast<float>(k) + 0.5f) / steps - 0.5f)); },
                         steps, exposed_frame());
    FilmStage still(film(0, 0), exposed_frame());
    const core::Radiance sharp = still.shade(1, core::ToleranceMap::reference());
    EXPECT_LT(rms_difference(frame, mean), 0.07 * rms_difference(sharp, mean));
}

TEST(Expose, TurningBoxShowsTheMeanOfItsPicturesSlow) {
    // A quarter turn from frame to frame, before a black ground without other light than its own.
    constexpr int steps = 48;
    const auto film = [&](float angle, float at) {
        SceneBuilder b;
        const int colors[2] = {add_unlit(b, {0.9f, 0.4f, 0.1f}), add_unlit(b, {0.1f, 0.4f, 0.9f})};
        for (int k = 0; k < 2; ++k) {
            const float low = k == 0 ? -10.0f : 0.0f;
            const int half = b.add_quad({low, -3, 0}, {10, 0, 0}, {0, 6, 0}, colors[k]);
            const int node = b.unfinished().objects[static_cast<std::size_t>(half)].node;
            std::vector<float> turns;
            for (const float t : {0.0f, 1.0f, 2.0f}) {
                const float half_angle = 0.5f * (t - 1 + at) * std::numbers::pi_v<float> / 2;
                turns.insert(turns.end(), {0, 0, std::sin(half_angle), std::cos(half_angle)});
            }
            b.add_track(scene::TrackTarget::rotation, node, 4, {0, 1, 2}, turns);
        }
        add_plan_view(b);
        b.film().shutter.angle = angle;
        return b;
    };
    FilmStage stage(film(180, 0), exposed_frame());
    const core::Radiance frame = expose_frame(stage, 256);
    const auto mean = mean_of_pictures(
        [&](int k) { return film(0, 0.5f * ((static_cast<float>(k) + 0.5f) / steps - 0.5f)); }, steps, exposed_frame());
    EXPECT_LT(rms_difference(frame, mean), 0.02);
    const scene::Snapshot world = stage.at(1);
    ASSERT_TRUE(world.sweep);
    EXPECT_GT(world.sweep->segments(), 2);
}

TEST(Expose, LensShowsTheMeanOfPicturesThroughItsPartsSlow) {
    constexpr int steps = 61;
    constexpr float focus = 3;
    const auto film = [&](float f_stop, glm::vec2 place) {
        return lit_film([&](SceneBuilder& b, int) {
            scene::CameraLens lens = plain_lens();
            lens.f_stop = f_stop;
            lens.focus_distance = focus;
            lens.sensor_height = 0.5f;
            // Seen from beside, and shifted so that what is in focus stays.
            lens.shift = -place / (focus * 2 * std::tan(0.45f));
            b.add_camera(lens, {place.x, place.y, 0}, {place.x, place.y, -1});
        });
    };
    FilmStage stage(film(0.6f, {}), exposed_frame());
    const float radius = stage.at(1).camera.lens().aperture_radius;
    EXPECT_NEAR(radius, 0.5f / (2 * std::tan(0.45f)) / 1.2f, 1e-5);
    const core::Radiance frame = expose_frame(stage, 256);
    const auto mean = mean_of_pictures(
        [&](int k) {
            const float r = radius * std::sqrt((static_cast<float>(k) + 0.5f) / steps),
                        angle = 2.39996f * static_cast<float>(k);
            return film(0, {r * std::cos(angle), r * std::sin(angle)});
        },
        steps, exposed_frame());
    FilmStage still(film(0, {}), exposed_frame());
    EXPECT_LT(rms_difference(frame, mean),
              0.15 * rms_difference(still.shade(1, core::ToleranceMap::reference()), mean));
}

TEST(Expose, ChangesNothingThatNeitherMovesNorIsOutOfFocus) {
    const auto film = [](float angle, float f_stop, glm::vec3 to) {
        SceneBuilder b;
        add_checks(b, -4, 8, 16);
        b.add_point_light({2, 3, 2}, 30);
        scene::CameraLens lens = plain_lens();
        lens.f_stop = f_stop;
        lens.focus_distance = 4;
        b.add_camera(lens, {0, 0, 0}, {0, 0, -1});
        if (to != glm::vec3(0)) b.move_object(0, {{0, 0, 0}, {0, 0, 0}, to});
        b.film().shutter.angle = angle;
        return b;
    };
    FilmStage sharp(film(0, 0, {}), exposed_frame());
    const core::Radiance expected = expose_frame(sharp, 16);
    // An open shutter over what stands still; a lens that has all in focus; a thing that moves a hundredth of a pixel.
    FilmStage open(film(360, 0, {}), exposed_frame()), focused(film(0, 2.8f, {}), exposed_frame());
    EXPECT_TRUE(test::same_bytes(expose_frame(open, 16), expected));
    EXPECT_EQ(open.statistics().exposure_rays, 0u);
    EXPECT_TRUE(test::same_bytes(expose_frame(focused, 16), expected));
    EXPECT_EQ(focused.statistics().exposed_pixels, 0u);
}

TEST(Expose, ShowsWhatMirrorsThrowSlow) {
    const auto mean = [](bool caustics, float angle) {
        SceneBuilder b;
        b.add_quad({-4, -1, 0}, {8, 0, 0}, {0, 0, -8}, b.add_material(glm::vec3(0.5f)));
        const int silver = b.add_material(glm::vec3(1));
        b.material(silver).metallic = 1;
        b.material(silver).roughness = 0;
        b.add_quad({-4, -1, -8}, {8, 0, 0}, {0, 3, 0}, silver);
        b.add_sun({0.1f, -1, -1}, 3);
        b.add_camera(plain_lens(), {0, 2, 1}, {0, -1, -5});
        const int node = b.unfinished().cameras[0].node;
        b.add_track(scene::TrackTarget::translation, node, 3, {0, 1, 2}, {-1, 2, 1, 0, 2, 1, 1, 2, 1});
        b.film().shutter.angle = angle;
        FilmStage stage(b, exposed_frame(), caustics);
        const core::Radiance frame =
            expose_frame(stage, 16, 1, core::ToleranceMap::uniform(size, size, {0.001f, 0.02f}));
        double sum = 0;
        for (const glm::vec3& pixel : frame.combined.values()) sum += static_cast<double>(pixel.y);
        return sum / (size * size);
    };
    const double without = mean(false, 180), sharp = mean(true, 0);
    EXPECT_GT(sharp, 1.1 * without);
    EXPECT_NEAR(mean(true, 180) / sharp, 1.0, 0.03);
}

TEST(Expose, IsTheSameForAnyNumberOfThreads) {
    const auto frame = [](int threads) {
        const parallel::ThreadLimit limit(threads);
        FilmStage stage(lit_film([](SceneBuilder& b, int box) {
                            scene::CameraLens lens = plain_lens();
                            lens.f_stop = 2;
                            lens.sensor_height = 0.5f;
                            lens.focus_distance = 4;
                            b.add_camera(lens, {0, 0, 0}, {0, 0, -1});
                            b.move_object(box, {{-2, 0, 0}, {0, 0, 0}, {2, 1, 0}});
                            b.film().shutter.angle = 180;
                        }),
                        exposed_frame(200));
        return expose_frame(stage, 16, 1, core::ToleranceMap::uniform(size, size, {0.001f, 0.02f}));
    };
    EXPECT_TRUE(test::same_bytes(frame(1), frame(3)));
}

TEST(Expose, GathersLightOnceForAPointOfASurface) {
    const auto points = [](float angle) {
        FilmStage stage(
            lit_film([&](SceneBuilder& b, int) {
                b.add_camera(plain_lens(), {0, 0, 0}, {0, 0, -1});
                b.move_object(0, {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}});
                const int node = b.unfinished().cameras[0].node;
                b.add_track(scene::TrackTarget::translation, node, 3, {0, 1, 2}, {-0.5f, 0, 0, 0, 0, 0, 0.5f, 0, 0});
                b.film().shutter.angle = angle;
            }),
            exposed_frame());
        expose_frame(stage, 16, 1, core::ToleranceMap::uniform(size, size, {0.001f, 0.02f}));
        return static_cast<double>(stage.statistics().gather_points);
    };
    EXPECT_LT(points(180) / points(0), 1.3);
}

TEST(Expose, FarOutOfFocusAndFastThingsStayFinite) {
    for (const float focus : {1e-3f, 1.0f, 1e8f}) {
        FilmStage stage(lit_film([&](SceneBuilder& b, int box) {
                            scene::CameraLens lens = plain_lens();
                            lens.f_stop = 0.5f;
                            lens.focus_distance = focus;
                            b.add_camera(lens, {0, 0, 0}, {0, 0, -1});
                            // Through the eye, at the size of nothing once.
                            b.move_object(box, {{0, 0, -900}, {0, 0, 2}, {0, 0, 900}});
                            const int node = b.unfinished().objects[static_cast<std::size_t>(box)].node;
                            b.add_track(scene::TrackTarget::scale, node, 3, {0.75f, 1, 2}, {0, 0, 0, 1, 1, 1, 1, 1, 1});
                            b.film().shutter.angle = 180;
                        }),
                        exposed_frame());
        expose_frame(stage, 16);
        EXPECT_EQ(stage.statistics().non_finite, 0u) << focus;
    }
}

TEST(ExposurePattern, PartsTimeEvenly) {
    for (const int samples : {1, 4, 8, 32}) {
        const ExposurePattern pattern(samples);
        std::vector<int> hits(static_cast<std::size_t>(samples * dither_classes), 0);
        for (int y = 0; y < dither_side; ++y)
            for (int x = 0; x < dither_side; ++x)
                for (int s = 0; s < samples; ++s)
                    ++hits[static_cast<std::size_t>(pattern.time(s, dither_class(x, y)) *
                                                    static_cast<float>(samples * dither_classes))];
        for (const int h : hits) EXPECT_EQ(h, 1) << samples;
    }
}

TEST(ExposurePattern, FillsTheAperture) {
    scene::CameraLens lens;
    for (const int blades : {0, 3, 6}) {
        lens.blades = blades;
        const ExposurePattern pattern(256);
        glm::dvec2 mean(0);
        double second = 0;
        for (int s = 0; s < 256; ++s) {
            const glm::vec2 p = pattern.lens(s, s % dither_classes, lens);
            EXPECT_LE(glm::length(p), 1.0f + 1e-6f);
            mean += glm::dvec2(p) / 256.0;
            second += static_cast<double>(glm::dot(p, p)) / 256;
        }
        EXPECT_LT(glm::length(mean), 0.04) << blades;
        // Of the disc 1/2; of a polygon (2 + cos(2 pi / n)) / 6.
        const double expected = blades == 0 ? 0.5 : (2 + std::cos(2 * std::numbers::pi / blades)) / 6;
        EXPECT_NEAR(second, expected, 0.02) << blades;
    }
}

}  // namespace
}  // namespace render2mpeg::renderer
