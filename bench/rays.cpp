// How fast rays are traced, scenes are posed and frames are seen, per CPU second of one thread where it is not said
// otherwise.

#include <benchmark/benchmark.h>

#include <limits>
#include <memory>

#include "core/isa.h"
#include "core/sampling.h"
#include "parallel/loops.h"
#include "renderer/view/see.h"
#include "scene/preparation/traits.h"
#include "tests/support/scene_builder.h"

namespace render2mpeg {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

/// A hall of 480,000 triangles: two rows of turned columns with round capitals on a floor, in a box. `moves`: a sphere
/// in its middle travels; `deforms`: one of 60,000 triangles swells.
test::SceneBuilder hall(bool moves, bool deforms, bool veils) {
    test::SceneBuilder builder;
    const int stone = builder.add_material({0.7f, 0.65f, 0.6f});
    builder.add_box({-10, 0, -40}, {10, 12, 4}, stone, true);
    for (int row = 0; row < 2; ++row) {
        for (int i = 0; i < 12; ++i) {
            const glm::vec3 foot{row == 0 ? -5.0f : 5.0f, 0, -3.0f * static_cast<float>(i)};
            builder.add_box(foot - glm::vec3{0.4f, 0, 0.4f}, foot + glm::vec3{0.4f, 8, 0.4f}, stone);
            builder.add_sphere(foot + glm::vec3{0, 8.5f, 0}, 0.9f, stone, 70);
        }
    }
    const int ball = builder.add_sphere({0, 1.5f, -10}, 1.5f, stone, 60);
    if (moves) builder.move_object(ball, {{0, 1.5f, -10}, {1, 1.5f, -12}});
    if (deforms) {
        scene::Mesh mesh = test::SceneBuilder::sphere(1.0f, 123);
        mesh.morph_targets.push_back({mesh.normals, {}});
        const int object = builder.add_object(builder.add_mesh(mesh), stone, {0, 4, -14});
        scene::Track track;
        track.target = scene::TrackTarget::weights;
        track.index = builder.film().objects[static_cast<std::size_t>(object)].node;
        track.width = 1;
        track.times = {0, 1};
        track.values = {0, 1};
        builder.film().tracks.push_back(track);
    }
    if (veils) {
        const int veil = builder.add_material();
        builder.material(veil).alpha_mode = scene::AlphaMode::blend;
        builder.material(veil).base_color.a = 0.2f;
        for (int i = 0; i < 6; ++i)
            builder.add_quad({-9, 0, -4.0f - 5.0f * static_cast<float>(i)}, {18, 0, 0}, {0, 6, 0}, veil);
    }
    builder.add_camera({0, 2, 2}, {0, 3, -20}, 1.0f);
    return builder;
}

struct Stage {
    explicit Stage(bool moves = false, bool deforms = false, bool veils = false)
        : film(hall(moves, deforms, veils).build()),
          plan(renderer::make_plan(scene::traits_of(film), {})),
          posed_scene(film, core::detect_isa(), plan) {
        for (int second = 0; second < 2; ++second) worlds.push_back(test::snapshot(film, second, 512, 512));
        posed_scene.pose(worlds[0]);
    }
    scene::Animation film;
    renderer::Plan plan;
    renderer::PosedScene posed_scene;
    std::vector<scene::Snapshot> worlds;
};

/// The points that a 512 x 512 picture sees, every fourth in both directions, tile by tile.
std::vector<renderer::SurfacePoint> seen_points(const Stage& stage) {
    std::vector<renderer::SurfacePoint> points;
    for (int tile = 0; tile < 32 * 32; ++tile) {
        for (int i = 0; i < 16; ++i) {
            const glm::vec2 at{static_cast<float>(tile % 32 * 16 + i % 4), static_cast<float>(tile / 32 * 16 + i / 4)};
            const scene::Ray ray = stage.worlds[0].camera.ray_through(at + 0.5f);
            const renderer::Hit hit = stage.posed_scene.tracer().nearest(ray.origin, ray.direction, infinity);
            points.push_back(stage.posed_scene.surface_at(hit.address, -ray.direction));
        }
    }
    return points;
}

/// Places as light points would have them: on surfaces, met by rays from the middle.
std::vector<glm::vec3> light_places(const Stage& stage, std::uint64_t count) {
    std::vector<glm::vec3> places;
    for (std::uint64_t i = 1; i <= count; ++i) {
        const glm::vec3 direction = core::sample_sphere({core::halton(0, i), core::halton(1, i)});
        const renderer::Hit hit = stage.posed_scene.tracer().nearest({0, 6, -18}, direction, infinity);
        places.push_back(glm::vec3{0, 6, -18} + 0.999f * hit.distance * direction);
    }
    return places;
}

void count_rays(benchmark::State& state, std::size_t rays) {
    state.counters["rays"] = benchmark::Counter(static_cast<double>(rays), benchmark::Counter::kIsRate);
}

void nearest_from_eye(benchmark::State& state) {
    const Stage stage(state.range(0) != 0);
    std::size_t rays = 0;
    for (auto _ : state) {
        for (int y = 0; y < 128; ++y) {
            for (int x = 0; x < 512; ++x) {
                const scene::Ray ray = stage.worlds[0].camera.ray_through(
                    {static_cast<float>(x) + 0.5f, 4.0f * static_cast<float>(y) + 0.5f});
                benchmark::DoNotOptimize(stage.posed_scene.tracer().nearest(ray.origin, ray.direction, infinity));
                ++rays;
            }
        }
    }
    count_rays(state, rays);
}
BENCHMARK(nearest_from_eye)->ArgName("moves")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

void nearest_after_bounce(benchmark::State& state) {
    const Stage stage;
    const auto points = seen_points(stage);
    std::size_t rays = 0;
    for (auto _ : state) {
        for (std::size_t i = 0; i < points.size(); ++i) {
            const glm::vec2 u{core::uniform(1, i, 0), core::uniform(1, i, 1)};
            const glm::vec3 d = core::sample_cosine_hemisphere(points[i].geometric_normal, u);
            benchmark::DoNotOptimize(stage.posed_scene.tracer().nearest(offset_origin(points[i], d), d, infinity));
            ++rays;
        }
    }
    count_rays(state, rays);
}
BENCHMARK(nearest_after_bounce)->Unit(benchmark::kMillisecond);

/// Shadow rays of 4 x 4 pixels towards one light point: by packets or one by one, in a scene with or without layers.
template <bool packets>
void shadow_rays(benchmark::State& state) {
    const Stage stage(false, false, state.range(0) != 0);
    const auto points = seen_points(stage);
    const auto lights = light_places(stage, 16);
    std::size_t rays = 0;
    for (auto _ : state) {
        for (std::size_t first = 0; first < points.size(); first += 16) {
            for (const glm::vec3& light : lights) {
                renderer::ShadowPacket packet;
                glm::vec3 through[16];
                for (std::size_t i = 0; i < 16; ++i) {
                    const renderer::SurfacePoint& p = points[first + i];
                    const glm::vec3 origin = offset_origin(p, light - p.position), d = light - origin;
                    packet.origin_x[i] = origin.x, packet.origin_y[i] = origin.y, packet.origin_z[i] = origin.z;
                    packet.direction_x[i] = d.x, packet.direction_y[i] = d.y, packet.direction_z[i] = d.z;
                    packet.far[i] = 1.0f;
                    through[i] = glm::vec3{1.0f};
                    if (!packets) benchmark::DoNotOptimize(stage.posed_scene.tracer().passes(origin, d, 1.0f));
                }
                packet.active = 0xffff;
                if (packets) benchmark::DoNotOptimize(stage.posed_scene.tracer().occluded(packet, through));
                rays += 16;
            }
        }
    }
    count_rays(state, rays);
}
BENCHMARK(shadow_rays<true>)->ArgName("veils")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);
BENCHMARK(shadow_rays<false>)->ArgName("veils")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

