// How pictures' bits fall with the quantiser (docs/measurements.md#rates), and how near films come to the rate they are
// asked for, in one pass and in two.
//
//   bench_encoder_rates [width height count]

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "encoder/bit_allocation.h"
#include "encoder/encoder.h"
#include "encoder_clip.h"

namespace render2mpeg::bench {
namespace {

encoder::Settings settings_for(const Clip& clip) {
    encoder::Settings s;
    s.width = clip.pictures[0].width();
    s.height = clip.pictures[0].height();
    s.rate = core::frame_rate_from("30");
    return s;
}

struct Coded {
    encoder::PictureType type;
    int quantiser;
    double bits;
};

/// Codes the clip in chunks of 60, each by an encoder of its own.
std::vector<Coded> code(const Clip& clip, const encoder::Settings& s,
                        std::vector<encoder::FirstPassPicture>* pass = nullptr,
                        const std::vector<encoder::BitAllocation>* allocated = nullptr) {
    std::vector<Coded> all;
    const auto count = static_cast<std::int64_t>(clip.pictures.size());
    for (std::int64_t first = 0; first < count; first += 60) {
        const std::int64_t end = std::min(first + 60, count);
        encoder::Encoder encoder(s);
        const auto take = [&](const std::vector<encoder::CodedPicture>& pictures) {
            for (const encoder::CodedPicture& c : pictures) {
                all.push_back({c.plan.type, c.quantiser, 8.0 * static_cast<double>(c.bytes.size())});
                if (pass) pass->push_back(encoder::first_pass_picture(s, c, c.plan.number == first));
            }
        };
        for (std::int64_t n = first; n < end; ++n) {
            encoder::PictureFacts facts;
            facts.frames_left = facts.left_in_chunk.emplace(end - 1 - n);
            facts.last_chunk = end == count;
            if (allocated) facts.allocation = (*allocated)[static_cast<std::size_t>(n)];
            const encoder::PicturePlan plan = encoder.plan(n, facts, n == first);
            std::vector<core::MotionField> motion;
            for (const std::int64_t reference : plan.references) motion.push_back(clip.motion(n, reference));
            take(encoder.push(clip.pictures[static_cast<std::size_t>(n)], plan, motion));
        }
        take(encoder.flush());
    }
    return all;
}

/// Least squares of log bits over log quantiser, by type; bits per sample at quantiser 1.
void print_slopes(const Clip& clip) {
    const encoder::Settings base = settings_for(clip);
    double n[3] = {}, x[3] = {}, y[3] = {}, xx[3] = {}, xy[3] = {};
    for (const int q : {2, 4, 8, 16, 24}) {
        encoder::Settings s = base;
        s.quantiser = q;
        double sum[3] = {}, logs[3] = {}, count[3] = {};
        for (const Coded& c : code(clip, s)) {
            const auto t = static_cast<std::size_t>(c.type) - 1;
            sum[t] += c.bits, count[t] += 1, logs[t] = std::log(c.quantiser);
        }
        for (std::size_t t = 0; t < 3; ++t) {
            const double bits = std::log(sum[t] / count[t]);
            n[t] += 1, x[t] += logs[t], y[t] += bits, xx[t] += logs[t] * logs[t], xy[t] += logs[t] * bits;
        }
    }
    for (std::size_t t = 0; t < 3; ++t) {
        const double slope = (n[t] * xy[t] - x[t] * y[t]) / (n[t] * xx[t] - x[t] * x[t]);
        const double at_one = std::exp((y[t] - slope * x[t]) / n[t]) / (base.width * base.height);
        std::printf("%c: slope %.2f, %.3f bits per sample at quantiser 1\n", "IPB"[t], -slope, at_one);
    }
}

void print_errors(const Clip& clip, double bits_per_sample) {
    encoder::Settings s = settings_for(clip);
    const double hertz = s.rate.hertz.value();
    s.rate_control.bit_rate = static_cast<std::int64_t>(bits_per_sample * s.width * s.height * hertz);
    const double seconds = static_cast<double>(clip.pictures.size()) / hertz;
    for (const auto mode : {encoder::RateMode::variable, encoder::RateMode::constant}) {
        s.rate_control.mode = mode;
        encoder::Settings first = s;
        first.effort = encoder::Effort::fast;
        std::vector<encoder::FirstPassPicture> pass;
        code(clip, first, &pass);
        const std::vector<encoder::BitAllocation> allocated = encoder::allocate_bits(s, pass, 1.0);
        for (const int passes : {1, 2}) {
            double bits = 0, quantisers = 0, squares = 0;
            const std::vector<Coded> coded = code(clip, s, nullptr, passes == 2 ? &allocated : nullptr);
            for (const Coded& c : coded) {
                bits += c.bits, quantisers += c.quantiser;
                squares += static_cast<double>(c.quantiser) * c.quantiser;
            }
            const double mean = quantisers / static_cast<double>(coded.size());
            std::printf("%s, %d pass: %.3f bits per sample wanted, error %+.2f %%, quantiser %.1f +- %.1f\n",
                        mode == encoder::RateMode::variable ? "variable" : "constant", passes, bits_per_sample,
                        100 * (bits / seconds / static_cast<double>(s.rate_control.bit_rate) - 1), mean,
                        std::sqrt(std::max(0.0, squares / static_cast<double>(coded.size()) - mean * mean)));
        }
    }
}

}  // namespace
}  // namespace render2mpeg::bench

int main(int argc, char** argv) {
    using namespace render2mpeg::bench;
    std::setvbuf(stdout, nullptr, _IOLBF, 0);
    const int width = argc > 3 ? std::atoi(argv[1]) : 480, height = argc > 3 ? std::atoi(argv[2]) : 272,
              count = argc > 3 ? std::atoi(argv[3]) : 120;
    for (const float speed : {1.0f, 3.0f}) {
        const Clip clip(width, height, count, speed);
        std::printf("walk of speed %.0f\n", speed);
        print_slopes(clip);
        for (const double bits : {0.05, 0.1, 0.25, 0.6}) print_errors(clip, bits);
    }
}
