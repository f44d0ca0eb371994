#include "encoder/timecode.h"

#include <gtest/gtest.h>

#include "encoder/mpeg2/bitstream/syntax.h"
#include "film.h"

/// Clock times that editors count by, and those of MPEG-2's groups of pictures.
namespace render2mpeg::encoder::testing {
namespace {

TEST(Timecode, DropFrameCountsEachNumberOnceAndKeepsUpWithTheClock) {
    for (const int per_second : {30, 60}) {
        const Timecode midnight{0, 0, 0, 0, true};
        // Twenty minutes: each picture is the one behind the one before.
        Timecode before = midnight;
        for (int n = 1; n < 20 * 60 * per_second; ++n) {
            const Timecode now = later(before, 1, per_second);
            ASSERT_EQ(now, later(midnight, n, per_second)) << n;
            const bool is_left_out = now.seconds == 0 && now.minutes % 10 != 0 && now.frames < per_second / 15;
            ASSERT_FALSE(is_left_out) << text_of(now);
            ASSERT_TRUE(timecode_from(text_of(now), per_second, true)) << text_of(now);
            before = now;
        }
        // 29.97 x 3600 pictures are 107,892 and a tenth.
        EXPECT_EQ(text_of(later(midnight, 107'892 * per_second / 30, per_second)), "01:00:00;00");
    }
    EXPECT_EQ(text_of(later({0, 0, 59, 29, true}, 1, 30)), "00:01:00;02");
    EXPECT_EQ(text_of(later({0, 9, 59, 29, true}, 1, 30)), "00:10:00;00");
    EXPECT_EQ(text_of(later({23, 59, 59, 29, true}, 1, 30)), "00:00:00;00");
    EXPECT_EQ(text_of(later({9, 59, 59, 24, false}, 2, 25)), "10:00:00:01");
}

TEST(Timecode, RefusesWhatIsNone) {
    EXPECT_EQ(timecode_from("01:02:03:04", 25, false), (Timecode{1, 2, 3, 4, false}));
    EXPECT_EQ(timecode_from("01:02:03;04", 30, true), (Timecode{1, 2, 3, 4, true}));
    for (const char* wrong : {"", "1:02:03:04", "01:02:03", "01:02:03:25", "24:00:00:00", "01:60:00:00", "01:00:60:00",
                              "01:02:03;04", "01:02:+3:04", "01:02: 3:04", "01-02-03-04", "01:02:03:04 "})
        EXPECT_FALSE(timecode_from(wrong, 25, false)) << wrong;
    EXPECT_FALSE(timecode_from("00:01:00;01", 30, true)) << "it is left out";
    EXPECT_TRUE(timecode_from("00:10:00;01", 30, true));
}

TEST(Timecode, GroupsOfMpeg2CountFromTheFilmsOwn) {
    Settings s = settings(64, 64, 4, 6, 4);
    s.first_number = 100;
    const auto group = [&](std::int64_t number) {
        mpeg2::BitWriter out;
        mpeg2::write_gop(out, s, number, true);
        const std::vector<std::uint8_t> bytes = out.take();
        const unsigned code = bytes[4] << 17 | bytes[5] << 9 | bytes[6] << 1 | bytes[7] >> 7;
        return Timecode{static_cast<int>(code >> 19 & 31), static_cast<int>(code >> 13 & 63),
                        static_cast<int>(code >> 6 & 63), static_cast<int>(code & 63), (code >> 24 & 1) != 0};
    };
    EXPECT_EQ(text_of(group(130)), "00:00:04:10");
    s.labels.start = Timecode{0, 0, 59, 29, true};
    EXPECT_EQ(text_of(group(100)), "00:00:59;29");
    EXPECT_EQ(text_of(group(101)), "00:01:00;02");
}

}  // namespace
}  // namespace render2mpeg::encoder::testing
