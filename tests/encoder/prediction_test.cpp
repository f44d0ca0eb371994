#include "encoder/prediction.h"

#include <gtest/gtest.h>

#include "core/rational.h"
#include "core/sampling.h"
#include "encoder/encoder.h"

namespace render2mpeg::encoder {
namespace {

/// A rough picture, displaced by half pixels to the left and up.
core::Picture rough(std::int64_t number, int half_pixels) {
    constexpr int width = 96, height = 64;
    const auto at = [](int x, int y) {
        return 40.0f + 150.0f * core::uniform(1, static_cast<std::uint64_t>(x / 3), static_cast<std::uint64_t>(y / 3));
    };
    core::Picture picture;
    picture.number = number;
    picture.y = core::Plane<std::uint8_t>(width, height);
    picture.cb = picture.cr = core::Plane<std::uint8_t>(width / 2, height / 2, 128);
    const int whole = half_pixels / 2, half = half_pixels % 2;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            picture.y.at(x, y) = static_cast<std::uint8_t>(
                0.5f * (at(x + whole + 30, y + whole + 30) + at(x + whole + half + 30, y + whole + half + 30)));
    return picture;
}

TEST(Prediction, IsWhatSkippedAndEmptyMacroblocksDecodeTo) {
    encoder::Settings settings;
    settings.width = 96;
    settings.height = 64;
    settings.rate = core::frame_rate_from("25");
    settings.quantiser = 31;
    settings.b_pictures = 0;
    encoder::Encoder encoder(settings);
    core::Plane<std::uint8_t> before;
    int compared = 0;
    for (int n = 0; n < 4; ++n) {
        const encoder::PicturePlan plan = encoder.plan(n, {}, n == 0);
        core::MotionField motion;
        motion.picture = n;
        motion.reference = n - 1;
        motion.vector = core::Plane<glm::vec2>(96, 64, glm::vec2(0.5f * static_cast<float>(n)));
        motion.kind = core::Plane<core::PixelClass>(96, 64, core::PixelClass::surface);
        const std::vector<core::MotionField> fields(n == 0 ? 0 : 1, motion);
        const auto coded = encoder.push(rough(n, n * (n + 1) / 2), plan, fields);
        ASSERT_EQ(coded.size(), 1u);
        const core::Plane<std::uint8_t>& decoded = coded[0].reconstruction.y;
        if (n > 0) {
            const core::Plane<std::uint8_t> prediction = prediction_of(coded[0], before);
            for (int row = 0; row < 4; ++row)
                for (int column = 0; column < 6; ++column) {
                    const encoder::MacroblockRecord& record = coded[0].macroblocks.at(column, row);
                    // Without coefficients a macroblock has no bits for them: its type and vectors take less than this.
                    if (record.intra || (!record.skipped && record.bits > 12)) continue;
                    ++compared;
                    for (int y = 16 * row; y < 16 * row + 16; ++y)
                        for (int x = 16 * column; x < 16 * column + 16; ++x)
                            ASSERT_EQ(prediction.at(x, y), decoded.at(x, y)) << n << " " << x << " " << y;
                }
        }
        before = decoded;
    }
    EXPECT_GT(compared, 10);
}

}  // namespace
}  // namespace render2mpeg::encoder
