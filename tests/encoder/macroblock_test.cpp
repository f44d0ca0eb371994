#include "encoder/mpeg2/macroblock/macroblock.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>

#include "encoder/mpeg2/bitstream/levels.h"
#include "encoder/mpeg2/bitstream/tuning.h"
#include "encoder/mpeg2/motion/candidates.h"
#include "film.h"
#include "streams.h"

namespace render2mpeg::encoder::mpeg2 {
namespace {

using namespace testing;
using encoder::testing::decode_with_libmpeg2;
using encoder::testing::noise;
using encoder::testing::paint;
using encoder::testing::settings;
using encoder::testing::steady_motion;
using encoder::testing::uniform_motion;

/// One picture's worth of macroblocks of all kinds in random order, and what each block should show.
struct Medley {
    std::vector<RowCode> code = std::vector<RowCode>(rows);
    std::vector<std::array<std::array<std::uint8_t, 64>, 6>> expected;  ///< inter ones on grey

    explicit Medley(std::uint64_t seed) {
        std::uint64_t n = 0;
        const auto roll = [&](int count) {
            return static_cast<int>(core::uniform(seed, n++) * static_cast<float>(count));
        };
        for (RowCode& row : code) {
            int in_force = quantiser;
            for (int column = 0; column < columns; ++column) add(row, column, roll, in_force);
        }
    }

    template <class Roll>
    void add(RowCode& row, int column, const Roll& roll, int& in_force) {
        MacroblockCode m;
        const bool inner = column > 0 && column < columns - 1;
        int kind = roll(5);  // skipped, intra, vector and blocks, blocks alone, vector alone
        if (kind == 0 && !inner) kind = 4;
        m.skipped = kind == 0;
        m.type = {kind == 1, kind == 2 || kind == 4, kind == 2 || kind == 3, false};
        m.pattern = static_cast<std::uint8_t>(m.type.intra ? 63 : m.type.pattern ? 1 + roll(63) : 0);
        if (m.pattern != 0 && roll(3) == 0) {
            m.type.quant = true;
            in_force = 1 + roll(31);
        }
        m.quantiser = static_cast<std::uint8_t>(in_force);
        const int row_number = static_cast<int>(expected.size()) / columns;
        if (m.type.motion_forward)
            m.mode.vector[0] =
                vector_range(column, row_number, columns, rows, 3, 3).clamp(roll(120) - 60, roll(120) - 60);
        std::array<std::array<std::uint8_t, 64>, 6> blocks;
        for (int i = 0; i < 6; ++i) {
            std::vector<RunLevel> runs;
            m.dc[i] = static_cast<std::uint16_t>(m.type.intra ? roll(256) : 0);
            if (m.pattern & (32 >> i)) {
                runs.push_back({static_cast<std::uint8_t>(roll(20)),
                                static_cast<std::int16_t>(roll(2) ? 1 + roll(6) : -1 - roll(6))});
                row.runs.insert(row.runs.end(), runs.begin(), runs.end());
                m.runs[i] = 1;
            }
            blocks[static_cast<std::size_t>(i)] = shown(m.type.intra, m.dc[i], runs, in_force);
        }
        expected.push_back(blocks);
        row.macroblocks.push_back(m);
    }
};

TEST(Macroblocks, AnySequenceOfKindsIsReadBack) {
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
        Medley medley(seed);
        std::vector<RowCode> grey = plain_rows(plain_intra());
        PictureHeader header;
        header.type = PictureType::predicted;
        header.temporal_reference = 1;
        header.f_code[0][0] = header.f_code[0][1] = 3;
        Libavcodec decoder;
        std::vector<std::uint8_t> stream = access_unit(PictureHeader{}, grey, true);
        decoder.push(stream);
        const std::vector<std::uint8_t> second = access_unit(header, medley.code, false);
        decoder.push(second);
        const std::vector<core::Picture> pictures = decoder.finish();
        ASSERT_EQ(pictures.size(), 2u);
        stream.insert(stream.end(), second.begin(), second.end());
        const std::vector<std::uint8_t> end = sequence_end();
        stream.insert(stream.end(), end.begin(), end.end());
        const std::vector<core::Picture> others = decode_with_libmpeg2(stream);
        ASSERT_EQ(others.size(), 2u);
        for (std::size_t m = 0; m < medley.expected.size(); ++m)
            for (int i = 0; i < 6; ++i)
                for (int k = 0; k < 64; ++k) {
                    const int column = static_cast<int>(m) % columns, row = static_cast<int>(m) / columns;
                    const int x = (i < 4 ? column * 16 + i % 2 * 8 : column * 8) + k % 8,
                              y = (i < 4 ? row * 16 + i / 2 * 8 : row * 8) + k / 8;
                    const auto shown_by = [&](const core::Picture& p) {
                        return (i < 4 ? p.y : i == 4 ? p.cb : p.cr).at(x, y);
                    };
                    const int expected = medley.expected[m][static_cast<std::size_t>(i)][static_cast<std::size_t>(k)];
                    ASSERT_EQ(shown_by(pictures[1]), expected) << "macroblock " << m << " block " << i;
                    ASSERT_NEAR(shown_by(others[1]), expected, 1)
                        << "macroblock " << m << " block " << i << ", libmpeg2";
                }
    }
}

/// A picture of one macroblock.
struct One {
    Frame source{1, 1}, reference{1, 1}, reconstruction{1, 1};
    std::unique_ptr<ModeTrial> trial = std::make_unique<ModeTrial>();
    SliceState state;

