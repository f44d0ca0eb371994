#include "encoder/bit_allocation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/error.h"
#include "encoder/mpeg2/bitstream/tuning.h"
#include "encoder/mpeg2/rate/rate_controller.h"
#include "encoder/mpeg2/rate/rate_model.h"
#include "film.h"

/// What a first pass tells the second one, and what that makes of it.
namespace render2mpeg::encoder::mpeg2 {
namespace {

using encoder::testing::settings;

constexpr PictureType I = PictureType::intra, P = PictureType::predicted, B = PictureType::bidirectional;

Settings rated(std::int64_t bit_rate, std::int64_t max_rate, std::int64_t buffer_bits) {
    Settings s = settings(96, 80, 6, 15, 3, 2);
    s.rate_control = {RateMode::variable, 60, bit_rate, max_rate, buffer_bits};
    return s;
}

std::vector<FirstPassPicture> short_film(const std::vector<std::int64_t>& numbers) {
    std::vector<FirstPassPicture> film;
    for (const std::int64_t number : numbers) {
        const std::size_t i = film.size();
        film.push_back({number, i == 0 ? I : i % 3 == 1 ? P : B, 6, 9000.0 - 700.0 * static_cast<double>(i), i == 0});
    }
    return film;
}

TEST(BitAllocation, GapsBetweenNumbersDoNotCount) {
    const Settings s = rated(200'000, 400'000, 0);
    const auto close = allocate_bits(s, short_film({10, 13, 11, 12, 16, 14, 15}), 1.0);
    const auto apart = allocate_bits(s, short_film({3, 90, 17, 20, 1'000'000, 91, 4000}), 1.0);
    ASSERT_EQ(close.size(), 7u);
    ASSERT_EQ(apart.size(), 7u);
    for (std::size_t i = 0; i < 7; ++i) {
        EXPECT_EQ(close[i].type, apart[i].type) << i;
        EXPECT_EQ(close[i].bits, apart[i].bits) << i;
        EXPECT_EQ(close[i].bits_left, apart[i].bits_left) << i;
    }
    // In display order: each has its own bits less to follow than the one before.
    for (std::size_t i = 1; i < 7; ++i)
        EXPECT_NEAR(apart[i].bits_left, apart[i - 1].bits_left - apart[i - 1].bits, 1e-6) << i;
    EXPECT_TRUE(allocate_bits(s, {}, 1.0).empty());
}

TEST(BitAllocation, WhatNoFirstPassCanFindIsRefused) {
    const Settings s = rated(200'000, 400'000, 0);
    const double nan = std::nan(""), infinite = std::numeric_limits<double>::infinity();
    const auto refused = [&](auto&& change, double scale = 1.0) {
        std::vector<FirstPassPicture> film = short_film({0, 3, 1, 2});
        change(film[1]);
        EXPECT_THROW(allocate_bits(s, film, scale), core::ContractViolation);
    };
    for (const int quantiser : {0, -3, 32}) refused([&](FirstPassPicture& p) { p.quantiser = quantiser; });
    for (const double wrong : {nan, infinite, -1.0, 0.0}) {
        refused([&](FirstPassPicture& p) { p.bits = wrong; });
        refused([&](FirstPassPicture& p) { p.ratio = wrong; });
        refused([](FirstPassPicture&) {}, wrong);
    }
    refused([](FirstPassPicture& p) { p.number = 2; });
    refused([](FirstPassPicture& p) { p.number = -1; });
    refused([](FirstPassPicture& p) { p.type = static_cast<PictureType>(4); });
    EXPECT_NO_THROW(allocate_bits(s, short_film({0, 3, 1, 2}), 1.0));
}

TEST(BitAllocation, AStretchThatNothingHelpsLeavesHelpToTheNext) {
    // One picture that no quantiser makes fit, a calm while that fills the buffer, and a stretch that is too much for
    // the buffer at the film's quantiser though not at 31.
    const Settings s = rated(400'000, 500'000, 163'840);
    std::vector<FirstPassPicture> film;
    for (std::int64_t n = 0; n < 60; ++n)
        film.push_back({n, n == 0 ? I : P, 4, n == 5 ? 1.6e6 : n >= 40 && n < 50 ? 120'000.0 : 1500.0, n == 0, 1.0});
    const auto with = allocate_bits(s, film, 1.0);
    EXPECT_EQ(with[5].quantiser, 31);
    double loud = 0;
    for (std::size_t n = 40; n < 50; ++n) {
        EXPECT_NEAR(with[n].quantiser, with[40].quantiser, 0.01) << n;
        loud += with[n].bits;
    }
    EXPECT_GT(with[40].quantiser, 10 * with[30].quantiser);
    EXPECT_LT(with[40].quantiser, 30);
    // All that the buffer holds but for the tenth that is left alone, and what comes before the last of them.
    EXPECT_NEAR(loud, 0.9 * 163'840 + 9 * 500'000 / 25.0, 200);
}

TEST(QuantiserRatio, FallsWithFollowersAsFarAsTheMostThatCount) {
    for (std::int64_t n = 1; n <= most_followers; ++n) EXPECT_LT(quantiser_ratio(P, n), quantiser_ratio(P, n - 1)) << n;
    for (const std::int64_t n : {most_followers + 1, most_followers + 35, std::int64_t{100'000}})
        EXPECT_EQ(quantiser_ratio(I, n), quantiser_ratio(I, most_followers)) << n;
    EXPECT_NEAR(quantiser_ratio(I, 60), 0.773, 0.001);
    EXPECT_EQ(quantiser_ratio(P, 0), 1.0);
}

/// A picture of 10,000 bits at quantiser 16, and 90,000 more of the types that are told.
BitAllocation allocated(PictureType then, std::array<double, 3> rest = {0, 90'000, 0}) {
    rest[static_cast<std::size_t>(then) - 1] += 10'000;
    return {16, 10'000, 100'000, then, 1, 1.0, rest};
}

TEST(PassModel, ExcessIsOfTheTypeThatThePicturesHadThen) {
    PassModel model;
    model.learn(P, allocated(P), 16, 10'000);
    model.learn(P, allocated(B), 16, 25'000);
    model.learn(B, allocated(B), 16, 15'000);
    EXPECT_NEAR(model.excess(P), 1.0, 1e-9);
    EXPECT_GT(model.excess(B), 1.9);
    EXPECT_LT(model.excess(B), 2.1);
    // One picture is expected by what became of its like: both types count.
    EXPECT_NEAR(model.bits(P, allocated(P), 16), 10'000, 1);
    EXPECT_NEAR(model.bits(P, allocated(B), 16), 25'000, 1);
    EXPECT_NEAR(model.bits(B, allocated(B), 16), 15'000, 1);
}

/// Steers through pictures that follow one another without B pictures between them, as a chunk of 20.
class Steered {
  public:
    /// The quantiser planned for the next picture.
    int plan(PictureType type, const BitAllocation& allocation, std::int64_t followers = 0) {
        plan_ = {next_, type, next_ == 0, {}, next_ + followers, 4};
        const PictureFacts facts{.left_in_chunk = 19 - next_, .last_chunk = true, .allocation = allocation};
        schedule_.plan(next_, next_ == 0, next_ == 0, facts.left_in_chunk, true);
        return quantiser_ = rate_.plan(plan_, facts, next_++ == 0, schedule_);
    }
    /// What it came to at quantiser 16.
    void record(std::int64_t bits) {
        rate_.record(plan_, 16, bits, bits);
        schedule_.take(bits, 0);
    }

  private:
    Settings settings_ = rated(400'000, 4'000'000, 0);
    Channel channel_ = channel_for(settings_, level_for(settings_));
    MinimalBits minimal_ = minimal_bits(settings_, level_for(settings_));
    VbvSchedule schedule_{settings_, channel_, minimal_};
    RateController rate_{settings_, channel_, minimal_};
    PicturePlan plan_;
    std::int64_t next_ = 0;
    int quantiser_ = 0;
};

/// After pictures that were B pictures and now are P pictures of twice the bits.
Steered after_changed_types() {
    Steered steered;
    steered.plan(I, {16, 10'000, 200'000, I, 1, 1.0, {10'000, 95'000, 95'000}});
    steered.record(10'000);
    for (int i = 0; i < 4; ++i) {
        steered.plan(P, allocated(P));
        steered.record(10'000);
        steered.plan(P, allocated(B));
        steered.record(20'000);
    }
    return steered;
}

TEST(RateController, WhatIsToComeIsCorrectedByItsTypesInTheFirstPass) {
    const int calm = after_changed_types().plan(P, allocated(P, {0, 90'000, 0}));
    const int grown = after_changed_types().plan(P, allocated(P, {0, 0, 90'000}));
    EXPECT_GE(grown, calm + 4);
    // So is the picture itself.
    const int own_calm = after_changed_types().plan(P, allocated(P, {0, 30'000, 0}));
    const int own_grown = after_changed_types().plan(P, allocated(B, {0, 30'000, 0}));
    EXPECT_GE(own_grown, own_calm + 1);
}

TEST(RateController, TheQuantiserFollowsWhatFollowsFromThePicture) {
    const auto planned = [](std::optional<double> ratio) {
        BitAllocation allocation{16, 10'000, 200'000, I, 1, ratio, {10'000, 190'000, 0}};
        return Steered().plan(I, allocation, most_followers);
    };
    const double ratio = quantiser_ratio(I, most_followers);
    EXPECT_EQ(planned(ratio), 16);
    EXPECT_EQ(planned(1.0), 12);
    EXPECT_EQ(planned(ratio / 1.5), 24);
    EXPECT_EQ(planned({}), std::lround(16 * ratio / usual_quantiser_ratio(I, 15)));
}

}  // namespace
}  // namespace render2mpeg::encoder::mpeg2
