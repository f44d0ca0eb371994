#include <gtest/gtest.h>

#include "core/tolerance_map.h"

namespace render2mpeg::core {
namespace {

TEST(Tolerance, IsTheLargerOfBothPartsWhateverThePixelGets) {
    const Tolerance t{0.1f, 0.02f};
    EXPECT_FLOAT_EQ(t.allows(0), 0.1f);
    EXPECT_FLOAT_EQ(t.allows(1), 0.1f);
    EXPECT_FLOAT_EQ(t.allows(10), 0.2f);
}

TEST(Tolerance, ShrinksWithTheLightWherePixelsGetLessThanUsual) {
    const Tolerance t{0.1f, 0.02f, 0.8f};
    EXPECT_FLOAT_EQ(t.allows(0.8f), 0.1f);
    EXPECT_FLOAT_EQ(t.allows(0.4f), 0.05f);
    EXPECT_FLOAT_EQ(t.allows(0.2f), 0.025f);
    // More light than the background hides no more, as far as is known.
    EXPECT_FLOAT_EQ(t.allows(2), 0.1f);
    EXPECT_FLOAT_EQ(t.allows(10), 0.2f);
    // In the dark it is what the Weber fraction leaves of the absolute part, not nothing.
    EXPECT_FLOAT_EQ(t.allows(0), 0.1f * 0.125f);
    EXPECT_FLOAT_EQ(t.allows(0.05f), 0.1f * 0.125f);
}

TEST(Tolerance, IsWholeInTheDarkWhereItWasToldInTheDark) {
    for (const float background : {0.0f, 1e-38f, 0.001f, 0.1f}) {
        const Tolerance t{0.1f, 0.02f, background};
        for (const float light : {0.0f, 1e-6f, 0.05f, 0.1f, 1.0f}) EXPECT_FLOAT_EQ(t.allows(light), 0.1f) << background;
    }
    const Tolerance none{0.0f, 0.02f, 0.5f};
    EXPECT_EQ(none.allows(0), 0.0f);
    EXPECT_FLOAT_EQ(none.allows(1), 0.02f);
}

TEST(Tolerance, IsInProportionToAPixelsPart) {
    const Tolerance whole{0.1f, 0.02f, 0.8f};
    for (const float part : {0.5f, 0.01f})
        for (const float light : {0.0f, 0.05f, 0.3f, 0.9f, 20.0f}) {
            const Tolerance t{part * whole.absolute, whole.relative, part * whole.background};
            EXPECT_NEAR(t.allows(part * light), part * whole.allows(light), 1e-6f * whole.allows(light));
        }
}

}  // namespace
}  // namespace render2mpeg::core