    PictureCoding coding(bool intra) {
        return {source,           {intra ? nullptr : &reference, nullptr},
                reconstruction,   intra ? PictureType::intra : PictureType::predicted,
                {{1, 1}, {1, 1}}, lambda_predicted};
    }
};

TEST(Macroblocks, TruncationMeetsAnyLimitAndKeepsItsBooks) {
    One one;
    one.state.quantiser = 1;
    pad(noise(16, 16, 0, 3), one.source);
    const PictureCoding coding = one.coding(true);
    try_intra(coding, 0, 0, 1, one.state, *one.trial);
    ASSERT_GT(one.trial->rd.bits, 4608);
    for (const int limit : {4608, 2000, 300}) {
        const float before = one.trial->rd.distortion;
        truncate_to(*one.trial, coding, one.state, limit);
        EXPECT_LE(one.trial->rd.bits, limit);
        EXPECT_LE(one.trial->rd.bits_with_one, limit);
        EXPECT_GT(one.trial->rd.bits, limit * 3 / 4);
        EXPECT_GT(one.trial->rd.distortion, before);
    }
    // The distortion in the books is that of the picture, but for the rounding of samples.
    const float booked = one.trial->rd.distortion;
    reconstruct(coding, 0, 0, *one.trial);
    double sum = 0;
    for (int plane = 0; plane < 3; ++plane)
        for (std::size_t i = 0; i < one.source.plane(plane).size(); ++i) {
            const double d = one.source.plane(plane).values()[i] - one.reconstruction.plane(plane).values()[i];
            sum += d * d;
        }
    EXPECT_NEAR(sum, booked, 0.03 * booked);
}

TEST(Macroblocks, AResidualOfOneAndAHalfStepsIsCoded) {
    One one;
    constexpr int q = 8;
    one.state.quantiser = q;
    // The basis function (1, 1) at 1.5 steps of 16 in every block.
    for (int plane = 0; plane < 3; ++plane)
        for (int y = 0; y < one.source.plane(plane).height(); ++y)
            for (int x = 0; x < one.source.plane(plane).width(); ++x) {
                const double basis = 0.25 * std::cos((2 * (x % 8) + 1) * 3.14159265 / 16) *
                                     std::cos((2 * (y % 8) + 1) * 3.14159265 / 16);
                one.reference.plane(plane).at(x, y) = 128;
                one.source.plane(plane).at(x, y) = static_cast<std::uint8_t>(std::lround(128 + 24 * basis));
            }
    try_inter(one.coding(false), 0, 0, {}, q, one.state, *one.trial);
    EXPECT_EQ(one.trial->rd.pattern, 63);
    EXPECT_LT(one.trial->rd.distortion, 6 * 24 * 24 / 4);
    one.source = one.reference;
    try_inter(one.coding(false), 0, 0, {}, q, one.state, *one.trial);
    EXPECT_EQ(one.trial->rd.pattern, 0);
    EXPECT_EQ(one.trial->rd.distortion, 0);
}

TEST(Macroblocks, NoiseThatDoesNotFitIsCodedMoreCoarsely) {
    const auto film =
        encoder::testing::encode(settings(96, 80, 1, 1), 1, [](std::int64_t n) { return noise(96, 80, n, 4); });
    int coarser = 0;
    for (const MacroblockRecord& m : film.coded[0].macroblocks.values()) {
        coarser += m.quantiser > 1;
        EXPECT_LE(m.quantiser, 9);
        EXPECT_LE(m.bits, macroblock_bits_limit);
        EXPECT_GE(m.bits, 2600u);
    }
    EXPECT_GE(coarser, 25);
}

TEST(Candidates, ASilhouetteOffersBothMotions) {
    core::MotionField field = uniform_motion(32, 16, 1, {-4.0f, 1.0f});
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 6; ++x) field.vector.at(x, y) = {3.0f, -2.5f};
    const VectorRange anything{-1000, 1000, -1000, 1000};
    const Candidates mixed = exact_candidates(field, 0, 0, anything), plain = exact_candidates(field, 1, 0, anything);
    ASSERT_EQ(mixed.count, 2);
    EXPECT_TRUE((mixed.vector[0] == Vector{6, -5} && mixed.vector[1] == Vector{-8, 2}) ||
                (mixed.vector[0] == Vector{-8, 2} && mixed.vector[1] == Vector{6, -5}));
    ASSERT_EQ(plain.count, 1);
    EXPECT_EQ(plain.vector[0], (Vector{-8, 2}));
}

