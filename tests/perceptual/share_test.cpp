#include "perceptual/share.h"

#include <gtest/gtest.h>

namespace render2mpeg::perceptual {
namespace {

TEST(DefaultShare, LeavesMoreToCoarserQuantisersInAll) {
    // The share falls, but what it is of grows faster: coarser films may be lit more coarsely.
    for (int code = 1; code < 31; ++code) {
        const float here = static_cast<float>(code) / 8.0f, next = static_cast<float>(code + 1) / 8.0f;
        EXPECT_LE(default_share(next), default_share(here)) << code;
        EXPECT_GT(next * default_share(next), here * default_share(here)) << code;
    }
}

TEST(DefaultShare, IsAShareForEveryQuantiser) {
    for (const float scale : {1e-6f, 0.125f, 1.0f, 3.875f, 14.0f, 1e6f}) {
        EXPECT_GT(default_share(scale), 0.0f) << scale;
        EXPECT_LE(default_share(scale), 1.0f) << scale;
    }
}

}  // namespace
}  // namespace render2mpeg::perceptual
