#include "core/rational.h"

#include <gtest/gtest.h>

#include <numeric>

#include "core/error.h"

namespace render2mpeg::core {
namespace {

TEST(Ratio, IsReadInLowestTerms) {
    EXPECT_EQ(ratio_from("16:9"), (Rational{16, 9}));
    EXPECT_EQ(ratio_from("32:18"), (Rational{16, 9}));
    EXPECT_EQ(ratio_from("2.21:1"), (Rational{221, 100}));
    EXPECT_EQ(ratio_from("1:2.5"), (Rational{2, 5}));
    EXPECT_EQ(ratio_from("10000:0.001"), (Rational{10'000'000, 1}));
    for (const char* wrong : {"", ":", "16", "16:", ":9", "16:0", "0:9", "16/9", "-16:9", "16:9:4", "1.2345:1",
                              "1..2:1", "16 :9", "inf:1", "10001:1", "999999999999999999999:1"})
        EXPECT_THROW(ratio_from(wrong), Error) << wrong;
}

TEST(Ratio, MultiplyingByTheInverseUndoesMultiplying) {
    for (const Rational a : {Rational{16, 9}, Rational{64, 45}, Rational{221, 100}})
        for (const Rational b : {Rational{576, 720}, Rational{11, 10}}) {
            EXPECT_EQ(product(product(a, b), {b.den, b.num}), a);
            EXPECT_DOUBLE_EQ(product(a, b).value(), a.value() * b.value());
        }
    EXPECT_EQ(product(ratio_from("16:9"), {576, 720}), (Rational{64, 45}));
}

TEST(FrameRate, HasMpeg2sEightInTheOrderOfTheirCodes) {
    const auto& rates = mpeg2_frame_rates();
    ASSERT_EQ(rates.size(), 8u);
    for (int i = 0; i < 8; ++i) EXPECT_EQ(rates[i].code, i + 1);
    for (int i = 1; i < 8; ++i) EXPECT_LT(rates[i - 1].hertz.value(), rates[i].hertz.value());
    EXPECT_EQ(rates[3].hertz, (Rational{30000, 1001}));
}

TEST(FrameRate, IsFoundByEachOfItsNames) {
    for (const FrameRate& rate : mpeg2_frame_rates()) {
        EXPECT_EQ(frame_rate_from(rate.name).code, rate.code);
        const std::string fraction = std::to_string(rate.hertz.num) + "/" + std::to_string(rate.hertz.den);
        EXPECT_EQ(frame_rate_from(fraction).code, rate.code) << fraction;
    }
}

TEST(FrameRate, ForgivesTheUsualAbbreviations) {
    EXPECT_EQ(frame_rate_from("23.98").code, 1);
    EXPECT_EQ(frame_rate_from("29.970").code, 4);
    EXPECT_EQ(frame_rate_from("25.0").code, 3);
    EXPECT_EQ(frame_rate_from("50/2").code, 3);
}

TEST(FrameRate, TellsNtscFromWholeRates) {
    EXPECT_EQ(frame_rate_from("24").code, 2);
    EXPECT_EQ(frame_rate_from("30").code, 5);
    EXPECT_EQ(frame_rate_from("60").code, 8);
    EXPECT_EQ(frame_rate_from("59.94").code, 7);
}

TEST(FrameRate, ThatMpeg2LacksIsRefusedWithTheList) {
    for (const char* text :
         {"", "12", "15", "-25", "0", "25fps", "25/0", "25/", "/1", "nan", "inf", "1e99", "24.9", "29.98"}) {
        try {
            frame_rate_from(text);
            FAIL() << "accepted " << text;
        } catch (const Error& error) {
            const std::string line = error.what();
            for (const FrameRate& rate : mpeg2_frame_rates())
                EXPECT_NE(line.find(rate.name), std::string::npos) << line;
        }
    }
}

TEST(Time, OfAFrameIsExact) {
    const FrameRate ntsc = frame_rate_from("29.97");
    EXPECT_EQ(time_of(0, ntsc), (Rational{0, 1}));
    EXPECT_EQ(time_of(30, ntsc), (Rational{1001, 1000}));
    EXPECT_EQ(time_of(30000, ntsc), (Rational{1001, 1}));
    EXPECT_EQ(time_of(-30, ntsc), (Rational{-1001, 1000}));
}

TEST(Time, IsInLowestTermsAndRisesByOnePeriod) {
    for (const FrameRate& rate : mpeg2_frame_rates())
        for (std::int64_t n : {1, 2, 59, 60, 1000000, 1000000000}) {
            const Rational a = time_of(n, rate);
            const Rational b = time_of(n + 1, rate);
            EXPECT_GT(a.den, 0);
            // b - a = 1 / rate, multiplied out in integers wide enough for 10^9 frames (a year at 30 Hz).
            const __int128 left =
                (static_cast<__int128>(b.num) * a.den - static_cast<__int128>(a.num) * b.den) * rate.hertz.num;
            const __int128 right = static_cast<__int128>(a.den) * b.den * rate.hertz.den;
            EXPECT_TRUE(left == right) << rate.name << " frame " << n;
            EXPECT_EQ(std::gcd(a.num, a.den), 1);
        }
}

}  // namespace
}  // namespace render2mpeg::core