TEST(Candidates, PixelsWithoutMotionAreLeftOut) {
    core::MotionField field = uniform_motion(40, 20, 1, {2.0f, 2.0f});
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x)
            if ((x + y / 4) % 4 != 0) {
                field.vector.at(x, y) = {std::numeric_limits<float>::quiet_NaN(), 1e30f};
                field.kind.at(x, y) = x % 2 ? core::PixelClass::none : core::PixelClass::surface;
            }
    const VectorRange narrow{-3, 3, -3, 3};
    const Candidates some = exact_candidates(field, 0, 0, narrow);
    ASSERT_EQ(some.count, 1);
    EXPECT_EQ(some.vector[0], (Vector{3, 3}));  // 4 half pixels, kept in range
    for (core::PixelClass& kind : field.kind.values()) kind = core::PixelClass::none;
    EXPECT_EQ(exact_candidates(field, 0, 0, narrow).count, 0);
    EXPECT_EQ(exact_candidates(field, 2, 1, narrow).count, 0);  // hangs over both sides
}

TEST(Candidates, HalvesRoundUpAndQuartersToTheNearest) {
    const VectorRange anything{-1000, 1000, -1000, 1000};
    for (const auto& [pixels, half] :
         {std::pair{0.2f, 0}, {0.3f, 1}, {0.5f, 1}, {0.74f, 1}, {0.76f, 2}, {-0.2f, 0}, {-0.3f, -1}, {-7.6f, -15}})
        EXPECT_EQ(exact_candidates(uniform_motion(16, 16, 1, {pixels, 0}), 0, 0, anything).vector[0].x, half) << pixels;
}

/// Grey pictures; in macroblock (2, 1) of the second one plane has another value.
CodedPicture after_a_change(Effort effort, int changed_plane, double value) {
    Settings s = settings(96, 64, 6);
    s.effort = effort;
    Encoder encoder(s);
    std::vector<CodedPicture> coded;
    for (int n = 0; n < 2; ++n) {
        const PicturePlan plan = encoder.plan(n, {.frames_left = 1 - n}, n == 0);
        const core::Picture picture = paint(96, 64, n, [&](int plane, double x, double y) {
            const bool inside = x >= 32 && x < 48 && y >= 16 && y < 32;
            return n == 1 && inside && plane == changed_plane ? value : plane == 0 ? 110.0 : 128.0;
        });
        coded = encoder.push(picture, plan, steady_motion(s, plan, {0, 0}), {});
    }
    return std::move(coded.back());
}

TEST(Skipping, IsForbiddenByAnyPlaneThatChanged) {
    for (const Effort effort : {Effort::fast, Effort::quality}) {
        for (int plane = 0; plane < 3; ++plane) {
            const CodedPicture coded = after_a_change(effort, plane, 150);
            ASSERT_EQ(coded.plan.type, PictureType::predicted);
            EXPECT_FALSE(coded.macroblocks.at(2, 1).skipped) << plane;
            EXPECT_TRUE(coded.macroblocks.at(3, 2).skipped);
            const auto& shown = plane == 0   ? coded.reconstruction.y
                                : plane == 1 ? coded.reconstruction.cb
                                             : coded.reconstruction.cr;
            EXPECT_NEAR(shown.at(plane == 0 ? 40 : 20, plane == 0 ? 24 : 12), 150, 5) << plane;
        }
    }
}

}  // namespace
}  // namespace render2mpeg::encoder::mpeg2
