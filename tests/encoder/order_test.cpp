#include <gtest/gtest.h>

#include <algorithm>

#include "film.h"

/// Types, references and coding order of pictures; B pictures.
namespace render2mpeg::encoder::testing {
namespace {

TEST(Plan, AGopBeginsWithItsLengthACutOrAChunk) {
    Encoder encoder(settings(32, 32, 4, 4));
    std::vector<bool> starts;
    for (int n = 0; n < 14; ++n) {
        const PicturePlan plan = encoder.plan(n, {.cut_before = n == 6}, n == 0 || n == 11);
        EXPECT_EQ(plan.number, n);
        EXPECT_EQ(plan.type == PictureType::intra, plan.starts_gop);
        EXPECT_EQ(plan.references, plan.starts_gop ? std::vector<std::int64_t>{} : std::vector<std::int64_t>{n - 1});
        EXPECT_EQ(plan.quantiser, 4);
        starts.push_back(plan.starts_gop);
    }
    EXPECT_EQ(starts, (std::vector<bool>{1, 0, 0, 0, 1, 0, 1, 0, 0, 0, 1, 1, 0, 0}));
}

std::string types_of(Encoder& encoder, int count, const std::function<PictureFacts(int)>& facts,
                     const std::function<bool(int)>& first_of_chunk) {
    std::string types;
    for (int n = 0; n < count; ++n) {
        const PicturePlan plan = encoder.plan(n, facts(n), first_of_chunk(n));
        EXPECT_EQ(plan.references.size(), static_cast<std::size_t>(plan.type) - 1);
        types += "-IPB"[static_cast<int>(plan.type)];
    }
    return types;
}

TEST(Plan, BPicturesLieBetweenReferencesOfTheirGopOrBeforeTheNext) {
    const auto types = [](int gop, int b_pictures, int count, bool closed = false) {
        Settings s = settings(32, 32, 4, gop, 3, b_pictures);
        s.closed_gops = closed;
        Encoder encoder(s);
        return types_of(
            encoder, count, [&](int n) { return PictureFacts{.frames_left = count - 1 - n}; },
            [](int n) { return n == 0; });
    };
    EXPECT_EQ(types(15, 2, 20), "IBBPBBPBBPBBPBBIBPBP");
    EXPECT_EQ(types(15, 3, 15), "IBBBPBBBPBBPBBP");
    EXPECT_EQ(types(4, 2, 9), "IBPBIBPBI");
    EXPECT_EQ(types(5, 3, 9), "IBPBBIBBP");
    EXPECT_EQ(types(15, 3, 16), "IBBBPBBBPBBPBBBI") << "the longest run comes before an I picture";
    EXPECT_EQ(types(6, 1, 7), "IBPBPBI");
    EXPECT_EQ(types(2, 3, 5), "IBIBI");
    EXPECT_EQ(types(1, 3, 3), "III");
    EXPECT_EQ(types(15, 2, 20, true), "IBBPBBPBBPBBPBPIBPBP");
    EXPECT_EQ(types(5, 3, 9, true), "IBBBPIBBP");
}

TEST(Plan, WhereMotionIsUnevenFewerBPicturesLieInARow) {
    const auto types = [](double motion_nonuniformity, int b_pictures) {
        Encoder encoder(settings(32, 32, 4, 13, 3, b_pictures));
        return types_of(
            encoder, 13,
            [&](int n) { return PictureFacts{.frames_left = 12 - n, .motion_nonuniformity = motion_nonuniformity}; },
            [](int n) { return n == 0; });
    };
    EXPECT_EQ(types(0, 3), "IBBBPBBBPBBBP");
    EXPECT_EQ(types(0.45, 3), "IBBBPBBBPBBBP");
    EXPECT_EQ(types(0.5, 3), "IBBPBBPBBPBBP");
    EXPECT_EQ(types(0.7, 3), "IBPBPBPBPBPBP");
    EXPECT_EQ(types(50, 3), "IBPBPBPBPBPBP");
    EXPECT_EQ(types(50, 0), "IPPPPPPPPPPPP");
}

TEST(Plan, WhereLightChangesBPicturesStandAlone) {
    const auto types = [](double light_change, int b_pictures) {
        Encoder encoder(settings(32, 32, 4, 13, 3, b_pictures));
        return types_of(
            encoder, 13, [&](int n) { return PictureFacts{.frames_left = 12 - n, .light_change = light_change}; },
            [](int n) { return n == 0; });
    };
    EXPECT_EQ(types(0.2, 3), "IBBBPBBBPBBBP");
    EXPECT_EQ(types(0.3, 3), "IBPBPBPBPBPBP");
    EXPECT_EQ(types(0.3, 0), "IPPPPPPPPPPPP");
}

TEST(Plan, WhatMoreFollowsFromIsFiner) {
    Encoder encoder(settings(32, 32, 16, 15, 3, 0));
    int before = 0;
    for (int n = 0; n < 15; ++n) {
        const int quantiser = encoder.plan(n, {.frames_left = 14 - n}, n == 0).quantiser;
        EXPECT_GE(quantiser, before) << n;
        before = quantiser;
        if (n == 0) {
            EXPECT_EQ(quantiser, 13);
        }
    }
    EXPECT_EQ(before, 16);
}

TEST(Plan, NoBPictureIsPlannedBeyondWhatWasPromised) {
    Encoder encoder(settings(32, 32, 4, 12, 3, 2));
    // A cut at 6, a chunk's end after 11; nothing is promised from 12 on.
    const std::string types = types_of(
        encoder, 16,
        [](int n) {
            return PictureFacts{.cut_before = n == 6, .frames_left = n < 6 ? 5 - n : n < 12 ? 11 - n : 0};
        },
        [](int n) { return n == 0 || n == 12; });
    EXPECT_EQ(types, "IBBPBPIBBPBPIPPP");
    Encoder betrayed(settings(32, 32, 4, 12, 3, 2));
    betrayed.plan(0, {.frames_left = 9}, true);
    betrayed.plan(1, {.frames_left = 9}, false);
    EXPECT_THROW(betrayed.plan(2, {.cut_before = true}, false), core::ContractViolation);
}

TEST(Plan, APictureRefersToTheNearestReferences) {
    Encoder encoder(settings(32, 32, 4, 15, 3, 2));
    using Numbers = std::vector<std::int64_t>;
    const Numbers expected[] = {{}, {0, 3}, {0, 3}, {0}, {3, 5}, {3}};
    for (int n = 0; n < 6; ++n) EXPECT_EQ(encoder.plan(n, {.frames_left = 5 - n}, n == 0).references, expected[n]) << n;
}

TEST(Encoder, AFilmThatEndsEarlyIsWhole) {
    const Settings s = settings(96, 64, 4, 15, 3, 3);
    for (const int pushed : {1, 2, 3, 4, 5, 6, 7}) {
        // Nine pictures are promised; fewer come.
        Encoder encoder(s);
        Film film{s, {}};
        for (int n = 0; n < pushed; ++n) {
            const PicturePlan plan = encoder.plan(n, {.frames_left = 8 - n}, n == 0);
            for (CodedPicture& c : encoder.push(textured(s, n, {1.5, 0.5}), plan, steady_motion(s, plan, {1.5f, 0.5f})))
                film.coded.push_back(std::move(c));
        }
        for (CodedPicture& c : encoder.flush()) film.coded.push_back(std::move(c));
        ASSERT_EQ(film.coded.size(), static_cast<std::size_t>(pushed));
        EXPECT_TRUE(encoder.flush().empty());
        expect_decoders_agree(film, 0.1);
        for (const CodedPicture& c : film.coded)
            EXPECT_LE(difference(c.reconstruction, textured(s, c.plan.number, {1.5, 0.5})).mean, 2.5);
        // It may go on with a new chunk.
        EXPECT_TRUE(encoder.plan(20, {}, true).starts_gop);
    }
}

TEST(Encoder, BPicturesComeAfterBothTheirReferences) {
    const Settings s = settings(64, 48, 4, 15, 3, 2);
    const Film film = encode(s, 8, [&](std::int64_t n) { return textured(s, n, {1.0, 0.5}); });
    std::vector<std::int64_t> numbers;
    for (std::size_t i = 0; i < film.coded.size(); ++i) {
        EXPECT_EQ(film.coded[i].coding_order, static_cast<std::int64_t>(i));
        for (const std::int64_t r : film.coded[i].plan.references)
            EXPECT_NE(std::find(numbers.begin(), numbers.end(), r), numbers.end());
        numbers.push_back(film.coded[i].plan.number);
        // One picture of delay is enough: nothing is decoded later than it is shown.
        EXPECT_LE(static_cast<std::int64_t>(i) - 1, numbers.back());
    }
    EXPECT_EQ(numbers, (std::vector<std::int64_t>{0, 3, 1, 2, 5, 4, 7, 6}));
}

TEST(Encoder, AnOpenGopIsDecodedAsItWasCoded) {
    const Settings s = settings(96, 64, 4, 5, 3, 2);
    const Film film = encode(s, 13, [&](std::int64_t n) { return textured(s, n, {1.0, 0.5}); });
    std::vector<std::int64_t> numbers;
    for (const CodedPicture& c : film.coded) numbers.push_back(c.plan.number);
    EXPECT_EQ(numbers, (std::vector<std::int64_t>{0, 2, 1, 5, 3, 4, 7, 6, 10, 8, 9, 12, 11}));
    EXPECT_EQ(film.coded[5].plan.references, (std::vector<std::int64_t>{2, 5}));
    expect_decoders_agree(film, 0.1);
}

TEST(Encoder, BPicturesAreCoarserAndCostLess) {
    const Settings with = settings(320, 240, 4, 13, 3, 2);
    const Settings without = settings(320, 240, 4, 13);
    const auto film = [](const Settings& s) {
        return encode(
            s, 13,
            [&](std::int64_t n) {
                return textured(s, n, {1.25, -0.75});
            },
            [&](const PicturePlan& plan) {
                return steady_motion(s, plan, {1.25f, -0.75f});
            });
    };
    const Film a = film(with), b = film(without);
    EXPECT_LT(a.bytes().size() * 10, b.bytes().size() * 9);
    for (const CodedPicture& c : a.coded)
        EXPECT_EQ(c.plan.quantiser, c.plan.type == PictureType::bidirectional ? 6
                                    : c.plan.number < 9                       ? 3
                                                                              : 4)
            << c.plan.number;
}

TEST(Encoder, WhatOnlyOneReferenceShowsIsPredictedFromIt) {
    // The left half changes between pictures 0 and 1, the right half between 1 and 2; picture 1 lies between.
    const Settings s = settings(160, 96, 4, 3, 3, 1);
    const auto picture = [&](std::int64_t n) {
        return paint(s.width, s.height, n, [&](int plane, double x, double y) {
            const bool old = n == 0 || (n == 1 && x >= 80);
            return texture(plane, x + (old ? 0 : 700), y);
        });
    };
    const Film film = encode(s, 3, picture);
    ASSERT_EQ(film.coded[2].plan.type, PictureType::bidirectional);
    for (int y = 0; y < 6; ++y)
        for (int x = 0; x < 10; ++x) {
            const MacroblockRecord& m = film.coded[2].macroblocks.at(x, y);
            EXPECT_EQ(m.forward, x >= 5) << x << " " << y;
            EXPECT_EQ(m.backward, x < 5) << x << " " << y;
        }
}

TEST(Encoder, RunsOfBPicturesAreAsLongAsALookAheadSays) {
    const Settings s = settings(64, 48, 8, 15, 3, 3);
    Encoder encoder(s);
    std::string types;
    for (std::int64_t n = 0; n < 15; ++n) {
        PictureFacts facts;
        facts.frames_left = 14 - n;
        facts.b_pictures = n < 6 ? 0 : n < 9 ? 2 : 7;
        types += "?IPB"[static_cast<int>(encoder.plan(n, facts, n == 0).type)];
    }
    EXPECT_EQ(types, "IPPPPPBBPBBBPBP");
}

TEST(Encoder, ACrossFadeIsPredictedFromBothReferences) {
    const Settings s = settings(160, 96, 8, 3, 3, 1);
    const auto picture = [&](std::int64_t n) {
        return paint(s.width, s.height, n, [&](int plane, double x, double y) {
            const double mix = 0.5 * static_cast<double>(n);
            return (1 - mix) * texture(plane, x, y) + mix * texture(plane, y + 300, x);
        });
    };
    const CodedPicture coded = encode(s, 3, picture).coded[2];
    int both = 0, skipped = 0;
    for (const MacroblockRecord& m : coded.macroblocks.values()) {
        both += m.forward && m.backward;
        skipped += m.skipped;
    }
    EXPECT_GE(both, 59);
    EXPECT_GE(skipped, 15);  // like the macroblock before: both references, zero vectors
    EXPECT_LT(coded.bytes.size(), 340u);
}

TEST(Encoder, TheDearerEffortCostsFewerBitsForTheSameErrorSlow) {
    Settings s = settings(320, 240, 5, 13, 3, 2);
    const auto picture = [&](std::int64_t n) {
        return paint(s.width, s.height, n, [n](int plane, double x, double y) {
            const double t = static_cast<double>(n), grain = core::uniform(7, static_cast<std::uint64_t>(n),
                                                                           static_cast<std::uint64_t>(x * 1000 + y));
            return texture(plane, x - 1.3 * t, y + 0.6 * t) + 12 * grain;
        });
    };
    const auto lagrangian = [&](Effort effort) {
        s.effort = effort;
        double cost = 0;
        for (const CodedPicture& c : encode(s, 13, picture, [&](const PicturePlan& plan) {
                                         return steady_motion(s, plan, {1.3f, -0.6f});
                                     }).coded) {
            const core::Picture original = picture(c.plan.number);
            for (std::size_t i = 0; i < original.y.size(); ++i) {
                const double d = original.y.values()[i] - c.reconstruction.y.values()[i];
                cost += d * d;
            }
            cost += 0.6 * 25 * 8.0 * static_cast<double>(c.bytes.size());
        }
        return cost;
    };
    const double fast = lagrangian(Effort::fast), quality = lagrangian(Effort::quality);
    EXPECT_LT(quality, 0.999 * fast);
    EXPECT_GT(quality, 0.9 * fast);
}

}  // namespace
}  // namespace render2mpeg::encoder::testing
