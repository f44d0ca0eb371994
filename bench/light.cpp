// Speed of the light's inner loops: building trees, bounding and evaluating clusters, and whole cuts. Run with
// --benchmark_filter.
#include <benchmark/benchmark.h>

#include <cmath>

#include "core/sampling.h"
#include "parallel/loops.h"
#include "renderer/cut/gatherer.h"
#include "renderer/lights/virtual_lights.h"
#include "tests/renderer/film_stage.h"
#include "tests/renderer/lighting.h"

namespace render2mpeg::renderer {
namespace {

/// VPLs on the walls of a room.
std::vector<LightPoint> room_lights(std::int64_t count) {
    std::vector<LightPoint> lights(static_cast<std::size_t>(count));
    const glm::vec3 size{3, 1, 2};
    for (std::uint64_t i = 0; i < lights.size(); ++i) {
        LightPoint& p = lights[i];
        const int wall = static_cast<int>(i % 6);
        p.position = size * glm::vec3(core::uniform(5, i, 0), core::uniform(5, i, 1), core::uniform(5, i, 2));
        p.position[wall % 3] = wall < 3 ? 0.0f : size[wall % 3];
        p.normal = glm::vec3(0);
        p.normal[wall % 3] = wall < 3 ? 1.0f : -1.0f;
        p.intensity = glm::vec3(0.5f + core::uniform(5, i, 3));
        p.disc2 = 1e-3f;
        p.id = static_cast<std::uint32_t>(i);
    }
    return lights;
}

std::vector<GatherPoint> sixteen_points(bool glossy) {
    std::vector<GatherPoint> points(lane_count);
    for (std::uint64_t i = 0; i < points.size(); ++i) {
        SurfacePoint& p = points[i].point;
        p.position = {1.4f + 0.01f * static_cast<float>(i % 4), 0.0f, 1.0f + 0.01f * static_cast<float>(i / 4)};
        p.geometric_normal = p.shading_normal = {0, 1, 0};
        p.outgoing = {0.6f, 0.8f, 0};
        p.bsdf.diffuse = glm::vec3(0.5f);
        if (glossy) p.bsdf.f0 = glm::vec3(0.04f);
        p.bsdf.alpha = 0.3f;
    }
    return points;
}

void fill_from(const std::vector<GatherPoint>& points, GatherLanes& lanes) {
    const GatherPoint* pointers[lane_count];
    for (std::size_t i = 0; i < points.size(); ++i) pointers[i] = &points[i];
    fill(lanes, pointers);
}

void BuildTree(benchmark::State& state) {
    const parallel::ThreadLimit limit(1);
    const auto lights = room_lights(state.range(0));
    for (auto _ : state) benchmark::DoNotOptimize(build_light_tree(LightType::oriented, lights, 1));
    state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(BuildTree)->Arg(1000)->Arg(10000)->Arg(100000)->Arg(1000000)->Unit(benchmark::kMillisecond);

void Spread(benchmark::State& state) {
    const parallel::ThreadLimit limit(1);
    auto lights = room_lights(state.range(0));
    for (auto _ : state) spread(lights, 1.0f);
    state.SetItemsProcessed(state.iterations() * state.range(0));
}
BENCHMARK(Spread)->Arg(10000)->Arg(100000)->Unit(benchmark::kMillisecond);

/// One light or node against sixteen points; items are points.
void EvaluateLight(benchmark::State& state) {
    GatherLanes lanes;
    fill_from(sixteen_points(state.range(0) != 0), lanes);
    const LightTree tree = build_light_tree(LightType::oriented, room_lights(1024), 1);
    LightLanes out;
    std::size_t i = 0;
    for (auto _ : state) {
        evaluate_light(lanes, LightType::oriented, tree.lights[i++ % 1024], nullptr, GeometryClamp{}, out);
        benchmark::DoNotOptimize(out);
    }
    state.SetItemsProcessed(state.iterations() * lane_count);
}
BENCHMARK(EvaluateLight)->ArgName("glossy")->Arg(0)->Arg(1);

void BoundNode(benchmark::State& state) {
    GatherLanes lanes;
    fill_from(sixteen_points(state.range(0) != 0), lanes);
    const LightTree tree = build_light_tree(LightType::oriented, room_lights(1024), 1);
    Lanes out;
    std::uint32_t i = 0;
    for (auto _ : state) {
        bound_node(lanes, tree, i++ % 1023, GeometryClamp{}, out);
        benchmark::DoNotOptimize(out);
    }
    state.SetItemsProcessed(state.iterations() * lane_count);
}
BENCHMARK(BoundNode)->ArgName("glossy")->Arg(0)->Arg(1);

/// Whole frames of a furnished room at 128x128 with this many VPLs; items are clusters.
void Shade(benchmark::State& state) {
    const parallel::ThreadLimit limit(1);
    Settings settings = test::small_frame(128, 128);
    settings.vpls = static_cast<int>(state.range(0));
    settings.direct_points = 512;
    test::FilmStage stage(test::furnished_room(), settings);
    const scene::Snapshot world = stage.at(0);
    const Frame seen = stage.renderer().look(world);
    const auto tolerance = core::ToleranceMap::uniform(128, 128, {0, static_cast<float>(state.range(1)) * 0.01f});
    for (auto _ : state) benchmark::DoNotOptimize(stage.renderer().light(world, seen, {tolerance}).radiance);
    const Statistics& s = stage.statistics();
    const auto points = static_cast<double>(s.gather_points);
    state.SetItemsProcessed(static_cast<std::int64_t>(s.direct_clusters + s.indirect_clusters));
    state.counters["cut"] = static_cast<double>(s.direct_clusters + s.indirect_clusters) / points;
    state.counters["shadow_rays"] = static_cast<double>(s.shadow_rays) / points;
    state.counters["capped"] = static_cast<double>(s.capped_points) / points;
}
BENCHMARK(Shade)
    ->ArgNames({"vpls", "percent"})
    ->Args({1000, 2})
    ->Args({10000, 2})
    ->Args({100000, 2})
    ->Args({10000, 8})
    ->Args({10000, 26})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace render2mpeg::renderer

BENCHMARK_MAIN();
