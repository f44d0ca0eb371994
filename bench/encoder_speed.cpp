// Speed of the encoder's parts and of whole pictures at 1280x720 with exact motion. The counter `pictures` is per CPU
// second.

#include <benchmark/benchmark.h>

#include <array>
#include <cstdint>
#include <span>

#include "core/sampling.h"
#include "encoder/encoder.h"
#include "encoder/mpeg2/kernels/kernels.h"
#include "encoder/mpeg2/kernels/quantiser.h"
#include "encoder_clip.h"
#include "parallel/loops.h"

namespace render2mpeg::bench {
namespace {

namespace mpeg2 = encoder::mpeg2;

constexpr std::ptrdiff_t stride = 32;

struct Patch {
    alignas(32) std::array<std::uint8_t, 32 * 20> bytes;
    explicit Patch(std::uint64_t seed) {
        for (std::size_t i = 0; i < bytes.size(); ++i)
            bytes[i] = static_cast<std::uint8_t>(100 + 60 * core::uniform(seed, i));
    }
    const std::uint8_t* data() const { return bytes.data(); }
};

void ForwardDct(benchmark::State& state) {
    const Patch a(1), b(2);
    alignas(32) float c[64];
    for (auto _ : state) {
        mpeg2::kernels().forward_dct_of_difference(c, a.data(), stride, b.data(), stride);
        benchmark::DoNotOptimize(c);
    }
    state.SetItemsProcessed(state.iterations());
}
BENCHMARK(ForwardDct);

void InverseDct(benchmark::State& state) {
    alignas(32) std::int16_t c[64] = {800, -20, 30, 4, 0, 8, -90};
    alignas(32) std::uint8_t out[64] = {};
    for (auto _ : state) {
        mpeg2::kernels().inverse_dct_add(c, out, 8);
        benchmark::DoNotOptimize(out);
    }
    state.SetItemsProcessed(state.iterations());
}
BENCHMARK(InverseDct);

void Quantise(benchmark::State& state) {
    const Patch a(1);
    alignas(32) float c[64];
    alignas(32) std::int16_t levels[64], back[64];
    mpeg2::kernels().forward_dct(c, a.data(), stride);
    for (auto _ : state) {
        benchmark::DoNotOptimize(mpeg2::kernels().quantise(c, mpeg2::Quantiser::of(4).non_intra, levels, back));
        benchmark::DoNotOptimize(levels);
    }
    state.SetItemsProcessed(state.iterations());
}
BENCHMARK(Quantise);

void HadamardDifference(benchmark::State& state) {
    const Patch a(1), b(2);
    for (auto _ : state) benchmark::DoNotOptimize(mpeg2::kernels().satd_16x16(a.data(), stride, b.data(), stride));
    state.SetItemsProcessed(state.iterations());
}
BENCHMARK(HadamardDifference);

/// Range: quantiser, pictures per GOP, Effort (0 fast, 1 quality).
void EncodePictures(benchmark::State& state) {
    const parallel::ThreadLimit one_thread(1);
    static const Clip clip(1280, 720, 6, 2.0f);
    encoder::Settings settings;
    settings.width = 1280;
    settings.height = 720;
    settings.rate = core::frame_rate_from("30");
    settings.quantiser = static_cast<int>(state.range(0));
    settings.gop = static_cast<int>(state.range(1));
    settings.effort = state.range(2) == 0 ? encoder::Effort::fast : encoder::Effort::quality;
    std::int64_t bits = 0, pictures = 0;
    for (auto _ : state) {
        encoder::Encoder encoder(settings);
        for (std::size_t n = 0; n < clip.pictures.size(); ++n) {
            encoder::PictureFacts facts;
            facts.frames_left = static_cast<std::int64_t>(clip.pictures.size() - 1 - n);
            const encoder::PicturePlan plan = encoder.plan(static_cast<std::int64_t>(n), facts, n == 0);
            state.PauseTiming();
            std::vector<core::MotionField> motion;
            for (const std::int64_t reference : plan.references) motion.push_back(clip.motion(plan.number, reference));
            state.ResumeTiming();
            for (const encoder::CodedPicture& coded : encoder.push(clip.pictures[n], plan, motion)) {
                bits += static_cast<std::int64_t>(coded.bytes.size()) * 8;
                ++pictures;
            }
        }
    }
    state.counters["pictures"] = benchmark::Counter(static_cast<double>(pictures), benchmark::Counter::kIsRate);
    state.counters["bits"] = static_cast<double>(bits) / static_cast<double>(pictures);
}
BENCHMARK(EncodePictures)
    ->Args({2, 1, 1})
    ->Args({2, 15, 1})
    ->Args({4, 15, 1})
    ->Args({8, 15, 1})
    ->Args({4, 15, 0})
    ->Args({8, 15, 0})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace render2mpeg::bench

BENCHMARK_MAIN();
