#include "encoder/mpeg2/kernels/kernels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "core/dct.h"
#include "core/sampling.h"
#include "encoder/mpeg2/kernels/quantiser.h"

namespace render2mpeg::encoder::mpeg2 {
namespace {

constexpr int stride = 40;

/// A 40-wide patch of noise between `low` and `high`.
std::vector<std::uint8_t> patch(std::uint64_t seed, int low = 0, int high = 255) {
    std::vector<std::uint8_t> bytes(stride * 20);
    for (std::size_t i = 0; i < bytes.size(); ++i)
        bytes[i] = static_cast<std::uint8_t>(
            low + static_cast<int>(core::uniform(seed, i) * static_cast<float>(high - low + 1)));
    return bytes;
}

int hadamard_sum(const std::array<int, 64>& difference) {
    int sum = 0;
    for (int v = 0; v < 8; ++v)
        for (int u = 0; u < 8; ++u) {
            int c = 0;
            for (int i = 0; i < 64; ++i)
                c += difference[static_cast<std::size_t>(i)] * (((std::popcount(static_cast<unsigned>(i / 8 & v)) +
                                                                  std::popcount(static_cast<unsigned>(i % 8 & u))) &
                                                                 1) != 0
                                                                    ? -1
                                                                    : 1);
            sum += std::abs(c);
        }
    return sum;
}

/// Runs the body for every variant this processor has.
template <class Body>
void for_every_variant(const Body& body) {
    const KernelVariants variants = kernel_variants();
    for (int i = 0; i < variants.count; ++i) {
        SCOPED_TRACE("variant " + std::to_string(i));
        body(*variants.variant[i]);
    }
}

TEST(Kernels, HadamardSumsEqualTheDefinition) {
    for (const bool extreme : {false, true}) {
        const auto a = extreme ? patch(1, 255, 255) : patch(1), b = extreme ? patch(2, 0, 0) : patch(2);
        int expected = 0;
        for (int block = 0; block < 4; ++block) {
            std::array<int, 64> d;
            for (int i = 0; i < 64; ++i) {
                const auto at = static_cast<std::size_t>((block / 2 * 8 + i / 8) * stride + block % 2 * 8 + i % 8);
                d[static_cast<std::size_t>(i)] = a[at] - b[at];
            }
            expected += hadamard_sum(d);
        }
        for_every_variant([&](const Kernels& k) {
            EXPECT_EQ(k.satd_16x16(a.data(), stride, b.data(), stride), static_cast<unsigned>(expected));
        });
    }
}

TEST(Kernels, ActivityIsTheHadamardSumWithoutMeans) {
    const auto a = patch(3);
    int expected = 0;
    for (int block = 0; block < 4; ++block) {
        std::array<int, 64> d;
        int sum = 0;
        for (int i = 0; i < 64; ++i) {
            d[static_cast<std::size_t>(i)] =
                a[static_cast<std::size_t>((block / 2 * 8 + i / 8) * stride + block % 2 * 8 + i % 8)];
            sum += d[static_cast<std::size_t>(i)];
        }
        expected += hadamard_sum(d) - sum;
    }
    for_every_variant([&](const Kernels& k) {
        EXPECT_EQ(k.activity_16x16(a.data(), stride), static_cast<unsigned>(expected));
        EXPECT_EQ(k.activity_16x16(patch(3, 200, 200).data(), stride), 0u);
    });
}

TEST(Kernels, SumsOfDifferencesEqualTheDefinition) {
    const auto a = patch(4), b = patch(5);
    unsigned sad = 0, small = 0, large = 0;
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x) {
            const auto at = static_cast<std::size_t>(y * stride + x);
            const int d = a[at] - b[at];
            large += static_cast<unsigned>(d * d);
            sad += static_cast<unsigned>(std::abs(d));
            if (x < 8 && y < 8) small += static_cast<unsigned>(d * d);
        }
    for_every_variant([&](const Kernels& k) {
        EXPECT_EQ(k.sad_16x16(a.data(), stride, b.data(), stride), sad);
        EXPECT_EQ(k.ssd_8x8(a.data(), stride, b.data(), stride), small);
        EXPECT_EQ(k.ssd_16x16(a.data(), stride, b.data(), stride), large);
    });
}

TEST(Kernels, HalfPelPredictionRoundsHalvesUp) {
    const auto r = patch(6);
    for_every_variant([&](const Kernels& k) {
        for (int half = 0; half < 4; ++half) {
            std::uint8_t large[256], small[64];
            k.predict_16x16(large, 16, r.data(), stride, half);
            k.predict_8x8(small, 8, r.data(), stride, half);
            for (int y = 0; y < 16; ++y)
                for (int x = 0; x < 16; ++x) {
                    const auto at = [&](int dx, int dy) {
                        return static_cast<int>(r[static_cast<std::size_t>((y + dy) * stride + x + dx)]);
                    };
                    const int right = half & 1, down = half >> 1, count = (1 + right) * (1 + down);
                    int sum = 0;
                    for (int dy = 0; dy <= down; ++dy)
                        for (int dx = 0; dx <= right; ++dx) sum += at(dx, dy);
                    const int expected = (sum + count / 2) / count;
                    ASSERT_EQ(large[y * 16 + x], expected);
                    if (x < 8 && y < 8) {
                        ASSERT_EQ(small[y * 8 + x], expected);
                    }
                }
        }
    });
}

TEST(Kernels, TheMeanOfTwoPredictionsRoundsUp) {
    for_every_variant([&](const Kernels& k) {
        std::uint8_t a[256], b[256], before[256];
        for (int shift = 0; shift < 256; ++shift) {
            for (int i = 0; i < 256; ++i) {
                a[i] = before[i] = static_cast<std::uint8_t>(i);
                b[i] = static_cast<std::uint8_t>(i + shift);
            }
            k.average(a, b, 224);
            for (int i = 0; i < 256; ++i)
                ASSERT_EQ(a[i], i < 224 ? (before[i] + b[i] + 1) / 2 : before[i]) << i << " " << shift;
        }
    });
}

TEST(Kernels, ForwardDctEqualsTheModelsTransposed) {
    const auto a = patch(7), b = patch(8);
    core::Block8x8 samples, residual;
    for (int i = 0; i < 64; ++i) {
        const auto at = static_cast<std::size_t>(i / 8 * stride + i % 8);
        samples[static_cast<std::size_t>(i)] = a[at];
        residual[static_cast<std::size_t>(i)] = static_cast<float>(a[at] - b[at]);
    }
    const core::Block8x8 of_samples = core::forward_dct(samples), of_residual = core::forward_dct(residual);
    for_every_variant([&](const Kernels& k) {
        float c[64], d[64];
        k.forward_dct(c, a.data(), stride);
        k.forward_dct_of_difference(d, a.data(), stride, b.data(), stride);
        for (int u = 0; u < 8; ++u)
            for (int v = 0; v < 8; ++v) {
                EXPECT_NEAR(c[u * 8 + v], of_samples[static_cast<std::size_t>(v * 8 + u)], 2e-3);
                EXPECT_NEAR(d[u * 8 + v], of_residual[static_cast<std::size_t>(v * 8 + u)], 2e-3);
            }
    });
}

TEST(Kernels, InverseDctIsWithinOneOfTheExactOne) {
    for_every_variant([&](const Kernels& k) {
        for (std::uint64_t seed = 10; seed < 60; ++seed) {
            const auto a = patch(seed, seed % 2 ? 0 : 100, seed % 2 ? 255 : 140);
            float c[64];
            k.forward_dct(c, a.data(), stride);
            std::int16_t rounded[64];
            core::Block8x8 raster;
            for (int i = 0; i < 64; ++i) {
                rounded[i] = static_cast<std::int16_t>(std::lround(c[i]));
                raster[static_cast<std::size_t>(i % 8 * 8 + i / 8)] = rounded[i];
            }
            const core::Block8x8 exact = core::inverse_dct(raster);
            std::uint8_t put[64], added[64];
            k.inverse_dct_put(rounded, put, 8);
            std::fill_n(added, 64, std::uint8_t{7});
            k.inverse_dct_add(rounded, added, 8);
            for (std::size_t i = 0; i < 64; ++i) {
                ASSERT_NEAR(put[i], std::clamp(exact[i], 0.0f, 255.0f), 1.0);
                ASSERT_NEAR(added[i], std::clamp(exact[i] + 7, 0.0f, 255.0f), 1.0);
            }
        }
    });
}

TEST(Kernels, QuantisationIsTheStandardsAndItsDistortionIsWhatItLeaves) {
    for (int q = 1; q <= 31; ++q)
        for (const bool intra : {false, true}) {
            const QuantTable& table = intra ? Quantiser::of(q).intra : Quantiser::of(q).non_intra;
            float c[64];
            for (int i = 0; i < 64; ++i)
                c[i] = 4094 * (core::uniform(99, static_cast<std::uint64_t>(i)) - 0.5f) * (i % 3 == 0 ? 1.0f : 0.02f);
            c[1] = -2040;  // a block that falls from white to black
            if (intra) c[0] = 0;
            for_every_variant([&](const Kernels& k) {
                std::int16_t levels[64], back[64];
                const Quantised result = k.quantise(c, table, levels, back);
                double distortion = 0, energy = 0;
                for (int i = 0; i < 64; ++i) {
                    const int raster = i % 8 * 8 + i / 8;
                    const int w = intra ? default_intra_matrix[static_cast<std::size_t>(raster)] : 16;
                    const int l = levels[i], sign = l < 0 ? -1 : l > 0 ? 1 : 0;
                    // [H262, 7.4.2.3]
                    EXPECT_EQ(back[i], (2 * l + (intra ? 0 : sign)) * w * 2 * q / 32);
                    EXPECT_LE(std::abs(back[i]), 2047);
                    EXPECT_LE(std::abs(l), 2047);
                    EXPECT_TRUE(l == 0 || (l < 0) == (c[i] < 0));
                    EXPECT_EQ(result.nonzero >> raster & 1, l != 0 ? 1u : 0u);
                    const double step = w * q / 8.0, error = std::abs(c[i] - back[i]);
                    if (std::abs(c[i]) < 1900) {
                        EXPECT_LE(error, l == 0 && !intra ? step : step / 2 + 1.001);
                    }
                    distortion += error * error;
                    energy += static_cast<double>(c[i]) * c[i];
                }
                EXPECT_NEAR(result.distortion, distortion, 1e-4 * distortion + 0.1);
                EXPECT_NEAR(result.energy, energy, 1e-4 * energy);
            });
        }
}

TEST(Kernels, AllVariantsGiveTheSameNumbers) {
    const KernelVariants variants = kernel_variants();
    const Kernels& first = *variants.variant[0];
    for (int i = 1; i < variants.count; ++i)
        for (std::uint64_t seed = 0; seed < 50; ++seed) {
            const Kernels& other = *variants.variant[i];
            const auto a = patch(2 * seed), b = patch(2 * seed + 1);
            float c[2][64];
            first.forward_dct_of_difference(c[0], a.data(), stride, b.data(), stride);
            other.forward_dct_of_difference(c[1], a.data(), stride, b.data(), stride);
            ASSERT_TRUE(std::equal(c[0], c[0] + 64, c[1]));
            std::int16_t levels[2][64], back[2][64];
            const QuantTable& table = Quantiser::of(1 + static_cast<int>(seed % 31)).non_intra;
            const Quantised q0 = first.quantise(c[0], table, levels[0], back[0]),
                            q1 = other.quantise(c[1], table, levels[1], back[1]);
            ASSERT_TRUE(std::equal(levels[0], levels[0] + 64, levels[1]) && std::equal(back[0], back[0] + 64, back[1]));
            ASSERT_TRUE(q0.nonzero == q1.nonzero && q0.distortion == q1.distortion && q0.energy == q1.energy);
            float weights[64];
            for (int w = 0; w < 64; ++w) weights[w] = core::uniform(seed, 7, static_cast<std::uint64_t>(w));
            const Quantised w0 = first.weigh(c[0], back[0], weights), w1 = other.weigh(c[0], back[0], weights);
            ASSERT_TRUE(w0.distortion == w1.distortion && w0.energy == w1.energy);
            std::fill_n(weights, 64, 1.0f);
            ASSERT_FLOAT_EQ(first.weigh(c[0], back[0], weights).distortion, q0.distortion);
            ASSERT_FLOAT_EQ(first.weigh(c[0], back[0], weights).energy, q0.energy);
            std::uint8_t out[2][64];
            first.inverse_dct_put(back[0], out[0], 8);
            other.inverse_dct_put(back[1], out[1], 8);
            ASSERT_TRUE(std::equal(out[0], out[0] + 64, out[1]));
        }
}

}  // namespace
}  // namespace render2mpeg::encoder::mpeg2
