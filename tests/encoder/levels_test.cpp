#include "encoder/mpeg2/bitstream/levels.h"

#include <gtest/gtest.h>

#include <string>

#include "core/error.h"
#include "encoder/mpeg2/bitstream/syntax.h"
#include "encoder/mpeg2/bitstream/vector.h"
#include "film.h"

namespace render2mpeg::encoder::mpeg2 {
namespace {

using testing::settings;

std::string level_name(int width, int height, int rate_code) {
    return level_for(settings(width, height, 4, 15, rate_code)).name;
}

std::string level_refusal(const Settings& s) {
    try {
        check(s);
    } catch (const core::Error& e) {
        return e.what();
    }
    return "";
}
bool says(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

TEST(Levels, TheLowestThatAllowsSizeRateAndSamplesIsTaken) {
    EXPECT_EQ(level_name(1, 1, 1), "Main");
    EXPECT_EQ(level_name(720, 576, 3), "Main");  // 10,368,000 samples/s exactly
    EXPECT_EQ(level_name(720, 480, 5), "Main");  // likewise
    EXPECT_EQ(level_name(720, 576, 5), "High-1440");
    EXPECT_EQ(level_name(320, 240, 6), "High-1440");  // Main level ends at 30 Hz
    EXPECT_EQ(level_name(736, 480, 1), "High-1440");
    EXPECT_EQ(level_name(1280, 720, 5), "High-1440");
    EXPECT_EQ(level_name(1440, 1080, 5), "High-1440");  // 47,001,600 samples/s exactly, in whole macroblocks
    EXPECT_EQ(level_name(1280, 720, 8), "High");
    EXPECT_EQ(level_name(1920, 1080, 5), "High");  // 62,668,800 samples/s exactly
    EXPECT_EQ(level_name(1920, 1152, 2), "High");
}

TEST(Levels, WhatNoneAllowsIsRefusedByNamingTheLimit) {
    EXPECT_TRUE(says(level_refusal(settings(1921, 16)), "1920 columns"));
    EXPECT_TRUE(says(level_refusal(settings(16, 1153)), "1152 lines"));
    EXPECT_TRUE(says(level_refusal(settings(1920, 1080, 4, 15, 8)), "62668800 luma samples per second"));
    EXPECT_TRUE(says(level_refusal(settings(1920, 1152, 4, 15, 5)), "62668800 luma samples per second"));
    EXPECT_TRUE(says(level_refusal(settings(0, 16)), "at least 1"));
    EXPECT_TRUE(says(level_refusal(settings(16, 16, 0)), "quantiser 0: must be 1..31"));
    EXPECT_TRUE(says(level_refusal(settings(16, 16, 32)), "quantiser 32"));
    EXPECT_TRUE(says(level_refusal(settings(16, 16, 4, 0)), "gop 0"));
    Settings s = settings(16, 16);
    s.rate = {};
    EXPECT_TRUE(says(level_refusal(s), "MPEG-2 has 23.976"));
    s = settings(16, 16);
    s.matrix_coefficients = 2;
    EXPECT_TRUE(says(level_refusal(s), "matrix coefficients 2"));
    s = settings(16, 16);
    s.aspect_ratio_code = 5;
    EXPECT_TRUE(says(level_refusal(s), "MPEG-2 has square ones"));
    EXPECT_EQ(level_refusal(settings(1920, 1080, 1, 1, 5)), "");
}

TEST(Syntax, RowsBeyond2800LinesCarryTheirUpperBits) {
    const auto bytes = [](int lines, int row) {
        BitWriter out;
        write_slice_header(out, lines, row, 21);
        out.align();
        return out.take();
    };
    EXPECT_EQ(bytes(1080, 67), (std::vector<std::uint8_t>{0, 0, 1, 68, 0b10101'0'00}));
    EXPECT_EQ(bytes(2800, 174), (std::vector<std::uint8_t>{0, 0, 1, 175, 0b10101'0'00}));
    EXPECT_EQ(bytes(2816, 130), (std::vector<std::uint8_t>{0, 0, 1, 3, 0b001'10101, 0b0'0000000}));
}

TEST(Vectors, FCodeIsTheSmallestThatReaches) {
    EXPECT_EQ(f_code_for(0, 0), 1);
    EXPECT_EQ(f_code_for(-16, 15), 1);
    EXPECT_EQ(f_code_for(-17, 0), 2);
    EXPECT_EQ(f_code_for(0, 16), 2);
    EXPECT_EQ(f_code_for(-256, 255), 5);
    EXPECT_EQ(f_code_for(0, 256), 6);
    EXPECT_EQ(f_code_for(0, 3808), 9);
}

TEST(Vectors, RangesKeepThePredictionInsideThePicture) {
    const VectorRange first = vector_range(0, 0, 10, 5, 8, 5), last = vector_range(9, 4, 10, 5, 8, 5),
                      far = vector_range(60, 40, 120, 72, 8, 5);
    EXPECT_EQ(first.clamp(-100, -100), (Vector{0, 0}));
    EXPECT_EQ(first.clamp(10000, 10000), (Vector{288, 128}));
    EXPECT_EQ(last.clamp(-10000, -10000), (Vector{-288, -128}));
    EXPECT_EQ(last.clamp(1, 1), (Vector{0, 0}));
    EXPECT_EQ(far.clamp(10000, 10000), (Vector{1888, 255}));
    EXPECT_EQ(far.clamp(-10000, -10000), (Vector{-1920, -256}));
}

}  // namespace
}  // namespace render2mpeg::encoder::mpeg2
