#include "encoder/mpeg2/macroblock/intra_refresh.h"

#include <gtest/gtest.h>

#include "film.h"

namespace render2mpeg::encoder::testing {
namespace {

TEST(IntraRefresh, NoMacroblockIsPredictedForEver) {
    // Dim noise over a texture that slides by half pixels: hardly a macroblock is skipped, none is better intra.
    const Settings s = settings(80, 64, 6, 400);
    constexpr int count = 300;
    const glm::vec2 step{0.5f, 0};
    const Film film = encode(
        s, count,
        [&](std::int64_t n) {
            const core::Picture grain = noise(s.width, s.height, n, static_cast<std::uint64_t>(n));
            core::Picture picture = textured(s, n, glm::dvec2(step));
            for (std::size_t i = 0; i < picture.y.size(); ++i)
                picture.y.values()[i] = static_cast<std::uint8_t>(
                    std::clamp(picture.y.values()[i] + (grain.y.values()[i] - 128) / 8, 0, 255));
            return picture;
        },
        [&](const PicturePlan& plan) { return steady_motion(s, plan, step); });
    expect_decoders_agree(film, 1.0);

    core::Plane<int> predictions(5, 4);
    int longest = 0, most_intra = 0;
    for (const CodedPicture& coded : film.coded) {
        int intra = 0;
        for (std::size_t i = 0; i < predictions.size(); ++i) {
            const MacroblockRecord& m = coded.macroblocks.values()[i];
            int& since = predictions.values()[i];
            since = m.intra ? 0 : since + !m.skipped;
            intra += m.intra;
            longest = std::max(longest, since);
        }
        if (coded.plan.number > 0) most_intra = std::max(most_intra, intra);
    }
    EXPECT_LE(longest, mpeg2::most_predictions);
    EXPECT_GE(longest, mpeg2::most_predictions - 32);
    EXPECT_LE(most_intra, 4);  // of 20 macroblocks
    EXPECT_GE(most_intra, 1);
}

TEST(IntraRefresh, WhatIsDueStaysDueHoweverLongItIsNotRenewed) {
    mpeg2::IntraRefresh refresh(1, 1);
    core::Plane<MacroblockRecord> coded(1, 1);
    for (int n = 0; n < 1000; ++n) {
        refresh.record(PictureType::predicted, coded);
        ASSERT_EQ(refresh.due().at(0, 0), n + 1 >= mpeg2::most_predictions ? 1 : 0) << n;
    }
    coded.at(0, 0).intra = true;
    refresh.record(PictureType::predicted, coded);
    EXPECT_EQ(refresh.due().at(0, 0), 0);
}

}  // namespace
}  // namespace render2mpeg::encoder::testing