/// Posing to and fro: nothing moves, a sphere moves as a whole, one of 60,000 triangles deforms.
void pose(benchmark::State& state) {
    Stage stage(state.range(0) == 1, state.range(0) == 2);
    std::size_t frame = 0;
    for (auto _ : state) stage.posed_scene.pose(stage.worlds[++frame % 2]);
}
BENCHMARK(pose)->ArgName("what")->Arg(0)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

void build(benchmark::State& state) {
    const Stage stage;
    for (auto _ : state) {
        renderer::PosedScene posed_scene(stage.film, core::detect_isa(), stage.plan);
        posed_scene.pose(stage.worlds[0]);
        benchmark::DoNotOptimize(posed_scene.tracer());
    }
}
BENCHMARK(build)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

/// A whole frame of 512 x 512, all threads; the time is of all of them.
void see(benchmark::State& state) {
    const Stage stage(false, false, state.range(1) != 0);
    renderer::SeeCounts counts;
    renderer::SeeSettings settings;
    settings.format = {512, 512, 1.0f};
    settings.samples = static_cast<int>(state.range(0));
    for (auto _ : state) benchmark::DoNotOptimize(renderer::see(stage.posed_scene, settings, stage.plan, counts));
    count_rays(state, counts.primary_rays);
}
BENCHMARK(see)
    ->ArgNames({"samples", "veils"})
    ->Args({1, 0})
    ->Args({4, 0})
    ->Args({4, 1})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();

}  // namespace
}  // namespace render2mpeg

BENCHMARK_MAIN();
