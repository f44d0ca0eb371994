#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <limits>
#include <string>
#include <vector>

#include "core/error.h"
#include "film.h"
#include "parallel/loops.h"

/// What the encoder promises across chunks, and what it refuses.
namespace render2mpeg::encoder::testing {
namespace {

struct Span {
    std::int64_t first, length;
    bool last = false;  ///< of the film
};

/// A film whose pictures are harder or easier from one chunk to the next.
core::Picture picture_of(const Settings& s, std::int64_t n) {
    core::Picture picture = textured(s, n, {1.5, -0.5});
    if (n % 12 < 6) return picture;
    const core::Picture grain = noise(s.width, s.height, n, static_cast<std::uint64_t>(n));
    for (std::size_t i = 0; i < picture.y.size(); ++i)
        picture.y.values()[i] = static_cast<std::uint8_t>((3 * picture.y.values()[i] + grain.y.values()[i]) / 4);
    return picture;
}

/// Codes chunks with one encoder, planning `lead` pictures ahead of the one that is pushed, over borders too.
std::vector<std::vector<std::uint8_t>> code(const Settings& s, const std::vector<Span>& chunks, std::size_t lead) {
    struct Due {
        std::int64_t number;
        PictureFacts facts;
        bool first;
    };
    std::vector<Due> film;
    for (const Span& chunk : chunks)
        for (std::int64_t i = 0; i < chunk.length; ++i) {
            PictureFacts facts;
            facts.frames_left = facts.left_in_chunk.emplace(chunk.length - 1 - i);
            facts.last_chunk = chunk.last;
            film.push_back({chunk.first + i, facts, i == 0});
        }

    Encoder encoder(s);
    std::deque<PicturePlan> plans;
    std::vector<std::vector<std::uint8_t>> bytes;
    const auto keep = [&](std::vector<CodedPicture> pictures) {
        for (CodedPicture& p : pictures) bytes.push_back(std::move(p.bytes));
    };
    std::size_t planned = 0;
    for (std::size_t i = 0; i < film.size(); ++i) {
        for (; planned < std::min(film.size(), i + 1 + lead); ++planned)
            plans.push_back(encoder.plan(film[planned].number, film[planned].facts, film[planned].first));
        keep(
            encoder.push(picture_of(s, film[i].number), plans.front(), steady_motion(s, plans.front(), {-1.5f, 0.5f})));
        plans.pop_front();
    }
    keep(encoder.flush());
    return bytes;
}

Settings chunk_settings(RateMode mode, std::int64_t first_number = 0) {
    Settings s = settings(80, 64, 6, 6, 3, 2);
    s.rate_control.mode = mode;
    s.rate_control.quality = 70;
    s.first_number = first_number;
    if (mode == RateMode::variable || mode == RateMode::constant) s.rate_control.bit_rate = 300'000;
    if (mode == RateMode::variable) s.rate_control.max_rate = 450'000;
    s.rate_control.buffer_bits = 98'304;
    return s;
}

constexpr RateMode all_modes[] = {RateMode::constant_quantiser, RateMode::constant_quality, RateMode::variable,
                                  RateMode::constant};

TEST(Chunks, BytesAreAFunctionOfTheChunkInEveryMode) {
    const std::vector<Span> chunks = {{0, 12}, {12, 6}, {18, 12}, {30, 5, true}};
    for (const RateMode mode : all_modes)
        for (const std::size_t lead : {0, 5}) {
            const Settings s = chunk_settings(mode);
            std::vector<std::vector<std::uint8_t>> apart;
            for (const Span& chunk : chunks)
                for (auto& bytes : code(s, {chunk}, lead)) apart.push_back(std::move(bytes));
            EXPECT_EQ(code(s, chunks, lead), apart) << static_cast<int>(mode) << ", lead " << lead;
        }
}

TEST(Chunks, TheNumberOfThreadsDoesNotShowInAnyMode) {
    for (const RateMode mode : all_modes) {
        const auto run = [&](int threads) {
            const parallel::ThreadLimit limit(threads);
            return code(chunk_settings(mode), {{0, 12}, {12, 7, true}}, 3);
        };
        const auto one = run(1);
        EXPECT_EQ(one, run(3)) << static_cast<int>(mode);
    }
}

TEST(Chunks, AChunkBeyondAGapBeginsAsIfItWereTheFirst) {
    for (const RateMode mode : all_modes)
        for (const Span& second : {Span{24, 6}, Span{6, 6}}) {
            const Settings s = chunk_settings(mode);
            std::vector<std::vector<std::uint8_t>> both = code(s, {{12, 6}, second}, 0);
            both.erase(both.begin(), both.begin() + 6);
            EXPECT_EQ(both, code(s, {second}, 0)) << static_cast<int>(mode) << ", chunk from " << second.first;
        }
}

PictureFacts left(std::int64_t n) {
    return {.frames_left = n, .left_in_chunk = n};
}

TEST(Contracts, NoGapIsPlannedWhilePicturesAreInFlight) {
    Encoder encoder(chunk_settings(RateMode::variable));
    encoder.plan(0, left(0), true);
    EXPECT_THROW(encoder.plan(7, left(0), true), core::ContractViolation);
}

TEST(Contracts, APlannedPictureMustNotBeSkippedOrChanged) {
    const Settings s = chunk_settings(RateMode::constant_quantiser);
    Encoder encoder(s);
    std::vector<PicturePlan> plans;
    for (std::int64_t n = 0; n < 4; ++n) plans.push_back(encoder.plan(n, left(3 - n), n == 0));
    ASSERT_EQ(plans[2].type, PictureType::bidirectional);
    encoder.push(picture_of(s, 0), plans[0], {});
    EXPECT_THROW(encoder.push(picture_of(s, 2), plans[2], {}), core::ContractViolation) << "1 was planned";
    EXPECT_THROW(encoder.push(picture_of(s, 0), plans[0], {}), core::ContractViolation) << "0 was there already";
    PicturePlan changed = plans[1];
    changed.quantiser = 3;
    EXPECT_THROW(encoder.push(picture_of(s, 1), changed, {}), core::ContractViolation);
    for (int n = 1; n < 4; ++n)
        EXPECT_EQ(encoder.push(picture_of(s, n), plans[static_cast<std::size_t>(n)], {}).size(), n == 3 ? 3u : 0u);
}

TEST(Contracts, AChunkIsAsLongAsItWasPromised) {
    const auto start = [] {
        auto encoder = std::make_unique<Encoder>(chunk_settings(RateMode::variable));
        encoder->plan(0, left(1), true);
        return encoder;
    };
    EXPECT_THROW(start()->plan(1, left(1), true), core::ContractViolation) << "the next chunk came too early";
    EXPECT_THROW(start()->plan(1, left(5), false), core::ContractViolation) << "it grew";
    auto encoder = start();
    encoder->plan(1, left(0), false);
    EXPECT_THROW(encoder->plan(2, left(0), false), core::ContractViolation) << "it did not end";
    EXPECT_NO_THROW(encoder->plan(2, left(0), true));
}

TEST(Contracts, FactsAreNumbersWithinTheirRanges) {
    const double nan = std::nan(""), infinite = std::numeric_limits<double>::infinity();
    const auto refused = [](const PictureFacts& facts) {
        Encoder encoder(chunk_settings(RateMode::variable));
        EXPECT_THROW(encoder.plan(0, facts, true), core::ContractViolation);
    };
    for (const double wrong : {nan, infinite, -0.1}) {
        refused({.quality_factor = wrong});
        refused({.allocation = BitAllocation{4, wrong, 100}});
        refused({.allocation = BitAllocation{4, 100, wrong}});
        refused({.allocation = BitAllocation{wrong, 100, 1000}});
        refused({.allocation = BitAllocation{4, 100, 1000, {}, wrong}});
        refused({.allocation = BitAllocation{4, 100, 1000, {}, 1, wrong}});
        for (std::size_t i = 0; i < 3; ++i) {
            BitAllocation allocation{4, 100, 1000};
            allocation.left_by_type[i] = wrong;
            refused({.allocation = allocation});
        }
    }
    refused({.allocation = BitAllocation{4, 100, 1000, {}, 1, 0.0}});
    refused({.allocation = BitAllocation{4, 100, 1000, static_cast<PictureType>(0)}});
    refused({.allocation = BitAllocation{4, 100, 1000, static_cast<PictureType>(4)}});
    refused({.allocation = BitAllocation{32, 100, 1000}});
    refused({.frames_left = -1});
    refused({.left_in_chunk = -1});
    refused({.left_in_chunk = std::numeric_limits<std::int64_t>::max()});
}

TEST(Contracts, AFilmThatEndsEarlyTakesWhatWasPlannedWithIt) {
    const Settings s = chunk_settings(RateMode::variable);
    Encoder encoder(s);
    std::vector<PicturePlan> plans;
    for (std::int64_t n = 0; n < 5; ++n) plans.push_back(encoder.plan(n, left(11 - n), n == 0));
    encoder.push(picture_of(s, 0), plans[0], {});
    encoder.push(picture_of(s, 1), plans[1], {});
    EXPECT_EQ(encoder.flush().size(), 1u);
    EXPECT_THROW(encoder.push(picture_of(s, 2), plans[2], {}), core::ContractViolation);
    EXPECT_THROW(encoder.plan(5, left(6), false), core::ContractViolation);
    EXPECT_NO_THROW(encoder.plan(40, left(6), true));
}

TEST(Contracts, AFilmThatEndsBeforeItsPromiseGoesOnWithAChunkAlone) {
    Settings s = chunk_settings(RateMode::variable);
    s.b_pictures = 0;  // nothing waits when it ends
    for (const bool one_is_planned : {false, true}) {
        Encoder encoder(s);
        encoder.push(picture_of(s, 0), encoder.plan(0, left(5), true), {});
        PicturePlan second;
        if (one_is_planned) second = encoder.plan(1, left(4), false);
        EXPECT_TRUE(encoder.flush().empty());
        if (one_is_planned) {
            EXPECT_THROW(encoder.push(picture_of(s, 1), second, {}), core::ContractViolation) << "it was forgotten";
        }
        const std::int64_t next = one_is_planned ? 2 : 1;
        EXPECT_THROW(encoder.plan(next, left(4), false), core::ContractViolation);
        EXPECT_TRUE(encoder.plan(next, left(3), true).starts_gop);
    }
    // What was promised is there: the next chunk follows as ever.
    Encoder encoder(s);
    encoder.push(picture_of(s, 0), encoder.plan(0, left(0), true), {});
    EXPECT_TRUE(encoder.flush().empty());
    EXPECT_NO_THROW(encoder.plan(1, left(3), true));
}

std::string border_refusal(const Settings& s) {
    try {
        check(s);
    } catch (const core::Error& e) {
        return e.what();
    }
    return "";
}

/// Whether a chunk of `gops` whole GOPs from `first` on can be planned.
bool can_be_planned(const Settings& s, std::int64_t first, int gops) {
    Encoder encoder(s);
    try {
        encoder.plan(first, left(static_cast<std::int64_t>(gops) * s.gop - 1), true);
        return true;
    } catch (const core::Error&) {
        return false;
    }
}

TEST(Checks, WhatCheckAcceptsCanBePlannedChunkByChunk) {
    // Near the lowest rate that is accepted, at every phase of the pulldown.
    int close = 0;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        const auto pick = [&](std::uint64_t what, int low, int high) {
            return low + static_cast<int>(core::uniform(seed, what, 0, 0) * (high - low + 0.999));
        };
        Settings s = settings(pick(1, 1, 200), pick(2, 1, 120), 4, pick(3, 1, 7), pick(4, 1, 8), pick(5, 0, 3));
        if (s.rate.code <= 2 && pick(6, 0, 1) == 1) s.cadence = Cadence::pulldown;
        s.rate_control.mode = pick(7, 0, 1) == 0 ? RateMode::variable : RateMode::constant;
        if (pick(8, 0, 1) == 1) s.rate_control.buffer_bits = 16'384 * pick(9, 1, 4);

        // Close in on the limit to the bit.
        std::int64_t low = 400, high = 80'000'000;
        const auto at = [&](std::int64_t rate) {
            s.rate_control.bit_rate = rate;
            if (s.rate_control.mode == RateMode::variable) s.rate_control.max_rate = rate;
            return border_refusal(s).empty();
        };
        // A small buffer may also forbid high rates: look for any that is taken first.
        while (high > low && !at(high)) high /= 2;
        if (!at(high)) continue;
        while (high - low > 1) {
            const std::int64_t middle = (low + high) / 2;
            (at(middle) ? high : low) = middle;
        }
        for (const std::int64_t rate : {high, high + 1, high + 399, high + 401}) {
            if (!at(rate)) continue;
            ++close;
            for (const std::int64_t first : {0, 1, 2, 3})
                for (const int gops : {1, 2, 5})
                    EXPECT_TRUE(can_be_planned(s, first, gops))
                        << "seed " << seed << ", " << s.width << "x" << s.height << ", rate " << rate << ", gop "
                        << s.gop << ", cadence " << static_cast<int>(s.cadence) << ", first " << first;
        }
    }
    EXPECT_GT(close, 100);
}

TEST(Checks, GopsAreNotEndless) {
    EXPECT_EQ(border_refusal(settings(32, 32, 4, 100'000)), "");
    EXPECT_NE(border_refusal(settings(32, 32, 4, 100'001)).find("at most 100000"), std::string::npos);
    EXPECT_NE(border_refusal(settings(32, 32, 4, std::numeric_limits<int>::max())).find("gop"), std::string::npos);
}

TEST(Checks, ChunksOfAnyLengthArePlannedAtOnce) {
    for (const int gop : {1, 15, 100'000})
        for (const Cadence cadence : {Cadence::frames, Cadence::pulldown}) {
            Settings s = settings(64, 48, 4, gop, 1, 2);
            s.cadence = cadence;
            s.rate_control = {RateMode::variable, 60, 200'000, 250'000, 0};
            Encoder encoder(s);
            const std::int64_t length = 1'000'000'000'000;
            for (std::int64_t n = 0; n < 4; ++n) {
                const PicturePlan plan = encoder.plan(n, left(length - 1 - n), n == 0);
                EXPECT_GE(plan.quantiser, 1);
                encoder.push(textured(s, n, {0, 0}), plan, {});
            }
        }
}

}  // namespace
}  // namespace render2mpeg::encoder::testing
