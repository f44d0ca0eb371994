#include "renderer/base/light_packing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/sampling.h"

namespace render2mpeg::renderer {
namespace {

float packing_dice(std::uint64_t i, std::uint64_t k) {
    return core::uniform(3, i, k);
}

MiddleBox unpacked(const BoxGrid& grid, const glm::vec3& low, const glm::vec3& high) {
    MiddleBox box;
    PackedBox(grid, low, high)
        .unpack(grid, box.middle.x, box.middle.y, box.middle.z, box.half.x, box.half.y, box.half.z);
    return box;
}

glm::vec3 unpacked(const glm::vec3& light) {
    glm::vec3 kept;
    PackedLight(light).unpack(kept.x, kept.y, kept.z);
    return kept;
}

/// Where the grid begins, and how far it goes along each axis.
struct Place {
    glm::vec3 low, extent;
};

class PackedBoxes : public testing::TestWithParam<Place> {};

TEST_P(PackedBoxes, HoldWhatTheyAreMadeOfAndHardlyMore) {
    const auto [origin, extent] = GetParam();
    const glm::vec3 end = origin + extent;
    const BoxGrid grid(origin, end);
    for (std::uint64_t i = 0; i < 4000; ++i) {
        glm::vec3 low, high;
        for (int k = 0; k < 3; ++k) {
            const auto n = static_cast<std::uint64_t>(k);
            const float size = i % 3 == 0 ? 0.0f : std::exp2(-24.0f * packing_dice(i, 4 + n));
            low[k] = std::clamp(origin[k] + extent[k] * packing_dice(i, n), origin[k], end[k]);
            high[k] = std::clamp(low[k] + extent[k] * size, low[k], end[k]);
            if (i == 0) low[k] = high[k] = origin[k];
            if (i == 1) low[k] = high[k] = end[k];
        }
        const MiddleBox box = unpacked(grid, low, high);
        for (int k = 0; k < 3; ++k) {
            ASSERT_LE(box.middle[k] - box.half[k], low[k]) << i;
            ASSERT_GE(box.middle[k] + box.half[k], high[k]) << i;
            ASSERT_LE(std::abs(low[k] - box.middle[k]), box.half[k]) << i;
            ASSERT_LE(std::abs(high[k] - box.middle[k]), box.half[k]) << i;
            // A step is half a millionth of the extent; shadow rays are lifted by four of the largest coordinate.
            const float largest = std::max(std::abs(origin[k]), std::abs(end[k]));
            ASSERT_LE(box.half[k], 0.5f * (high[k] - low[k]) + 1e-6f * extent[k] + 5e-7f * largest) << i;
        }
    }
}
INSTANTIATE_TEST_SUITE_P(ScalesAndDistances, PackedBoxes,
                         testing::Values(Place{{0, 0, 0}, {1, 1, 1}}, Place{{-5, 0, 3}, {40, 12, 0}},
                                         Place{{1e6f, -1e6f, 0}, {1e3f, 1, 1e-3f}},
                                         Place{{-1e-4f, 0, 0}, {1e-4f, 1e-4f, 3e-4f}}, Place{{7, 7, 7}, {0, 0, 0}}));

TEST(PackedLight, IsRoundedUpByLittle) {
    for (std::uint64_t i = 0; i < 20000; ++i) {
        const float scale = std::exp2(120.0f * packing_dice(i, 0) - 60.0f);
        const glm::vec3 light =
            scale * glm::vec3(packing_dice(i, 1), packing_dice(i, 2), std::exp2(-30.0f * packing_dice(i, 3)));
        const glm::vec3 kept = unpacked(light);
        const float largest = std::max({light.x, light.y, light.z});
        for (int k = 0; k < 3; ++k) {
            ASSERT_GE(kept[k], light[k]);
            ASSERT_LE(kept[k], light[k] + 0x1p-15f * largest);
        }
        ASSERT_EQ(unpacked(4.0f * light), 4.0f * kept);
    }
    EXPECT_EQ(unpacked(glm::vec3(0)), glm::vec3(0));
    EXPECT_EQ(unpacked({1, 0.5f, 0}), (glm::vec3{1, 0.5f, 0}));
    // All ones in 16 bits and more: the step must double.
    EXPECT_EQ(unpacked(glm::vec3(0x1.ffffp0f)), glm::vec3(2));
    EXPECT_GE(unpacked(glm::vec3(1e30f)).x, 1e30f);
    EXPECT_GT(unpacked(glm::vec3(1e-44f)).x, 0.0f);
    // Sums of finite lights may be infinite.
    for (const float most : {std::numeric_limits<float>::max(), std::numeric_limits<float>::infinity()})
        EXPECT_EQ(unpacked({most, 1, 0}), (glm::vec3{0x1.fffep127f, 0x1p112f, 0}));
}

TEST(PackedNormals, AreUnpackedAsEverywhere) {
    for (std::uint64_t i = 0; i < 5000; ++i) {
        const core::PackedNormal packed(core::sample_sphere({packing_dice(i, 0), packing_dice(i, 1)}));
        glm::vec3 here;
        unpack_normal(packed, here.x, here.y, here.z);
        EXPECT_LT(glm::length(here - packed.unpack()), 3e-7f);
    }
}

}  // namespace
}  // namespace render2mpeg::renderer
