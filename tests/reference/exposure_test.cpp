// Frames that shutter and lens blur, against paths that choose time, place on the lens and place in the pixel by
// chance. The reference knows nothing of sweeps: it poses the film anew at every time.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "core/isa.h"
#include "core/sampling.h"
#include "renderer/renderer.h"
#include "scene/pose/sweep.h"
#include "scene/preparation/traits.h"
#include "tests/reference/path_tracer.h"
#include "tests/support/scene_builder.h"

namespace render2mpeg::reference {
namespace {

using test::SceneBuilder;

constexpr int frame_side = 32;
constexpr scene::PictureFormat exposed_format{frame_side, frame_side, 1.0f};

/// Direct light of pixels while the shutter is open. Strata of time are the only thing that is not left to chance.
std::vector<Estimate> exposed_light(const scene::Animation& film, int times, const std::vector<glm::ivec2>& pixels) {
    const scene::ShutterInterval shutter = scene::interval_of(film.shutter, 1.0);
    std::vector<glm::dvec3> sum(pixels.size()), squares(pixels.size());
    const renderer::Plan plan = renderer::make_plan(scene::traits_of(film), {});
    renderer::PosedScene posed(film, core::detect_isa(), plan);
    for (int t = 0; t < times; ++t) {
        const auto seed = static_cast<std::uint64_t>(t);
        const double share = (t + core::uniform(1, seed)) / times;
        const double seconds = 1 + shutter.opens + share * (shutter.closes - shutter.opens);
        const scene::Snapshot world =
            scene::snapshot_at(film, 1, {std::llround(seconds * 1e6), 1000000}, exposed_format);
        posed.pose(world);
        const PathTracer tracer(posed);
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            const auto chance = [&](std::uint64_t k) {
                return static_cast<float>(core::uniform(7 + k, (static_cast<std::uint64_t>(i) << 20) + seed));
            };
            const glm::vec2 place{static_cast<float>(pixels[i].x) + chance(0),
                                  static_cast<float>(pixels[i].y) + chance(1)};
            const float radius = std::sqrt(chance(2)), angle = 2 * std::numbers::pi_v<float> * chance(3);
            const scene::Ray ray =
                world.camera.ray_through(place, {radius * std::cos(angle), radius * std::sin(angle)});
            PathSettings settings;
            settings.bounces = 0;
            settings.finding = Finding::by_connection;
            const glm::dvec3 light = tracer.radiance(ray.origin, ray.direction, settings, 1, seed * 7919 + i).mean;
            sum[i] += light;
            squares[i] += light * light;
        }
    }
    std::vector<Estimate> estimates;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const glm::dvec3 mean = sum[i] / static_cast<double>(times);
        const glm::dvec3 variance = glm::max(squares[i] / static_cast<double>(times) - mean * mean, glm::dvec3(0));
        estimates.push_back({mean, glm::sqrt(variance / static_cast<double>(times))});
    }
    return estimates;
}

/// As films are exposed: edges of the sharp middle have been looked at closely, so that its shadows have as many
/// places.
core::Radiance rendered(const scene::Animation& film, int samples) {
    renderer::Settings settings;
    settings.format = exposed_format;
    settings.samples = 16;
    settings.most_samples = 256;
    settings.vpls = 0;
    settings.isa = core::detect_isa();
    renderer::Wanted wanted;
    wanted.indirect = false;
    renderer::Renderer renderer(film, settings, renderer::make_plan(scene::traits_of(film), wanted));
    const scene::Snapshot world =
        scene::snapshot_at(film, 1, {1, 1}, exposed_format, scene::interval_of(film.shutter, 1.0));
    renderer::Frame seen = renderer.look(world);
    const core::Radiance rough = renderer.light(world, seen, {core::ToleranceMap::reference()}).radiance;
    core::ToleranceMap fine = core::ToleranceMap::uniform(frame_side, frame_side, {1e-4f, 0.0f});
    for (std::size_t i = 0; i < fine.pixels.size(); ++i)
        fine.pixels.values()[i].background = std::max(rough.combined.values()[i].y, 1e-3f);
    const renderer::ExposureSamples exposure{samples, samples};
    renderer::PlacedFrame placed =
        renderer.place(world, std::move(seen), {fine, renderer::LightingMode::film, exposure});
    return renderer.gather(world, std::move(placed), {core::ToleranceMap::reference()}).radiance;
}

