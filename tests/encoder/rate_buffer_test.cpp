#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "core/error.h"
#include "encoder/mpeg2/rate/vbv_buffer.h"
#include "encoder/mpeg2/rate/vbv_schedule.h"
#include "film.h"

/// The buffer's arithmetic and what is demanded of future pictures, in closed form.
namespace render2mpeg::encoder::mpeg2 {
namespace {

using testing::settings;

Settings buffered(RateMode mode, std::int64_t bit_rate, std::int64_t max_rate = 0, std::int64_t buffer = 0,
                  int rate_code = 3) {
    Settings s = settings(64, 64, 4, 5, rate_code, 2);
    s.rate_control = {mode, 60, bit_rate, max_rate, buffer};
    return s;
}

VbvBuffer buffer_of(const Settings& s) {
    return {s, channel_for(s, level_for(s))};
}

TEST(RateBuffer, AVariableRateFillsItUpAndNoFurther) {
    VbvBuffer b = buffer_of(buffered(RateMode::variable, 1'000'000, 5'000'000, 327'680));  // 200,000 bits per picture
    EXPECT_EQ(b.whole_bits(b.capacity()), 327'680);
    EXPECT_EQ(b.whole_bits(b.fullness()), 262'144);  // four fifths
    EXPECT_EQ(b.take(262'144, 2), 0);
    EXPECT_EQ(b.whole_bits(b.fullness()), 200'000);
    EXPECT_EQ(b.take(200, 2), 0);
    EXPECT_EQ(b.whole_bits(b.fullness()), 327'680);
    EXPECT_THROW(b.take(327'681, 2), core::ContractViolation);
}

TEST(RateBuffer, AConstantRateAsksForTheFewestBytesThatKeepItFromRunningOver) {
    const Settings s = buffered(RateMode::constant, 5'000'000, 0, 327'680);
    VbvBuffer b = buffer_of(s);
    const std::int64_t capacity = b.whole_bits(b.capacity());
    EXPECT_EQ(capacity, 327'680 - 5'000'000 / 90'000 - 16);
    // 262,043 bits are there at first, 200,000 come; what is more than the capacity must go with the picture.
    const std::int64_t start = b.whole_bits(b.fullness()), over = start + 200'000 - capacity;
    EXPECT_EQ(b.take(0, 2), (over + 7) / 8);
    EXPECT_LE(b.fullness(), b.capacity());
    EXPECT_GT(b.fullness(), b.capacity() - b.fractions(8));
    EXPECT_EQ(b.take(200'000, 2), 0);
}

TEST(RateBuffer, DelaysAreThoseOfTheBitsThatAreThere) {
    const Settings s = buffered(RateMode::constant, 9'000'000, 0, 1'638'400);  // 100 bits per tick of 90 kHz
    VbvBuffer b = buffer_of(s);
    const std::int64_t bits = b.whole_bits(b.fullness());
    EXPECT_EQ(b.delay(0), (bits + 99) / 100);
    EXPECT_EQ(b.delay(bits), 0);
    EXPECT_EQ(b.delay(bits - 1), 1);  // rounded up
    // No delay ever reaches the value that means a variable rate, however large the buffer.
    const Settings slow = buffered(RateMode::constant, 400'000, 0, 1'835'008);
    const VbvBuffer large = buffer_of(slow);
    EXPECT_LE(large.whole_bits(large.capacity()), 65'534ll * 400'000 / 90'000);
    EXPECT_GE(large.whole_bits(large.capacity()), 65'533ll * 400'000 / 90'000);
}

TEST(RateBuffer, ChunksOfAConstantRateAreWholeBytesApart) {
    for (const int code : {1, 3, 4, 7}) {
        const Settings s = buffered(RateMode::constant, 1'234'400, 0, 0, code);
        VbvBuffer b = buffer_of(s);
        for (const std::int64_t first : {0, 1, 60, 1'000'000'007}) {
            b.start_chunk(first);
            const std::int64_t next = first + 37;
            std::int64_t bytes = 0;
            for (std::int64_t n = first; n < next; ++n) {
                // Half of what comes in; the last picture makes up for it.
                const std::int64_t bits = b.whole_bits(b.arrivals(2)) / 16 * 8;
                bytes += bits / 8 + b.take(bits, 2, n + 1 == next ? &next : nullptr);
            }
            EXPECT_EQ(b.fullness(), b.chunk_fullness(next));
            const double hertz = s.rate.hertz.value();
            EXPECT_NEAR(static_cast<double>(bytes), 37 / hertz * 1'234'400 / 8, 1.0);
        }
    }
}

TEST(RateSchedule, ALastPictureMayTakeAllThatTheNextChunkDoesNotNeed) {
    Settings s = buffered(RateMode::variable, 100'000, 100'000, 163'840);  // 4,000 bits per picture
    const MinimalBits minimal{1'600, 400};
    VbvSchedule schedule(s, channel_for(s, level_for(s)), minimal);
    for (std::int64_t n = 0; n < 5; ++n) schedule.plan(n, n == 0, n == 0, 4 - n, false);
    // 131,072 bits at both ends, 20,000 come in meanwhile, the other four need at least 1,600.
    EXPECT_EQ(schedule.most_bits(), 20'000 - 4 * 400);
    schedule.take(10'000, 400);
    EXPECT_EQ(schedule.most_bits(), 10'000 - 3 * 400);
    for (int i = 0; i < 3; ++i) schedule.take(400, 64);
    EXPECT_EQ(schedule.most_bits(), 8'800);
    const Removal last = schedule.take(8'800, 64);
    EXPECT_EQ(last.fullness_next, 131'072);
    EXPECT_EQ(last.delay, 0xffff);
}

TEST(RateSchedule, TheFilmsLastChunkMayEmptyTheBuffer) {
    Settings s = buffered(RateMode::variable, 100'000, 100'000, 163'840);
    VbvSchedule schedule(s, channel_for(s, level_for(s)), {1'600, 400});
    for (std::int64_t n = 0; n < 2; ++n) schedule.plan(n, n == 0, n == 0, 1 - n, true);
    EXPECT_EQ(schedule.most_bits(), 131'072);  // 4,000 come before the other picture: enough
    schedule.take(131'072, 400);
    EXPECT_EQ(schedule.most_bits(), 4'000);
}

TEST(RateSchedule, ACutBeginsNoGopThatCannotBePaid) {
    Settings s = buffered(RateMode::variable, 10'000, 10'000, 163'840);  // 400 bits per picture
    s.gop = 12;
    VbvSchedule schedule(s, channel_for(s, level_for(s)), {3'000, 100});
    schedule.plan(0, true, true, 11, false);
    EXPECT_FALSE(schedule.affords_gop(1)) << "6,000 bits of 12 pictures' 4,800";
    VbvSchedule rich(s, channel_for(s, level_for(s)), {1'500, 100});
    rich.plan(0, true, true, 11, false);
    EXPECT_TRUE(rich.affords_gop(1)) << "3,000 and 1,000 of 4,800";
}

/// Bits that a picture may have, reckoned picture by picture from the chunk's end. `first` begins a GOP, and is next.
std::int64_t most_bits_one_by_one(const Settings& s, const MinimalBits& minimal, std::int64_t first, std::int64_t end) {
    const VbvBuffer buffer = buffer_of(s);
    std::int64_t need = buffer.chunk_fullness(end);
    for (std::int64_t n = end - 1; n > first; --n) {
        need = std::max<std::int64_t>(0, need - buffer.arrivals(fields_after(s, n - s.first_number)));
        need += buffer.fractions((n - first) % s.gop == 0 ? minimal.intra : minimal.other);
    }
    const std::int64_t keep =
        std::max<std::int64_t>(0, need - buffer.arrivals(fields_after(s, first - s.first_number)));
    return buffer.whole_bits(std::max<std::int64_t>(0, buffer.chunk_fullness(first) - keep)) / 8 * 8;
}

TEST(RateSchedule, WhatIsFarAwayIsReckonedAsIfOneByOne) {
    int bound = 0;
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
        const auto pick = [&](std::uint64_t what, int low, int high) {
            return low + static_cast<int>(core::uniform(seed, what, 0, 0) * (high - low + 0.999));
        };
        Settings s = buffered(RateMode::variable, 100'000, 100'000, 16'384 * pick(0, 1, 8), pick(1, 1, 2));
        s.cadence = pick(2, 0, 1) == 0 ? Cadence::frames : Cadence::pulldown;
        s.gop = pick(3, 1, 9);
        s.first_number = pick(4, 0, 3);
        // Pictures of about what comes in, so that ends far away are felt; with detail left out GOPs are just payable.
        const MinimalBits minimal{pick(5, 3'800, 5'000), pick(6, 3'500, 4'100)};
        const std::int64_t first = s.first_number + pick(7, 0, 20), end = first + pick(8, 1, 400);
        VbvSchedule schedule(s, channel_for(s, level_for(s)), minimal);
        schedule.plan(first, true, true, end - 1 - first, false);
        if (!schedule.feasible()) continue;
        const std::int64_t wanted = most_bits_one_by_one(s, minimal, first, end);
        EXPECT_EQ(schedule.most_bits(), wanted) << "seed " << seed;
        bound += wanted < schedule.fullness() / 8 * 8 ? 1 : 0;
    }
    EXPECT_GT(bound, 60) << "the end must be felt";
}

std::string refusal(const Settings& s) {
    try {
        check(s);
    } catch (const core::Error& e) {
        return e.what();
    }
    return "";
}

TEST(RateChecks, WhatCannotBeIsRefusedByOneLineThatSaysWhy) {
    const auto says = [](const Settings& s, const std::string& part) {
        return refusal(s).find(part) != std::string::npos;
    };
    EXPECT_EQ(refusal(buffered(RateMode::variable, 1'000'000)), "");
    EXPECT_EQ(refusal(buffered(RateMode::constant, 1'000'000)), "");
    EXPECT_TRUE(says(buffered(RateMode::variable, 0), "at least 400"));
    EXPECT_TRUE(says(buffered(RateMode::variable, 90'000'000), "at most 80000000"));
    EXPECT_TRUE(says(buffered(RateMode::variable, 2'000'000, 1'000'000), "is below the bit rate 2000000"));
    EXPECT_TRUE(says(buffered(RateMode::constant, 1'000'000, 2'000'000), "must be equal"));
    EXPECT_TRUE(says(buffered(RateMode::variable, 1'000'000, 0, 16'000), "at least 16384"));
    EXPECT_TRUE(says(buffered(RateMode::variable, 1'000'000, 0, 20'000'000), "at most 9781248"));
    EXPECT_TRUE(says(buffered(RateMode::variable, 3'000, 3'000), "even pictures without detail need"));
    EXPECT_TRUE(says(buffered(RateMode::constant, 5'000'000, 0, 180'224), "arrive while a picture is shown"));
}

TEST(RateChecks, TheLevelIsTheLowestThatBringsAndHoldsTheBits) {
    const auto level = [](const Settings& s) { return std::string(level_for(s).name); };
    EXPECT_EQ(level(buffered(RateMode::variable, 15'000'000)), "Main");
    EXPECT_EQ(level(buffered(RateMode::variable, 15'000'001)), "High-1440");
    EXPECT_EQ(level(buffered(RateMode::variable, 1'000'000, 60'000'400)), "High");
    EXPECT_EQ(level(buffered(RateMode::variable, 1'000'000, 0, 1'835'009)), "High-1440");
    const Declaration d = declaration_of(buffered(RateMode::variable, 1'000'000, 1'500'399, 100'000));
    EXPECT_EQ(d.bit_rate, 1'500'000) << "rounded down: a decoder must not count on more";
    EXPECT_EQ(d.buffer_bits, 98'304);
}

}  // namespace
}  // namespace render2mpeg::encoder::mpeg2
