#include "perceptual/metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "core/error.h"
#include "core/sampling.h"

namespace render2mpeg::perceptual {
namespace {

using Plane = core::Plane<std::uint8_t>;

Plane plane(int width, int height, const std::function<int(int, int)>& value) {
    Plane p(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) p.at(x, y) = static_cast<std::uint8_t>(value(x, y));
    return p;
}

/// Integers in [-strength, strength], the same for the same pixel.
int noise(int x, int y, int strength) {
    const float u = core::uniform(5, static_cast<std::uint64_t>(1000 * y + x));
    return static_cast<int>(std::floor(u * static_cast<float>(2 * strength + 1))) - strength;
}

TEST(PsnrHvsM, AgreesWithTheAuthorsFormulasInDoublePrecision) {
    // Computed apart from this program, in double precision, with weights 25.735 / step and masking (10 / step)^2 from
    // JPEG's table [T81, K.1], of which the tables printed with the metric are roundings.
    const auto original = [](int x, int y) { return (3 * x * x + 7 * x * y + 5 * y) % 61 + x + 2 * y + 30; };
    const auto changed = [&](int x, int y) { return original(x, y) + (5 * x + 3 * y) % 23 - 11; };
    // 37 x 30: what is left over of whole blocks does not count.
    const Plane a = plane(37, 30, original), b = plane(37, 30, changed);
    EXPECT_NEAR(psnr(masked_error(a, b)), 37.659397, 1e-4);
}

TEST(PsnrHvsM, EqualPlanesHaveNoError) {
    const Plane a = plane(40, 24, [](int x, int y) { return 100 + noise(x, y, 60); });
    EXPECT_EQ(masked_error(a, a), 0.0);
    EXPECT_EQ(psnr(masked_error(a, a)), std::numeric_limits<double>::infinity());
    EXPECT_EQ(masked_error({}, {}), 0.0);
}

TEST(PsnrHvsM, IsSymmetric) {
    const Plane a = plane(64, 48, [](int x, int y) { return 100 + noise(x, y, 30); });
    const Plane b = plane(64, 48, [](int x, int y) { return 100 + noise(y, x, 30); });
    EXPECT_EQ(masked_error(a, b), masked_error(b, a));
    EXPECT_GT(masked_error(a, b), 0.0);
}

TEST(PsnrHvsM, NoiseInTextureIsSeenLessThanOnAFlatPlane) {
    // The same noise to the value; only what it lies on differs.
    const auto with_noise = [](const Plane& p) {
        return plane(p.width(), p.height(), [&](int x, int y) { return p.at(x, y) + noise(x + 500, y, 6); });
    };
    const Plane flat = plane(64, 64, [](int, int) { return 120; });
    const Plane texture = plane(64, 64, [](int x, int y) { return 120 + noise(x, y, 60); });
    const double on_flat = psnr(masked_error(flat, with_noise(flat)));
    const double on_texture = psnr(masked_error(texture, with_noise(texture)));
    EXPECT_GT(on_texture, on_flat + 3.0);
}

TEST(PsnrHvsM, AnEdgeHidesLessThanTextureOfItsEnergy) {
    // Steps in the middle of blocks: the quarters of a block are flat, so that nothing is masked.
    const Plane edge = plane(64, 64, [](int x, int) { return x % 8 < 4 ? 80 : 160; });
    const Plane noisy = plane(64, 64, [&](int x, int y) { return edge.at(x, y) + noise(x, y, 6); });
    const Plane texture = plane(64, 64, [](int x, int y) { return (x / 2 + y / 2) % 2 == 0 ? 80 : 160; });
    const Plane noisy_texture = plane(64, 64, [&](int x, int y) { return texture.at(x, y) + noise(x, y, 6); });
    EXPECT_GT(masked_error(edge, noisy), 2.0 * masked_error(texture, noisy_texture));
}

TEST(PsnrHvsM, LowFrequenciesWeighMoreThanHighOnes) {
    const Plane flat = plane(64, 64, [](int, int) { return 120; });
    const Plane shifted = plane(64, 64, [](int, int) { return 124; });
    const Plane checked = plane(64, 64, [](int x, int y) { return (x + y) % 2 == 0 ? 116 : 124; });
    EXPECT_EQ(mean_squared_error(flat, shifted), mean_squared_error(flat, checked));
    // Of a shift all is in the mean, which nothing masks: its weight is 25.735 / 16.
    EXPECT_NEAR(masked_error(flat, shifted), 16.0 * 1.608443 * 1.608443, 1e-3);
    EXPECT_LT(masked_error(flat, checked), 0.1 * masked_error(flat, shifted));
}

TEST(PsnrHvsM, SmallPlanesCountAndSizesMustAgree) {
    const Plane a(1, 1, 100), b(1, 1, 104);
    EXPECT_NEAR(masked_error(a, b), 16.0 * 1.608443 * 1.608443, 1e-3);
    EXPECT_THROW(masked_error(a, Plane(2, 1)), core::ContractViolation);
}

}  // namespace
}  // namespace render2mpeg::perceptual
