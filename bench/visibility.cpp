// What the eye costs per frame: masking, judging and tolerating a picture of 512x512 pixels in which everything moves.
#include <benchmark/benchmark.h>

#include <memory>

#include "app/system/memory_limit.h"
#include "core/sampling.h"
#include "perceptual/masking.h"
#include "perceptual/visibility_model.h"
#include "perceptual/warp.h"
#include "tests/perceptual/mpeg2_quantisation.h"

namespace render2mpeg::perceptual {
namespace {

constexpr int size = 512;

core::Radiance light() {
    core::Radiance radiance;
    radiance.combined = core::Plane<glm::vec3>(size, size);
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            const float noise = core::uniform(1, static_cast<std::uint64_t>(y * size + x));
            radiance.combined.at(x, y) =
                glm::vec3(0.9f, 0.7f, 0.5f) * (0.02f + 0.8f * static_cast<float>(x) / size * (0.5f + noise));
        }
    return radiance;
}

/// A slanted floor of 10000 triangles.
std::shared_ptr<const core::Visible> floor_seen() {
    core::Visible visible(0, size, size);
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            visible.kind.at(x, y) = core::PixelClass::surface;
            visible.address.at(x, y) = {0, static_cast<std::uint32_t>(y / 5 * 100 + x / 5), 0.3f, 0.3f};
            visible.material.at(x, y) = 0;
            visible.depth.at(x, y) = 2.0f + 0.01f * static_cast<float>(size - y);
            visible.geometric_normal.at(x, y) = core::PackedNormal(glm::vec3(0, 1, 0));
        }
    return std::make_shared<const core::Visible>(std::move(visible));
}

core::MotionField drift() {
    core::MotionField motion;
    motion.vector = core::Plane<glm::vec2>(size, size, glm::vec2(1.3f, -0.6f));
    motion.depth_in_reference = core::Plane<float>(size, size, 0.0f);
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x)
            motion.depth_in_reference.at(x, y) = 2.0f + 0.01f * (static_cast<float>(size - y) + 0.6f);
    motion.kind = core::Plane<core::PixelClass>(size, size, core::PixelClass::surface);
    return motion;
}

struct Setting {
    Display display{0, ColorMatrix::bt709};
    VisibilityModel model{display};
    core::Radiance radiance = light();
    core::Picture picture = display.develop(radiance);
    std::shared_ptr<const core::Visible> visible = floor_seen();
    core::MotionField motion = drift();
    CodedFacts facts;
    CodingPlan next;

    Setting() {
        facts.plan.intra = false;
        facts.intra = core::Plane<std::uint8_t>(size / 16, size / 16, 0);
        facts.scale = core::Plane<float>(size / 16, size / 16, 1.0f);
        facts.reconstruction = facts.prediction = picture.y;
        next.intra = false;
        facts.plan.quantisation = next.quantisation = default_quantisation();
        next.scale = 1.5f;
    }
};

void Mask(benchmark::State& state) {
    const Setting s;
    for (auto _ : state) benchmark::DoNotOptimize(mask(s.picture));
}
void Observe(benchmark::State& state) {
    const Setting s;
    for (auto _ : state) benchmark::DoNotOptimize(s.model.observe(s.picture, s.radiance, s.visible));
}
void Judge(benchmark::State& state) {
    const Setting s;
    const Observation observation = s.model.observe(s.picture, s.radiance, s.visible);
    for (auto _ : state) {
        state.PauseTiming();
        Observation copy = observation;
        state.ResumeTiming();
        benchmark::DoNotOptimize(s.model.judge(std::move(copy), s.facts));
    }
}
void Tolerate(benchmark::State& state) {
    const Setting s;
    const TemporalState remembered = s.model.judge(s.model.observe(s.picture, s.radiance, s.visible), s.facts);
    for (auto _ : state) benchmark::DoNotOptimize(s.model.tolerate(*s.visible, s.next, remembered, &s.motion, 0.5f));
}
/// Per frame of a film with two B pictures in a row: one of three is masked and judged, and each is lit by what is
/// remembered, requantised once for both B pictures and once for the next P picture.
void Frame(benchmark::State& state) {
    const Setting s;
    CodingPlan bidirectional = s.next;
    bidirectional.scale = 1.75f;
    for (auto _ : state) {
        const TemporalState remembered = s.model.judge(s.model.observe(s.picture, s.radiance, s.visible), s.facts);
        for (const CodingPlan& plan : {bidirectional, s.next}) {
            const Requantised requantised = s.model.requantise(remembered, plan);
            for (int frame = 0; frame < (plan == bidirectional ? 2 : 1); ++frame)
                benchmark::DoNotOptimize(s.model.tolerate(*s.visible, requantised, remembered, &s.motion, 0.5f));
        }
    }
    state.counters["ms_per_frame"] = benchmark::Counter(3e-3 * static_cast<double>(state.iterations()),
                                                        benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
void Warp(benchmark::State& state) {
    const Setting s;
    const core::Plane<float> values(size, size, 1.0f);
    for (auto _ : state) benchmark::DoNotOptimize(warp(values, *s.visible, *s.visible, &s.motion));
}

BENCHMARK(Mask)->Unit(benchmark::kMillisecond);
BENCHMARK(Observe)->Unit(benchmark::kMillisecond);
BENCHMARK(Judge)->Unit(benchmark::kMillisecond);
BENCHMARK(Tolerate)->Unit(benchmark::kMillisecond);
BENCHMARK(Frame)->Unit(benchmark::kMillisecond);
BENCHMARK(Warp)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace render2mpeg::perceptual

int main(int argc, char** argv) {
    render2mpeg::app::keep_freed_memory();  // as the program does
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
    return 0;
}
