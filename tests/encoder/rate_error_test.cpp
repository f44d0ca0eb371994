#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "encoder/bit_allocation.h"
#include "film.h"
#include "rate_check.h"

/// How near films come to the rates they are asked for.
namespace render2mpeg::encoder::testing {
namespace {

enum class Content { calm, busy, changing };

/// Dim or loud grain on a texture that slides.
core::Picture content_picture(const Settings& s, Content content, std::int64_t n) {
    core::Picture picture = textured(s, n, {1.5, -0.5});
    const int loud = content == Content::calm ? 0 : content == Content::busy ? 64 : n / 30 % 2 == 0 ? 6 : 48;
    if (loud == 0) return picture;
    const core::Picture grain = noise(s.width, s.height, n, static_cast<std::uint64_t>(n));
    for (std::size_t i = 0; i < picture.y.size(); ++i)
        picture.y.values()[i] = static_cast<std::uint8_t>(
            std::clamp(picture.y.values()[i] + (grain.y.values()[i] - 128) * loud / 128, 0, 255));
    return picture;
}

struct Coding {
    Film film;
    std::vector<FirstPassPicture> pass;
    double bits = 0;
    double quantisers = 0, squares = 0;
};

/// Codes a film in chunks of 60 by an encoder each, or endlessly by one.
Coding coding_of(const Settings& s, Content content, std::int64_t count, bool endless = false,
                 const std::vector<BitAllocation>* allocated = nullptr) {
    Coding coding{{s, {}}, {}};
    const std::int64_t length = endless ? count : 60;
    for (std::int64_t first = 0; first < count; first += length) {
        const std::int64_t end = std::min(first + length, count);
        Encoder encoder(s);
        const auto take = [&](std::vector<CodedPicture> pictures) {
            for (CodedPicture& c : pictures) {
                coding.bits += 8.0 * static_cast<double>(c.bytes.size());
                coding.quantisers += c.quantiser;
                coding.squares += static_cast<double>(c.quantiser) * c.quantiser;
                coding.pass.push_back(first_pass_picture(s, c, c.plan.number == first));
                coding.film.coded.push_back(std::move(c));
            }
        };
        for (std::int64_t n = first; n < end; ++n) {
            PictureFacts facts;
            facts.frames_left = end - 1 - n;
            if (!endless) facts.left_in_chunk = end - 1 - n;
            facts.last_chunk = end == count;
            if (allocated) facts.allocation = (*allocated)[static_cast<std::size_t>(n)];
            const PicturePlan plan = encoder.plan(n, facts, n == first);
            take(encoder.push(content_picture(s, content, n), plan, steady_motion(s, plan, {-1.5f, 0.5f})));
        }
        take(encoder.flush());
    }
    return coding;
}

Coding code_twice(const Settings& s, Content content, std::int64_t count, int first_b_pictures = 2) {
    Settings first = s;
    first.b_pictures = first_b_pictures;
    first.effort = Effort::fast;
    first.rate_control = {};
    first.quantiser = 8;
    const std::vector<BitAllocation> allocated = allocate_bits(s, coding_of(first, content, count).pass, 1.0);
    return coding_of(s, content, count, false, &allocated);
}

double error_of(const Coding& coding) {
    const Settings& s = coding.film.settings;
    const double seconds = static_cast<double>(coding.film.coded.size()) / s.rate.hertz.value();
    return coding.bits / seconds / static_cast<double>(s.rate_control.bit_rate) - 1;
}

Settings film_settings(RateMode mode, double bits_per_sample) {
    Settings s = settings(96, 80, 6, 15, 3, 2);
    s.rate_control.mode = mode;
    s.rate_control.bit_rate = static_cast<std::int64_t>(bits_per_sample * 96 * 80 * 25);
    return s;
}

struct Wanted {
    RateMode mode;
    Content content;
    double bits_per_sample;
    std::int64_t count;
};

TEST(RateErrorsSlow, OfRatesThatQuantisersReachAreWithinTwoPerCentInTwoPassesAndFiveInOne) {
    for (const auto& [mode, content, bits, count] : {Wanted{RateMode::variable, Content::calm, 0.3, 65},
                                                     {RateMode::variable, Content::calm, 0.8, 65},
                                                     {RateMode::variable, Content::calm, 0.8, 33},
                                                     {RateMode::variable, Content::busy, 2, 65},
                                                     {RateMode::variable, Content::changing, 0.8, 120},
                                                     {RateMode::constant, Content::calm, 0.3, 33},
                                                     {RateMode::constant, Content::calm, 0.8, 65},
                                                     {RateMode::constant, Content::busy, 2, 33},
                                                     {RateMode::constant, Content::changing, 0.8, 65}}) {
        const Settings s = film_settings(mode, bits);
        const Coding one = coding_of(s, content, count), two = code_twice(s, content, count);
        const std::string name = std::to_string(static_cast<int>(mode)) + ", content " +
                                 std::to_string(static_cast<int>(content)) + ", bits " + std::to_string(bits);
        EXPECT_LT(std::abs(error_of(one)), 0.05) << name;
        EXPECT_LT(std::abs(error_of(two)), 0.02) << name;
        EXPECT_EQ(check_stream(read_stream(two.film.bytes()), mode == RateMode::constant), "") << name;
    }
}

TEST(RateErrorsSlow, PicturesMayBeOfOtherTypesInTheSecondPass) {
    for (const int now : {0, 3}) {
        Settings s = film_settings(RateMode::variable, 0.8);
        s.b_pictures = now;
        const double alike = code_twice(s, Content::calm, 60, now).quantisers;
        for (const int then : {0, 1, 3}) {
            const Coding two = code_twice(s, Content::calm, 60, then);
            EXPECT_LT(std::abs(error_of(two)), 0.02) << then << " then " << now;
            // Whole quantisers of 2 and 3 lie far apart.
            EXPECT_NEAR(two.quantisers, alike, 0.15 * alike) << then << " then " << now;
        }
    }
}

TEST(RateErrors, WhereNoQuantiserReachesTheRateTheLastOneIsTaken) {
    const std::int64_t count = 20;
    for (const bool twice : {false, true}) {
        const auto coded = [&](Content content, double bits) {
            const Settings s = film_settings(RateMode::variable, bits);
            return twice ? code_twice(s, content, count) : coding_of(s, content, count);
        };
        EXPECT_GT(coded(Content::busy, 0.3).quantisers, 30.5 * count) << twice;
        EXPECT_GT(coded(Content::calm, 0.12).quantisers, 30.5 * count) << twice;
        EXPECT_LT(coded(Content::calm, 8).quantisers, 1.1 * count) << twice;
    }
}

TEST(RateErrors, FirstPicturesDoNotStarveTheOthers) {
    // Sharp textures need several times the bits that are guessed of a film that nobody has seen.
    const Coding coding = coding_of(film_settings(RateMode::variable, 0.3), Content::calm, 20);
    const double mean = coding.quantisers / 20;
    EXPECT_GT(coding.film.coded[0].quantiser, 0.5 * mean);
    EXPECT_LT(coding.film.coded[0].quantiser, 1.5 * mean);
    EXPECT_GT(coding.film.coded[0].quantiser, coding.film.coded[0].plan.quantiser + 1);
    EXPECT_EQ(coding.film.coded[0].tries, 2);
}

TEST(RateErrorsSlow, OfEndlessFilmsAreWithinFivePerCentAndTheirBufferHolds) {
    for (const RateMode mode : {RateMode::variable, RateMode::constant}) {
        const Coding coding = coding_of(film_settings(mode, 0.8), Content::changing, 240, true);
        EXPECT_LT(std::abs(error_of(coding)), 0.05) << static_cast<int>(mode);
        const ReadStream stream = read_stream(coding.film.bytes());
        EXPECT_EQ(check_stream(stream, mode == RateMode::constant), "");
        EXPECT_EQ(check_reported(stream, coding.film.coded, {0}, declaration_of(coding.film.settings),
                                 mode == RateMode::constant),
                  "");
    }
}

}  // namespace
}  // namespace render2mpeg::encoder::testing
