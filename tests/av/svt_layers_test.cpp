#include "encoder/av/svt_layers.h"

#include <gtest/gtest.h>

namespace render2mpeg::av {
namespace {

using encoder::Effort;

TEST(SvtLayers, GroupsOfSixteenAndWhatIsLeft) {
    const auto ratio = [](int place, int last) { return svt_step_ratio(place, last, Effort::quality); };
    EXPECT_LT(ratio(0, 39), ratio(16, 39));
    EXPECT_EQ(ratio(16, 39), ratio(32, 39));
    EXPECT_EQ(ratio(16, 39), ratio(36, 39)) << "the last of a group of four";
    EXPECT_LT(ratio(16, 39), ratio(8, 39));
    EXPECT_LT(ratio(8, 39), ratio(4, 39));
    EXPECT_EQ(ratio(8, 39), ratio(38, 39)) << "the middle of a group that ends early";
    EXPECT_EQ(ratio(3, 39), 1.0f);
    EXPECT_EQ(svt_step_ratio(1, 39, Effort::fast), 1.0f);
    for (int last = 0; last < 70; ++last)
        for (int place = 0; place <= last; ++place) {
            EXPECT_GT(ratio(place, last), 0.2f);
            EXPECT_LE(ratio(place, last), 1.0f);
        }
}

}  // namespace
}  // namespace render2mpeg::av
