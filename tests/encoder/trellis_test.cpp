#include "encoder/mpeg2/macroblock/trellis.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "core/sampling.h"
#include "encoder/mpeg2/kernels/quantiser.h"

namespace render2mpeg::encoder::mpeg2 {
namespace {

/// A quantised block with at most `most` levels that are not 0, small and large ones.
Block random_block(std::uint64_t seed, bool intra, int q, int most) {
    std::uint64_t n = 0;
    const auto uniform = [&] { return core::uniform(seed, n++); };
    const QuantTable& table = intra ? Quantiser::of(q).intra : Quantiser::of(q).non_intra;
    Block block{};
    // Every other block is weighed.
    static const Weights weights = [] {
        Weights w;
        for (std::size_t i = 0; i < 64; ++i) w.of[i] = 0.1f + 2.0f * core::uniform(3, i);
        return w;
    }();
    if (seed % 2 == 1) block.weights = &weights;
    if (intra) block.coefficients[0] = 1024.0f * uniform();
    for (int i = 0; i < most; ++i) {
        const int scan = (intra ? 1 : 0) + static_cast<int>(uniform() * 62.99f);
        const std::size_t place = place_of_scan[static_cast<std::size_t>(scan)];
        const float steps = (uniform() < 0.8f ? 2.5f : seed % 7 == 0 ? 90.0f : 12.0f) * (2 * uniform() - 1);
        block.coefficients[place] = steps / table.reciprocal[place];
    }
    intra ? quantise_intra(block, table, 8) : quantise_non_intra(block, table);
    return block;
}

float cost_of(const Block& block, const CoefficientLengths& lengths, bool intra, float lambda) {
    return block.distortion + lambda * static_cast<float>(coefficient_bits(block, lengths, intra));
}

/// The least cost over every choice of each level, one below and 0.
float least_cost(const Block& block, const QuantTable& table, const CoefficientLengths& lengths, bool intra,
                 float lambda) {
    std::vector<int> scans;
    for (std::uint64_t left = block.scan_mask; left != 0; left &= left - 1) scans.push_back(std::countr_zero(left));
    int combinations = 1;
    for (std::size_t i = 0; i < scans.size(); ++i) combinations *= 3;
    float least = cost_of(block, lengths, intra, lambda);
    for (int c = 0; c < combinations; ++c) {
        Block other = block;
        for (std::size_t i = 0, rest = static_cast<std::size_t>(c); i < scans.size(); ++i, rest /= 3) {
            const std::size_t place = place_of_scan[static_cast<std::size_t>(scans[i])];
            const int magnitude = std::abs(block.levels[place]), sign = block.levels[place] < 0 ? -1 : 1;
            const int level = rest % 3 == 0 ? magnitude : rest % 3 == 1 ? magnitude - 1 : 0;
            const int value = level == 0 ? 0 : ((2 * level + table.reconstruction) * table.weight[place]) >> 4;
            const float before = block.coefficients[place] - static_cast<float>(block.dequantised[place]),
                        after = block.coefficients[place] - static_cast<float>(sign * value);
            other.distortion += loss_of(block, place, after) - loss_of(block, place, before);
            other.levels[place] = static_cast<std::int16_t>(sign * level);
            if (level == 0) other.scan_mask &= ~(std::uint64_t{1} << scans[i]);
        }
        least = std::min(least, cost_of(other, lengths, intra, lambda));
    }
    return least;
}

TEST(Trellis, FindsTheLeastCostThereIs) {
    for (const bool intra : {false, true})
        for (const bool one : {false, true})
            for (std::uint64_t seed = 0; seed < 150; ++seed) {
                if (one && !intra) continue;
                const int q = 1 + static_cast<int>(seed % 31);
                const QuantTable& table = intra ? Quantiser::of(q).intra : Quantiser::of(q).non_intra;
                const CoefficientLengths& lengths = one ? CoefficientLengths::one() : CoefficientLengths::zero();
                const float lambda = (0.1f + static_cast<float>(seed % 7)) * static_cast<float>(q * q);
                Block block = random_block(seed, intra, q, 7);
                const float least = least_cost(block, table, lengths, intra, lambda);
                trellis_rdoq(block, table, lengths, intra, lambda);
                const float found = cost_of(block, lengths, intra, lambda);
                ASSERT_NEAR(found, least, 1e-4f * least + 1e-2f) << "seed " << seed << (intra ? " intra" : "");
            }
}

TEST(Trellis, KeepsItsBooks) {
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
        const int q = 1 + static_cast<int>(seed % 31);
        const QuantTable& table = Quantiser::of(q).non_intra;
        Block block = random_block(seed, false, q, 30);
        trellis_rdoq(block, table, CoefficientLengths::zero(), false, static_cast<float>(q * q));
        float distortion = 0;
        for (std::size_t scan = 0; scan < 64; ++scan) {
            const std::size_t place = place_of_scan[scan];
            const float error = block.coefficients[place] - static_cast<float>(block.dequantised[place]);
            distortion += loss_of(block, place, error);
            ASSERT_EQ(block.levels[place] != 0, (block.scan_mask >> scan & 1) != 0);
            ASSERT_EQ(block.levels[place] != 0, block.dequantised[place] != 0);
        }
        ASSERT_NEAR(block.distortion, distortion, 1e-3f * distortion + 1e-2f);
    }
}

TEST(Trellis, LongerRunsHaveNoShorterCodes) {
    for (const CoefficientLengths* lengths : {&CoefficientLengths::zero(), &CoefficientLengths::one()})
        for (int level = 1; level < 64; ++level)
            for (int run = 0; run < 63; ++run) EXPECT_LE(lengths->bits(run, level), lengths->bits(run + 1, level));
}

}  // namespace
}  // namespace render2mpeg::encoder::mpeg2