/// Of 200 pixels, within four standard errors and `allowed`; `exceptions` of them in `more`. Allowed is what
/// light with the resolution of a pixel of the middle takes: the edge of a shadow is wider by a pixel.
void expect_truth(const SceneBuilder& scene, double allowed, int exceptions = 0, double more = 0) {
    const scene::Animation film = scene.build();
    const core::Radiance frame = rendered(film, 256);
    std::vector<glm::ivec2> pixels;
    for (int k = 0; k < 200; ++k)
        pixels.emplace_back(static_cast<int>(core::uniform(3, static_cast<std::uint64_t>(k)) * frame_side),
                            static_cast<int>(core::uniform(4, static_cast<std::uint64_t>(k)) * frame_side));
    const std::vector<Estimate> truth = exposed_light(film, 4096, pixels);
    double bias = 0;
    int beyond = 0;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        bool is_beyond = false;
        for (int c = 0; c < 3; ++c) {
            const double shown = static_cast<double>(frame.combined.at(pixels[i].x, pixels[i].y)[c]);
            const double off = std::abs(shown - truth[i].mean[c]), noise = 4 * truth[i].error[c];
            EXPECT_LE(off, noise + std::max(allowed, more))
                << pixels[i].x << ", " << pixels[i].y << " channel " << c << ": " << shown;
            is_beyond = is_beyond || off > noise + allowed;
            bias += (shown - truth[i].mean[c]) / 600;
        }
        beyond += is_beyond ? 1 : 0;
    }
    EXPECT_LE(beyond, exceptions);
    EXPECT_LT(std::abs(bias), 0.001);
}

/// A floor and a wall under a lamp and a sun, a box and a ball.
SceneBuilder room(int& box, int& ball) {
    SceneBuilder b;
    b.add_quad({-6, -1, 4}, {12, 0, 0}, {0, 0, -12}, b.add_material({0.6f, 0.6f, 0.5f}));
    b.add_quad({-6, -1, -6}, {12, 0, 0}, {0, 8, 0}, b.add_material({0.3f, 0.5f, 0.7f}));
    box = b.add_box({-1.3f, -1, -3.2f}, {-0.5f, 0.2f, -2.4f}, b.add_material({0.7f, 0.2f, 0.1f}));
    ball = b.add_sphere({0.6f, -0.4f, -2.2f}, 0.6f, b.add_material({0.2f, 0.6f, 0.3f}), 32);
    b.add_sun({-0.4f, -1, -0.5f}, 2);
    return b;
}

scene::CameraLens plain_lens() {
    scene::CameraLens lens;
    lens.vertical_fov = 0.9f;
    return lens;
}

// Light of the floor and the wall is 0.2 to 0.4.
TEST(ExposureTruthSlow, CameraThatMovesAndTurns) {
    int box = 0, ball = 0;
    SceneBuilder b = room(box, ball);
    b.add_camera(plain_lens(), {0, 0.3f, 1.5f}, {0, -0.3f, -2});
    const int node = b.unfinished().cameras[0].node;
    b.add_track(scene::TrackTarget::translation, node, 3, {0, 1, 2},
                {-0.8f, 0.3f, 1.7f, 0, 0.3f, 1.5f, 0.8f, 0.4f, 1.3f});
    b.film().shutter.angle = 180;
    expect_truth(b, 0.02);
}

TEST(ExposureTruthSlow, LensOutOfFocus) {
    int box = 0, ball = 0;
    SceneBuilder b = room(box, ball);
    scene::CameraLens lens = plain_lens();
    lens.f_stop = 1.4f;
    lens.sensor_height = 0.35f;
    lens.focus_distance = 3.6f;
    b.add_camera(lens, {0, 0.3f, 1.5f}, {0, -0.3f, -2});
    expect_truth(b, 0.006);
}

// Where the box stands, what it uncovers is lit while it is seen; the mean over the shutter is darker.
TEST(ExposureTruthSlow, ThingsThatMoveAndTheirShadows) {
    int box = 0, ball = 0;
    SceneBuilder b = room(box, ball);
    b.add_camera(plain_lens(), {0, 0.3f, 1.5f}, {0, -0.3f, -2});
    b.move_object(box, {{-1.2f, 0, 0}, {0, 0, 0}, {1.2f, 0, 0}});
    b.film().shutter.angle = 180;
    expect_truth(b, 0.006, 2, 0.08);
}

}  // namespace
}  // namespace render2mpeg::reference
