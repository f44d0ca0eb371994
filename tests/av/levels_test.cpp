#include "encoder/av/levels.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/error.h"
#include "encoder/av/access_unit.h"
#include "encoder/av/coders.h"
#include "encoder/codec.h"

/// Levels that films of libraries' codecs declare.
namespace render2mpeg::test {
namespace {

encoder::Settings film_of(encoder::Codec codec, int width, int height, const std::string& rate, int level = 0) {
    encoder::Settings settings;
    settings.codec = codec;
    settings.width = width;
    settings.height = height;
    settings.rate = core::frame_rate_from(rate);
    settings.level = level;
    return settings;
}

struct Declared {
    int width, height;
    const char* rate;
    int level, references;
};

TEST(Levels, OfH264AreTheLowestAndHaveTheReferencesTheyHold) {
    // [H264, table A-1]
    for (const Declared& d :
         {Declared{176, 144, "25", 11, 5}, Declared{720, 576, "25", 30, 5}, Declared{1280, 720, "30", 31, 5},
          Declared{1280, 720, "60", 32, 5}, Declared{1920, 1080, "24", 40, 4}, Declared{1920, 1080, "30", 40, 4},
          Declared{1920, 1080, "60", 42, 4}, Declared{3840, 2160, "30", 51, 5}, Declared{3840, 2160, "60", 52, 5}}) {
        const encoder::Settings s = film_of(encoder::Codec::h264, d.width, d.height, d.rate);
        EXPECT_EQ(av::level_for(s), d.level) << d.width << "x" << d.height << " at " << d.rate;
        EXPECT_EQ(av::references_for(s), d.references) << d.width << "x" << d.height << " at " << d.rate;
    }
    encoder::Settings fast = film_of(encoder::Codec::h264, 1920, 1080, "25");
    fast.rate_control.bit_rate = 30'000'000;
    EXPECT_EQ(av::level_for(fast), 41) << "4.0 has 25 Mb/s in High profile";
}

TEST(Levels, OfHevcAndAv1HoldTheirSamples) {
    EXPECT_EQ(av::level_for(film_of(encoder::Codec::hevc, 1920, 1080, "30")), 40);
    EXPECT_EQ(av::level_for(film_of(encoder::Codec::hevc, 3840, 2160, "60")), 51);
    EXPECT_EQ(av::level_for(film_of(encoder::Codec::av1, 1920, 1080, "30")), 40);
    EXPECT_EQ(av::level_for(film_of(encoder::Codec::av1, 3840, 2160, "30")), 50);
    EXPECT_EQ(av::level_for(film_of(encoder::Codec::mpeg2, 1920, 1080, "30")), 0);
}

TEST(Levels, AreRefusedWhereTheyHoldLess) {
    const auto refusal = [](int level) {
        try {
            av::level_for(film_of(encoder::Codec::h264, 1920, 1080, "30", level));
        } catch (const core::Error& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_EQ(refusal(40), "");
    EXPECT_EQ(refusal(52), "");
    EXPECT_EQ(refusal(31), "level 3.1: 1920x1080 at 30 Hz is more than this level of H.264 holds; 4.0 does");
    EXPECT_EQ(refusal(43), "level 4.3: H.264 has levels from 1.0 to 6.2, this is none of them");
}

/// level_idc of a stream's sequence parameter set, behind its start code, type, profile and constraints.
/// [H264, 7.3.2.1]
int declared_in(const std::vector<std::uint8_t>& headers) {
    return headers.size() > 7 && headers[4] % 32 == 7 ? headers[7] : -1;
}

TEST(Levels, AreDeclaredInTheStream) {
    for (const int level : {0, 41}) {
        encoder::Settings s = film_of(encoder::Codec::h264, 96, 80, "25", level);
        s.effort = encoder::Effort::fast;
        s.b_pictures = 0;
        try {
            av::check(s);
        } catch (const core::Error&) {
            GTEST_SKIP() << "this machine has no libx264";
        }
        const auto coder = av::make_coder(s);
        core::Picture picture;
        picture.y = core::Plane<std::uint8_t>(96, 80, 90);
        picture.cb = picture.cr = core::Plane<std::uint8_t>(48, 40, 128);
        std::vector<encoder::CodedPicture> coded = coder->push(picture, coder->plan(0, {}, true), {});
        for (encoder::CodedPicture& more : coder->flush()) coded.push_back(std::move(more));
        ASSERT_EQ(coded.size(), 1u);
        const std::vector<std::uint8_t> headers = av::taken_apart(s.codec, coded[0].bytes).headers;
        EXPECT_EQ(declared_in(headers), level == 0 ? av::level_for(s) : level);
    }
}

TEST(AccessUnits, OfMastersCarryTheirContainersHeaders) {
    const std::vector<std::uint8_t> headers{1, 2, 3}, picture{4, 5};
    const av::AccessUnit unit = av::taken_apart(encoder::Codec::ffv1, av::put_together(headers, picture));
    EXPECT_EQ(unit.headers, headers);
    EXPECT_EQ(unit.pictures, picture);
    EXPECT_THROW(av::taken_apart(encoder::Codec::ffv1, std::vector<std::uint8_t>{0, 0, 0, 3, 1}), core::Error);
    EXPECT_THROW(av::taken_apart(encoder::Codec::ffv1, std::vector<std::uint8_t>{0, 0}), core::Error);
}

}  // namespace
}  // namespace render2mpeg::test
