#include "encoder/av/svt_layers.h"

#include <gtest/gtest.h>

#include <cstddef>

#include "encoder/codec.h"

namespace render2mpeg::av {
namespace {

TEST(SvtLayers, GroupsOfSixteenAndWhatIsLeft) {
    const auto ratio = [](int place, int last) { return svt_step_ratio(place, last); };
    EXPECT_LT(ratio(0, 39), ratio(16, 39));
    EXPECT_EQ(ratio(16, 39), ratio(32, 39));
    EXPECT_EQ(ratio(16, 39), ratio(36, 39)) << "the last of a group of four";
    EXPECT_LT(ratio(16, 39), ratio(8, 39));
    EXPECT_LT(ratio(8, 39), ratio(4, 39));
    EXPECT_EQ(ratio(8, 39), ratio(38, 39)) << "the middle of a group that ends early";
    EXPECT_EQ(ratio(3, 39), 1.0f);
    for (int last = 0; last < 70; ++last)
        for (int place = 0; place <= last; ++place) {
            EXPECT_GT(ratio(place, last), 0.2f);
            EXPECT_LE(ratio(place, last), 1.0f);
        }
}

TEST(SvtLayers, HaveIndicesOfTheirStepsAtQuartersOfQuantisers) {
    const IndexOffsets finer = svt_index_offsets(29.75), whole = svt_index_offsets(30),
                       coarser = svt_index_offsets(30.25);
    EXPECT_EQ(finer.back() + 4 * svt_quantiser(29.75), 119);
    EXPECT_EQ(whole.back() + 4 * svt_quantiser(30), 120);
    EXPECT_EQ(coarser.back() + 4 * svt_quantiser(30.25), 121);
    for (const double quantiser : {8.0, 30.0, 50.0, 63.0}) {
        const IndexOffsets offsets = svt_index_offsets(quantiser);
        const auto ratio = [&](std::size_t layer) {
            return encoder::step_of(encoder::Codec::av1, svt_quantiser(quantiser) + 0.25 * offsets[layer]) /
                   encoder::step_of(encoder::Codec::av1, quantiser);
        };
        EXPECT_NEAR(ratio(0), svt_step_ratio(0, 16), 0.03) << quantiser;
        EXPECT_NEAR(ratio(1), svt_step_ratio(16, 16), 0.03) << quantiser;
        EXPECT_NEAR(ratio(2), svt_step_ratio(8, 16), 0.03) << quantiser;
        EXPECT_NEAR(ratio(5), svt_step_ratio(3, 16), 0.03) << quantiser;
    }
}

TEST(SvtLayers, RiseEvenlyWithTheQuantiser) {
    IndexOffsets before = svt_index_offsets(1);
    for (int& index : before) index += 4 * svt_quantiser(1);
    for (double quantiser = 1; quantiser <= 63; quantiser += 1 / steps_of_quantiser) {
        IndexOffsets indices = svt_index_offsets(quantiser);
        for (std::size_t i = 0; i < indices.size(); ++i) {
            EXPECT_GE(indices[i], -64) << quantiser;
            EXPECT_LE(indices[i], 63) << quantiser;
            indices[i] += 4 * svt_quantiser(quantiser);
            EXPECT_GE(indices[i], 1) << "0 is lossless; " << quantiser;
            EXPECT_GE(indices[i], before[i]) << quantiser;
            EXPECT_LE(indices[i], before[i] + 1) << quantiser;
        }
        before = indices;
    }
}

}  // namespace
}  // namespace render2mpeg::av
