#include "perceptual/display.h"

#include <gtest/gtest.h>

#include <cmath>

namespace render2mpeg::perceptual {
namespace {

TEST(ShownPicture, OfEvenColoursIsTheSignalsThatItWasMadeOf) {
    for (const ColorMatrix matrix : {ColorMatrix::bt601, ColorMatrix::bt709})
        for (const glm::vec3 color :
             {glm::vec3(0), glm::vec3(1), glm::vec3(0.5f), glm::vec3(0.8f, 0.3f, 0.1f), glm::vec3(0.1f, 0.2f, 0.9f)}) {
            const core::Picture picture = picture_of_signals(core::Plane<glm::vec3>(5, 3, color), matrix);
            const std::vector<std::uint8_t> rgb = shown_rgb(picture, {matrix});
            ASSERT_EQ(rgb.size(), 5u * 3u * 3u);
            for (std::size_t i = 0; i < rgb.size(); ++i)
                EXPECT_NEAR(rgb[i], 255 * color[static_cast<int>(i % 3)], 2.0) << "but for roundings of code values";
        }
}

TEST(ShownPicture, KeepsChromaWhereItLies) {
    // Red on the left, blue on the right: between the two columns that chroma lies on it is halfway.
    core::Picture picture;
    picture.y = core::Plane<std::uint8_t>(4, 2, 126);
    picture.cb = picture.cr = core::Plane<std::uint8_t>(2, 1, 128);
    picture.cr.at(0, 0) = 168;
    const std::vector<std::uint8_t> rgb = shown_rgb(picture, {ColorMatrix::bt601});
    const auto red = [&](int x) { return static_cast<int>(rgb[static_cast<std::size_t>(3 * x)]); };
    EXPECT_GT(red(0), red(1));
    EXPECT_NEAR(red(1) - red(2), red(0) - red(1), 1);
    EXPECT_EQ(red(2), red(3));
    EXPECT_EQ(red(0), static_cast<int>(rgb[12])) << "rows alike";
}

}  // namespace
}  // namespace render2mpeg::perceptual
