#include "encoder/encoder.h"

#include <gtest/gtest.h>

#include "film.h"
#include "parallel/loops.h"

namespace render2mpeg::encoder::testing {
namespace {

/// Position right behind the n-th occurrence of a start code.
std::size_t find_start_code(const std::vector<std::uint8_t>& bytes, std::uint8_t value, int n = 0) {
    for (std::size_t i = 0; i + 3 < bytes.size(); ++i)
        if (bytes[i] == 0 && bytes[i + 1] == 0 && bytes[i + 2] == 1 && bytes[i + 3] == value && n-- == 0) return i + 4;
    return std::string::npos;
}
std::uint64_t bits_at(const std::vector<std::uint8_t>& bytes, std::size_t byte, int skip, int count) {
    std::uint64_t value = 0;
    for (int i = skip; i < skip + count; ++i)
        value = value << 1 | (bytes[byte + static_cast<std::size_t>(i / 8)] >> (7 - i % 8) & 1);
    return value;
}

TEST(Encoder, AChunksBytesDoNotDependOnWhatCameBefore) {
    const Settings s = settings(80, 48, 4, 6, 3, 2);
    const auto run = [&](int first) {
        Encoder encoder(s);
        std::vector<std::vector<std::uint8_t>> bytes;
        for (int n = first; n < 12; ++n) {
            const PicturePlan plan = encoder.plan(n, {.frames_left = n < 6 ? 5 - n : 11 - n}, n == first || n == 6);
            for (CodedPicture& c :
                 encoder.push(textured(s, n, {1.5, -0.5}), plan, steady_motion(s, plan, {1.5f, -0.5f})))
                if (n >= 6) bytes.push_back(std::move(c.bytes));
        }
        return bytes;
    };
    EXPECT_EQ(run(0), run(6));
}

TEST(Encoder, TheNumberOfThreadsDoesNotShow) {
    const Settings s = settings(200, 150, 3, 5, 3, 2);
    const auto run = [&](int threads) {
        const parallel::ThreadLimit limit(threads);
        return encode(
                   s, 7,
                   [&](std::int64_t n) {
                       return textured(s, n, {2.25, 1.0});
                   },
                   [&](const PicturePlan& plan) {
                       return steady_motion(s, plan, {2.25f, 1.0f});
                   })
            .bytes();
    };
    const std::vector<std::uint8_t> one = run(1);
    EXPECT_EQ(one, run(2));
    EXPECT_EQ(one, run(7));
}

TEST(Encoder, ATranslationIsCodedByItsVectorAndCostsAlmostNothing) {
    // Whole pixels: the prediction is perfect but for the reference's quantisation, which copies along.
    const Settings s = settings(320, 240, 4, 10);
    const glm::dvec2 step{5, -3};
    const Film film = encode(
        s, 4, [&](std::int64_t n) { return textured(s, n, step); },
        [&](const PicturePlan& plan) {
            return std::vector{uniform_motion(s.width, s.height, plan.number, -glm::vec2(step))};
        });
    const CodedPicture& intra = film.coded[0];
    for (std::size_t i = 1; i < film.coded.size(); ++i) {
        const CodedPicture& coded = film.coded[i];
        int exact = 0, inner = 0;
        std::uint64_t bits = 0;
        // Content enters at the left and the lower border; elsewhere everything has been there before.
        for (int y = 0; y < 14; ++y)
            for (int x = 1; x < 20; ++x) {
                const MacroblockRecord& m = coded.macroblocks.at(x, y);
                exact += !m.intra && m.motion_x == -10 && m.motion_y == 6;
                bits += m.bits;
                ++inner;
            }
        EXPECT_GE(exact, inner * 95 / 100);
        EXPECT_LE(bits, static_cast<std::uint64_t>(inner) * 12);
        EXPECT_GE(bits, static_cast<std::uint64_t>(inner) * 3);
        EXPECT_LT(coded.bytes.size() * 5, intra.bytes.size());
    }
}

/// Clouds that slide.
core::Picture sliding_clouds(const Settings& s, std::int64_t n, glm::dvec2 step) {
    return paint(s.width, s.height, n, [&](int plane, double x, double y) {
        return clouds(plane, x - step.x * static_cast<double>(n), y - step.y * static_cast<double>(n));
    });
}

TEST(Encoder, MotionWithinReachIsFoundWithoutHintsSlow) {
    for (const Effort effort : {Effort::quality, Effort::fast}) {
        Settings s = settings(320, 240, 4, 10);
        s.effort = effort;
        const glm::dvec2 step{5.5, -7};
        const auto bytes = [&](const Motion& motion) {
            return static_cast<double>(encode(
                                           s, 5, [&](std::int64_t n) { return sliding_clouds(s, n, step); }, motion)
                                           .bytes()
                                           .size());
        };
        const double told = bytes([&](const PicturePlan& plan) {
            return std::vector{uniform_motion(s.width, s.height, plan.number, -glm::vec2(step))};
        });
        EXPECT_LT(bytes(no_motion), 1.05 * told) << static_cast<int>(effort);
    }
}

TEST(Encoder, SearchesWhereExactMotionIsNotGoodEnough) {
    const Settings s = settings(320, 240, 16, 10);
    const auto work = [&](glm::vec2 told) {
        return encode(
                   s, 2,
                   [&](std::int64_t n) {
                       return sliding_clouds(s, n, {5, -3});
                   },
                   [&](const PicturePlan& plan) {
                       return std::vector{uniform_motion(s.width, s.height, plan.number, told)};
                   })
            .coded[1]
            .motion;
    };
    const MotionWork right = work({-5, 3}), wrong = work({9, 9});
    EXPECT_LT(right.searches * 3, wrong.searches * 2);
    EXPECT_GT(right.chosen.exact, 10u);
    EXPECT_LT(wrong.chosen.exact, 10u);
    EXPECT_GT(wrong.chosen.searched + wrong.chosen.predicted, 250u);
    EXPECT_GT(wrong.chosen.searched, 10u);
    EXPECT_EQ(wrong.chosen.all(), 300u);
}

TEST(Encoder, NothingMovingIsSkippedAndStaysAsItIs) {
    const Settings s = settings(160, 96, 4, 10);
    const Film film = encode(s, 4, [&](std::int64_t n) { return textured(s, n, {0, 0}); });
    const CodedPicture& coded = film.coded[2];
    for (int y = 0; y < 6; ++y)
        for (int x = 1; x < 9; ++x) EXPECT_TRUE(coded.macroblocks.at(x, y).skipped);
    EXPECT_EQ(coded.reconstruction.y, film.coded[1].reconstruction.y);
    EXPECT_LT(coded.bytes.size(), 150u);
}

TEST(Encoder, AFlashIsCodedIntra) {
    // The second picture has nothing of the first, and no cut was told.
    const Settings s = settings(160, 96, 4, 10);
    const Film film = encode(s, 2, [&](std::int64_t n) {
        return paint(s.width, s.height, n, [n](int plane, double x, double y) {
            return n == 0 ? texture(plane, x, y) : plane == 0 ? 60 + 0.5 * x + 0.3 * y : 110;
        });
    });
    int intra = 0;
    for (const MacroblockRecord& m : film.coded[1].macroblocks.values()) intra += m.intra;
    EXPECT_GE(intra, static_cast<int>(film.coded[1].macroblocks.size()) * 9 / 10);
}

TEST(Encoder, MacroblockBitsAddUpToThePicture) {
    const Settings s = settings(160, 96, 3, 10);
    for (const CodedPicture& coded : encode(s, 3, [&](std::int64_t n) { return textured(s, n, {1.3, 0.4}); }).coded) {
        std::uint64_t bits = 0;
        for (const MacroblockRecord& m : coded.macroblocks.values()) bits += m.bits;
        // Beside the macroblocks: headers, and per slice a start code, a quantiser and up to 7 bits of alignment.
        const std::uint64_t slices = 6 * 38, all = coded.bytes.size() * 8;
        EXPECT_GE(all, bits + slices + 8 * 17);
        EXPECT_LE(all, bits + slices + 6 * 7 + 8 * 64);
    }
}

TEST(Encoder, ACoarserQuantiserCostsFewerBitsAndMoreError) {
    std::size_t bytes = ~std::size_t{0};
    double error = 0;
    for (const int q : {1, 2, 4, 8, 16, 31}) {
        const Settings s = settings(176, 144, q, 5);
        const Film film = encode(s, 5, [&](std::int64_t n) { return textured(s, n, {1.25, -0.75}); });
        double sum = 0;
        for (const CodedPicture& coded : film.coded)
            sum += difference(coded.reconstruction, textured(s, coded.plan.number, {1.25, -0.75})).mean;
        EXPECT_LT(film.bytes().size(), bytes);
        EXPECT_GT(sum, error);
        bytes = film.bytes().size();
        error = sum;
    }
}

TEST(Headers, SayWhatTheStreamIs) {
    Settings s = settings(720, 480, 4, 4, 4);
    s.aspect_ratio_code = 3;
    s.matrix_coefficients = 6;
    const Film film = encode(s, 5, [&](std::int64_t n) { return textured(s, n, {0, 0}); });
    for (const CodedPicture& coded : film.coded) {
        const bool gop = coded.plan.starts_gop;
        const std::size_t sequence = find_start_code(coded.bytes, 0xb3);
        ASSERT_EQ(sequence != std::string::npos, gop);
        ASSERT_EQ(find_start_code(coded.bytes, 0xb8) != std::string::npos, gop);
        const std::size_t picture = find_start_code(coded.bytes, 0x00);
        EXPECT_EQ(bits_at(coded.bytes, picture, 0, 10), static_cast<std::uint64_t>(coded.plan.number % 4));
        EXPECT_EQ(bits_at(coded.bytes, picture, 10, 3), gop ? 1u : 2u);
        if (!gop) continue;
        EXPECT_EQ(bits_at(coded.bytes, sequence, 0, 12), 720u);
        EXPECT_EQ(bits_at(coded.bytes, sequence, 12, 12), 480u);
        EXPECT_EQ(bits_at(coded.bytes, sequence, 24, 4), 3u);
        EXPECT_EQ(bits_at(coded.bytes, sequence, 28, 4), 4u);
        EXPECT_EQ(bits_at(coded.bytes, sequence, 32, 18), 15'000'000u / 400);
        EXPECT_EQ(bits_at(coded.bytes, sequence, 51, 10), 112u);
        const std::size_t extension = find_start_code(coded.bytes, 0xb5),
                          display = find_start_code(coded.bytes, 0xb5, 1);
        EXPECT_EQ(bits_at(coded.bytes, extension, 4, 8), 0x48u);
        EXPECT_EQ(bits_at(coded.bytes, display, 0, 4), 2u);
        EXPECT_EQ(bits_at(coded.bytes, display, 8, 8), 1u);
        EXPECT_EQ(bits_at(coded.bytes, display, 16, 8), 1u);
        EXPECT_EQ(bits_at(coded.bytes, display, 24, 8), 6u);
    }
    EXPECT_EQ(sequence_end(), (std::vector<std::uint8_t>{0, 0, 1, 0xb7}));
}

TEST(Headers, DecodersReadRateAspectAndColours) {
    for (int code = 1; code <= 8; ++code) {
        const Settings s = settings(64, 48, 8, 2, code);
        const Film film = encode(s, 3, [&](std::int64_t n) { return textured(s, n, {0, 0}); });
        Libavcodec decoder;
        for (const CodedPicture& coded : film.coded) decoder.push(coded.bytes);
        const AVCodecContext& c = decoder.context();
        EXPECT_EQ(c.framerate.num * s.rate.hertz.den, c.framerate.den * s.rate.hertz.num);
        EXPECT_EQ(c.profile, FF_PROFILE_MPEG2_MAIN);
        EXPECT_EQ(c.level, code >= 6 ? 6 : 8);
        EXPECT_EQ(c.color_primaries, AVCOL_PRI_BT709);
        EXPECT_EQ(c.colorspace, AVCOL_SPC_BT709);
        EXPECT_EQ(c.sample_aspect_ratio.num, c.sample_aspect_ratio.den);
        EXPECT_EQ(decoder.finish().size(), 3u);
    }
}

TEST(Headers, TheTableOfIntraCoefficientsIsTheCheaperOne) {
    const auto vlc_format = [](int quantiser, const Paint& picture) {
        const CodedPicture coded = encode(settings(128, 96, quantiser, 1), 1, picture).coded[0];
        const std::size_t extension = find_start_code(coded.bytes, 0xb5, 2);  // after the sequence's two
        EXPECT_EQ(bits_at(coded.bytes, extension, 0, 4), 8u);
        return bits_at(coded.bytes, extension, 4 + 16 + 2 + 2 + 1 + 1 + 1 + 1, 1);
    };
    // Table B-15 is for many and large levels, B-14 for few and small ones.
    EXPECT_EQ(vlc_format(2, [](std::int64_t n) { return noise(128, 96, n, 1); }), 1u);
    EXPECT_EQ(vlc_format(31,
                         [](std::int64_t n) {
                             return paint(128, 96, n, [](int, double x, double y) {
                                 return 100 + 0.5 * x + 9 * std::sin(0.3 * y);
                             });
                         }),
              0u);
}

TEST(Headers, TimeCodeCountsPicturesAtTheRoundedRate) {
    const Settings s = settings(16, 16, 8, 10, 4);
    Encoder encoder(s);
    const std::int64_t number = ((2 * 60 + 3) * 60 + 4) * 30 + 29;
    const PicturePlan plan = encoder.plan(number, {}, true);
    const CodedPicture coded = encoder.push(textured(s, number, {0, 0}), plan, {})[0];
    const std::size_t gop = find_start_code(coded.bytes, 0xb8);
    const std::uint64_t expected[] = {0, 2,  3, 1,
                                      4, 29, 1, 0};  // drop, hours, minutes, marker, seconds, pictures, closed, broken
    const int widths[] = {1, 5, 6, 1, 6, 6, 1, 1};
    for (int i = 0, at = 0; i < 8; at += widths[i++]) EXPECT_EQ(bits_at(coded.bytes, gop, at, widths[i]), expected[i]);
}

TEST(Encoder, BrokenPromisesAreContractViolations) {
    const Settings s = settings(32, 32);
    Encoder encoder(s);
    const PicturePlan first = encoder.plan(0, {}, true), second = encoder.plan(1, {}, false);
    EXPECT_THROW(encoder.push(textured(s, 1, {0, 0}), second, {}),
                 core::ContractViolation);  // its reference never came
    EXPECT_THROW(encoder.push(textured(settings(16, 32), 0, {0, 0}), first, {}), core::ContractViolation);
    encoder.push(textured(s, 0, {0, 0}), first, {});
    const std::vector wrong_size = {uniform_motion(16, 16, 1, {0, 0})},
                      wrong_picture = {uniform_motion(32, 32, 7, {0, 0})};
    EXPECT_THROW(encoder.push(textured(s, 1, {0, 0}), second, wrong_size), core::ContractViolation);
    EXPECT_THROW(encoder.push(textured(s, 1, {0, 0}), second, wrong_picture), core::ContractViolation);
    EXPECT_EQ(encoder.push(textured(s, 1, {0, 0}), second, {}).size(), 1u);
    EXPECT_THROW(encoder.plan(5, {}, false), core::ContractViolation);
}

}  // namespace
}  // namespace render2mpeg::encoder::testing
