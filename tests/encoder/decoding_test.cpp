#include <gtest/gtest.h>

#include "film.h"

namespace render2mpeg::encoder::testing {
namespace {

/// A texture that slides by `step` pixels per picture.
Film sliding(const Settings& s, int count, glm::dvec2 step, const Motion& motion) {
    return encode(
        s, count,
        [&](std::int64_t n) {
            return paint(s.width, s.height, n, [&](int plane, double x, double y) {
                return texture(plane, x - step.x * static_cast<double>(n), y - step.y * static_cast<double>(n));
            });
        },
        motion);
}
Film sliding_with_exact_motion(const Settings& s, int count, glm::dvec2 step) {
    return sliding(s, count, step, [&](const PicturePlan& plan) {
        return std::vector{uniform_motion(s.width, s.height, plan.number, -glm::vec2(step))};
    });
}

TEST(Decoding, GradientsAreDecodedAsReconstructed) {
    for (const int quantiser : {1, 4, 12, 31}) {
        const Settings s = settings(176, 144, quantiser, 4);
        const Film film = encode(s, 6, [&](std::int64_t n) {
            return paint(s.width, s.height, n, [n](int plane, double x, double y) {
                return plane == 0 ? 16 + x * 0.9 + y * 0.4 + static_cast<double>(n)
                                  : 128 + 0.3 * (x - y) * (plane == 1 ? 1 : -1);
            });
        });
        const Difference d = expect_decoders_agree(film, 0.5);
        RecordProperty("libmpeg2_mean_q" + std::to_string(quantiser), std::to_string(d.mean));
        std::printf("q %d: libmpeg2 max %d mean %g\n", quantiser, d.largest, d.mean);
    }
}

TEST(Decoding, NoiseIsDecodedAsReconstructedAtBothEndsOfTheQuantiser) {
    for (const int quantiser : {1, 31}) {
        const Settings s = settings(96, 80, quantiser, 3);
        const Film film =
            encode(s, 6, [&](std::int64_t n) { return noise(s.width, s.height, n, static_cast<std::uint64_t>(n)); });
        const Difference d = expect_decoders_agree(film, 0.5);
        std::printf("q %d: libmpeg2 max %d mean %g\n", quantiser, d.largest, d.mean);
    }
}

TEST(Decoding, MovingTexturesAreDecodedAsReconstructed) {
    const Difference d =
        expect_decoders_agree(sliding_with_exact_motion(settings(720, 576, 3, 15), 16, {3.5, -2.25}), 0.5);
    std::printf("libmpeg2 max %d mean %g\n", d.largest, d.mean);
}

}  // namespace
}  // namespace render2mpeg::encoder::testing
