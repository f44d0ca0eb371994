#include "core/rational.h"

#include <gtest/gtest.h>

#include <tuple>

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

TEST(FrameRate, MayBeAnyThatFilmsHave) {
    const std::tuple<const char*, Rational, const char*> rates[] = {{"12", {12, 1}, "12"},
                                                                    {"12.5", {25, 2}, "12.5"},
                                                                    {"25/2", {25, 2}, "12.5"},
                                                                    {"48", {48, 1}, "48"},
                                                                    {"119.88", {120000, 1001}, "119.88"},
                                                                    {"47.952", {48000, 1001}, "47.952"},
                                                                    {"10/3", {10, 3}, "10/3"},
                                                                    {"15000/1001", {15000, 1001}, "15000/1001"},
                                                                    {"0.5", {1, 2}, "0.5"},
                                                                    {"240", {240, 1}, "240"},
                                                                    {"29.97003", {30000, 1001}, "29.97"},
                                                                    {"24/1.001", {24000, 1001}, "23.976"}};
    for (const auto& [text, hertz, name] : rates) {
        const FrameRate rate = frame_rate_from(text);
        EXPECT_EQ(rate.hertz, hertz) << text;
        EXPECT_EQ(rate.name, name);
        EXPECT_EQ(frame_rate_from(rate.name).hertz, hertz) << text;
        EXPECT_EQ(rate.code > 0, rate.name == "29.97" || rate.name == "23.976") << text;
    }
}

TEST(FrameRate, ThatNoFilmHasIsRefused) {
    for (const char* text :
         {"", "0.01", "241", "-25", "0", "25fps", "25/0", "25/", "/1", "nan", "inf", "1e99", "1/2/3"})
        EXPECT_THROW(frame_rate_from(text), Error) << text;
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
