// Every code word of every table, written by us and read by libavcodec: the picture it shows must be the one that the
// coded levels mean by our own arithmetic.

#include "encoder/mpeg2/bitstream/codes.h"

#include <gtest/gtest.h>

#include "decoders.h"
#include "encoder/mpeg2/bitstream/syntax.h"
#include "encoder/mpeg2/kernels/kernels.h"
#include "encoder/mpeg2/kernels/quantiser.h"
#include "encoder/mpeg2/macroblock/slice_writing.h"
#include "film.h"
#include "streams.h"

namespace render2mpeg::encoder::mpeg2 {
namespace {

using namespace testing;

/// Every run and level that a block can hold, of either sign, small levels first; levels beyond the tables are escapes.
std::vector<std::vector<RunLevel>> every_coefficient(bool intra) {
    std::vector<std::vector<RunLevel>> all;
    for (int run = 0; run < (intra ? 63 : 64); ++run)
        for (const int level : {1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 12, 13,  14, 15,
                                16, 17, 18, 19, 24, 31, 32, 39, 40, 41, 63, 64, 100, 500})
            for (const int sign : {1, -1}) {
                if (run > 1 && level > 41 && run % 8 != 0) continue;
                std::vector<RunLevel> runs = {
                    {static_cast<std::uint8_t>(run), static_cast<std::int16_t>(sign * level)}};
                if (run < 31)
                    runs.push_back({static_cast<std::uint8_t>(run), static_cast<std::int16_t>(-sign * level)});
                all.push_back(runs);
            }
    for (int level = 20; level < 40; ++level)
        all.push_back({{0, static_cast<std::int16_t>(level)}, {0, static_cast<std::int16_t>(-level)}});
    return all;
}

/// Puts block lists one after another into macroblocks; `expected` gets what each block shows.
void check_coefficients(bool intra, bool table_one) {
    const std::vector<std::vector<RunLevel>> blocks = every_coefficient(intra);
    ASSERT_LE(blocks.size(), static_cast<std::size_t>(columns * rows * 6));
    std::vector<RowCode> code(rows);
    std::size_t next = 0;
    for (RowCode& row : code)
        for (int column = 0; column < columns; ++column) {
            MacroblockCode m = plain_intra();
            if (!intra) {
                m.type = {false, false, true, false};
            }
            for (int i = 0; i < 6; ++i) {
                const std::vector<RunLevel> runs = next < blocks.size() ? blocks[next] : std::vector<RunLevel>{{0, 1}};
                ++next;
                row.runs.insert(row.runs.end(), runs.begin(), runs.end());
                m.runs[i] = static_cast<std::uint8_t>(runs.size());
            }
            row.macroblocks.push_back(m);
        }

    Libavcodec decoder;
    PictureHeader header;
    header.intra_vlc_format = table_one;
    if (!intra) {
        std::vector<RowCode> grey = plain_rows(plain_intra());
        decoder.push(access_unit(PictureHeader{}, grey, true));
        header.type = PictureType::predicted;
        header.temporal_reference = 1;
        header.f_code[0][0] = header.f_code[0][1] = 1;
    }
    decoder.push(access_unit(header, code, intra));
    const std::vector<core::Picture> pictures = decoder.finish();
    ASSERT_EQ(pictures.size(), intra ? 1u : 2u);

    for (std::size_t b = 0; b < blocks.size(); ++b) {
        const std::array<std::uint8_t, 64> expected = shown(intra, 128, blocks[b]);
        const int macroblock = static_cast<int>(b / 6), i = static_cast<int>(b % 6);
        const core::Picture& p = pictures.back();
        const core::Plane<std::uint8_t>& plane = i < 4 ? p.y : i == 4 ? p.cb : p.cr;
        const int size = i < 4 ? 16 : 8, x0 = macroblock % columns * size + (i < 4 ? i % 2 * 8 : 0),
                  y0 = macroblock / columns * size + (i < 4 ? i / 2 * 8 : 0);
        for (int k = 0; k < 64; ++k)
            ASSERT_EQ(plane.at(x0 + k % 8, y0 + k / 8), expected[static_cast<std::size_t>(k)])
                << "run " << int{blocks[b][0].run} << " level " << blocks[b][0].level
                << (table_one ? " table B-15" : " table B-14");
    }
}

TEST(Codes, EveryNonIntraCoefficientIsReadBack) {
    check_coefficients(false, false);
}
TEST(Codes, EveryIntraCoefficientOfTableB14IsReadBack) {
    check_coefficients(true, false);
}
TEST(Codes, EveryIntraCoefficientOfTableB15IsReadBack) {
    check_coefficients(true, true);
}

TEST(Codes, EveryDcDifferenceIsReadBack) {
    // Jump between all distances in luma and chroma, up and down.
    std::vector<RowCode> code(rows);
    int n = 0;
    std::vector<int> dcs;
    for (RowCode& row : code)
        for (int column = 0; column < columns; ++column, ++n) {
            const int dc = n % 2 ? 255 - n / 6 % 256 : n / 7 % 256;
            dcs.push_back(dc);
            row.macroblocks.push_back(plain_intra(dc));
        }
    Libavcodec decoder;
    decoder.push(access_unit(PictureHeader{}, code, true));
    const std::vector<core::Picture> pictures = decoder.finish();
    ASSERT_EQ(pictures.size(), 1u);
    for (int m = 0; m < n; ++m) {
        const int dc = dcs[static_cast<std::size_t>(m)];
        ASSERT_NEAR(pictures[0].y.at(m % columns * 16 + 5, m / columns * 16 + 9), dc, 1);
        ASSERT_NEAR(pictures[0].cb.at(m % columns * 8, m / columns * 8), dc, 1);
        ASSERT_NEAR(pictures[0].cr.at(m % columns * 8 + 7, m / columns * 8), dc, 1);
    }
}

TEST(Codes, EveryPatternAndEveryAddressIncrementIsReadBack) {
    // Row r holds macroblocks with distance 1 + r + column % 3, each with the next pattern.
    std::vector<RowCode> code(rows);
    std::vector<int> patterns(columns * rows, 0);
    int pattern = 0;
    for (int r = 0; r < rows; ++r) {
        RowCode& row = code[static_cast<std::size_t>(r)];
        MacroblockCode skipped;
        skipped.skipped = true;
        row.macroblocks.assign(columns, skipped);
        for (int column = 0; column < columns;
             column = column == columns - 1 ? columns : std::min(columns - 1, column + 1 + r + column % 3)) {
            MacroblockCode& m = row.macroblocks[static_cast<std::size_t>(column)];
            pattern = pattern % 63 + 1;
            m.skipped = false;
            m.type = {false, false, true, false};
            m.pattern = static_cast<std::uint8_t>(pattern);
            m.quantiser = quantiser;
            patterns[static_cast<std::size_t>(r * columns + column)] = pattern;
            for (int i = 0; i < 6; ++i)
                if (pattern & (32 >> i)) {
                    m.runs[i] = 1;
                    row.runs.push_back({0, 60});
                }
        }
    }
    Libavcodec decoder;
    std::vector<RowCode> grey = plain_rows(plain_intra());
    decoder.push(access_unit(PictureHeader{}, grey, true));
    PictureHeader header;
    header.type = PictureType::predicted;
    header.temporal_reference = 1;
    header.f_code[0][0] = header.f_code[0][1] = 1;
    decoder.push(access_unit(header, code, false));
    const std::vector<core::Picture> pictures = decoder.finish();
    ASSERT_EQ(pictures.size(), 2u);
    for (int m = 0; m < columns * rows; ++m)
        for (int i = 0; i < 6; ++i) {
            const core::Plane<std::uint8_t>& plane = i < 4 ? pictures[1].y : i == 4 ? pictures[1].cb : pictures[1].cr;
            const int size = i < 4 ? 16 : 8;
            const int value = plane.at(m % columns * size + (i < 4 ? i % 2 * 8 : 0) + 3,
                                       m / columns * size + (i < 4 ? i / 2 * 8 : 0) + 3);
            const bool coded = patterns[static_cast<std::size_t>(m)] & (32 >> i);
            ASSERT_NEAR(value, coded ? 128 + 121 / 8 : 128, coded ? 1 : 0) << "macroblock " << m << " block " << i;
        }
}

TEST(Codes, EveryVectorDifferenceIsReadBackAtEveryFCode) {
    // The reference tells its place: luma rises by column and row, so that a shifted copy shows the vector.
    const auto value = [](int x, int y) { return 20 + (x * 3 + y * 5) % 200; };
    std::vector<RowCode> texture(rows);
    for (int r = 0; r < rows; ++r)
        for (int column = 0; column < columns; ++column)
            texture[static_cast<std::size_t>(r)].macroblocks.push_back(plain_intra(value(column, r)));
    for (int f_code = 1; f_code <= 7; ++f_code) {
        std::vector<RowCode> code(rows);
        std::vector<Vector> vectors;
        for (int r = 0; r < rows; ++r)
            for (int column = 0; column < columns; ++column) {
                // Vectors all over the range, kept inside the picture, with differences of every size.
                const VectorRange range =
                    vector_range(column, r, columns, rows, f_code, std::min(f_code, vertical_f_code_limit));
                const int reach = 16 << (f_code - 1), n = static_cast<int>(vectors.size());
                const Vector v = range.clamp(n % 2 ? (n * 7) % (2 * reach) - reach : reach - 1 - (n * 5) % (2 * reach),
                                             (n * 13) % (2 * reach) - reach);
                MacroblockCode m;
                m.type = {false, true, false, false};
                m.mode.vector[0] = v;
                vectors.push_back(v);
                code[static_cast<std::size_t>(r)].macroblocks.push_back(m);
            }
        Libavcodec decoder;
        decoder.push(access_unit(PictureHeader{}, texture, true));
        PictureHeader header;
        header.type = PictureType::predicted;
        header.temporal_reference = 1;
        header.f_code[0][0] = f_code;
        header.f_code[0][1] = std::min(f_code, vertical_f_code_limit);
        decoder.push(access_unit(header, code, false));
        const std::vector<core::Picture> pictures = decoder.finish();
        ASSERT_EQ(pictures.size(), 2u);
        Frame reference(columns, rows);
        pad(pictures[0], reference);
        for (int m = 0; m < columns * rows; ++m) {
            Prediction expected;
            const Vector v = vectors[static_cast<std::size_t>(m)];
            predict_luma(reference, m % columns, m / columns, v, expected.y);
            predict_chroma(reference, m % columns, m / columns, v, expected);
            for (int k = 0; k < 256; ++k)
                ASSERT_EQ(pictures[1].y.at(m % columns * 16 + k % 16, m / columns * 16 + k / 16), expected.y[k])
                    << "f_code " << f_code << " macroblock " << m;
            for (int k = 0; k < 64; ++k) {
                ASSERT_EQ(pictures[1].cb.at(m % columns * 8 + k % 8, m / columns * 8 + k / 8), expected.cb[k]);
                ASSERT_EQ(pictures[1].cr.at(m % columns * 8 + k % 8, m / columns * 8 + k / 8), expected.cr[k]);
            }
        }
    }
}

TEST(Codes, LengthsAreThoseOfTheWords) {
    for (const CoefficientCodes* codes : {&coefficient_codes_zero(), &coefficient_codes_one()}) {
        const CoefficientLengths lengths(*codes);
        for (int run = 0; run < 64; ++run)
            for (int level = 1; level < 100; ++level) {
                BitWriter out;
                const RunLevel one[] = {{static_cast<std::uint8_t>(run), static_cast<std::int16_t>(-level)}};
                write_coefficients(out, one, 1, *codes, true);
                ASSERT_EQ(static_cast<int>(out.bit_count()), lengths.bits(run, level) + lengths.end_of_block());
            }
    }
    for (int f_code = 1; f_code <= 9; ++f_code)
        for (int d = -(16 << (f_code - 1)); d < 16 << (f_code - 1); ++d) {
            BitWriter out;
            write_component(out, d, f_code);
            ASSERT_EQ(static_cast<int>(out.bit_count()), component_bits(d, f_code));
        }
    for (const bool luma : {false, true})
        for (int d = -255; d <= 255; ++d) {
            BitWriter out;
            write_dc(out, d, luma);
            ASSERT_EQ(static_cast<int>(out.bit_count()), dc_bits(d, luma));
        }
}

}  // namespace
}  // namespace render2mpeg::encoder::mpeg2
