#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <vector>

#include "streams.h"

/// Mismatch control where it is easiest to get wrong [H262, 7.4.4]: sums that are even and odd, a last coefficient of
/// either sign, even and odd, absent, and as large as it may be. Decoders must show what is told here without the
/// encoder's own functions.
namespace render2mpeg::encoder::mpeg2 {
namespace {

using namespace testing;
using encoder::testing::decode_with_libmpeg2;

/// A non-intra block on grey: levels by their place in the scan, ascending, and their quantiser.
struct Corner {
    int quantiser = 1;
    std::vector<std::pair<int, int>> levels;  ///< scan, level
};

/// F''[v][u] of table 7-8's formula for the flat matrix, in the scan's order; no value saturates.
std::array<int, 64> dequantised(const Corner& corner) {
    std::array<int, 64> f{};
    for (const auto& [scan, level] : corner.levels) {
        const int sign = level < 0 ? -1 : 1;
        f[static_cast<std::size_t>(scan)] = ((2 * level + sign) * 16 * 2 * corner.quantiser) / 32;
    }
    return f;
}

/// The standard's own words: an even sum makes the last coefficient odd or even, whichever it is not.
void apply_mismatch_control(std::array<int, 64>& f) {
    int sum = 0;
    for (const int value : f) sum += value;
    if (sum % 2 == 0) f[63] += f[63] % 2 != 0 ? -1 : 1;
}

std::array<std::uint8_t, 64> on_grey(const std::array<int, 64>& f) {
    alignas(32) std::int16_t c[64] = {};
    for (std::size_t scan = 0; scan < 64; ++scan) c[place_of_scan[scan]] = static_cast<std::int16_t>(f[scan]);
    std::array<std::uint8_t, 64> out;
    out.fill(128);
    kernels().inverse_dct_add(c, out.data(), 8);
    return out;
}

/// Every corner: the last coefficient absent, small and largest, with others that make the sum even and odd.
std::vector<Corner> corners() {
    std::vector<Corner> all;
    for (const int q : {1, 2, 3, 31}) {
        const int highest = Quantiser::of(q).non_intra.highest[63];
        for (const int last : {0, 1, -1, 2, -2, highest - 1, 1 - highest, highest, -highest})
            for (const std::vector<std::pair<int, int>>& others :
                 std::vector<std::vector<std::pair<int, int>>>{{}, {{0, 40 / q + 1}}, {{3, -9}, {62, 5}}}) {
                Corner corner{q, others};
                if (last != 0) corner.levels.emplace_back(63, last);
                if (!corner.levels.empty()) all.push_back(corner);
            }
    }
    return all;
}

std::vector<RunLevel> runs_of(const Corner& corner) {
    std::vector<RunLevel> runs;
    int before = -1;
    for (const auto& [scan, level] : corner.levels) {
        runs.push_back({static_cast<std::uint8_t>(scan - before - 1), static_cast<std::int16_t>(level)});
        before = scan;
    }
    return runs;
}

TEST(MismatchControl, MeetsTheStandardInEveryCorner) {
    const std::vector<Corner> all = corners();
    ASSERT_EQ(all.size(), 4u * (9 * 3 - 1));
    std::vector<RowCode> code(rows);
    int in_force = quantiser;
    for (std::size_t m = 0; m < static_cast<std::size_t>(columns * rows); ++m) {
        RowCode& row = code[m / columns];
        if (m % columns == 0) in_force = quantiser;
        const Corner& corner = all[m % all.size()];
        MacroblockCode macroblock;
        macroblock.type.pattern = true;
        macroblock.type.quant = corner.quantiser != in_force;
        in_force = corner.quantiser;
        macroblock.quantiser = static_cast<std::uint8_t>(in_force);
        macroblock.pattern = 63;
        const std::vector<RunLevel> runs = runs_of(corner);
        for (int i = 0; i < 6; ++i) {
            row.runs.insert(row.runs.end(), runs.begin(), runs.end());
            macroblock.runs[i] = static_cast<std::uint8_t>(runs.size());
        }
        row.macroblocks.push_back(macroblock);
    }

    std::vector<RowCode> grey = plain_rows(plain_intra());
    PictureHeader header;
    header.type = PictureType::predicted;
    header.temporal_reference = 1;
    header.f_code[0][0] = header.f_code[0][1] = 3;
    std::vector<std::uint8_t> stream = access_unit(PictureHeader{}, grey, true);
    Libavcodec decoder;
    decoder.push(stream);
    const std::vector<std::uint8_t> second = access_unit(header, code, false);
    decoder.push(second);
    const std::vector<core::Picture> pictures = decoder.finish();
    stream.insert(stream.end(), second.begin(), second.end());
    const std::vector<std::uint8_t> end = sequence_end();
    stream.insert(stream.end(), end.begin(), end.end());
    const std::vector<core::Picture> others = decode_with_libmpeg2(stream);
    ASSERT_EQ(pictures.size(), 2u);
    ASSERT_EQ(others.size(), 2u);

    std::size_t seen = 0, largest = 0;
    for (std::size_t n = 0; n < all.size(); ++n) {
        std::array<int, 64> f = dequantised(all[n]);
        const std::array<std::uint8_t, 64> without = on_grey(f);
        const int before = f[63];
        apply_mismatch_control(f);
        const std::array<std::uint8_t, 64> expected = on_grey(f);
        seen += expected != without ? 1 : 0;
        largest += before != f[63] && std::abs(before) == 2047 ? 1 : 0;

        // The encoder's own.
        alignas(32) std::int16_t own[64] = {};
        const std::array<int, 64> plain = dequantised(all[n]);
        for (std::size_t scan = 0; scan < 64; ++scan) own[place_of_scan[scan]] = static_cast<std::int16_t>(plain[scan]);
        control_mismatch(own);
        EXPECT_EQ(own[63], f[63]) << n;

        const int column = static_cast<int>(n) % columns, row = static_cast<int>(n) / columns;
        for (int k = 0; k < 64; ++k) {
            const int x = column * 16 + k % 8, y = row * 16 + k / 8;
            ASSERT_EQ(pictures[1].y.at(x, y), expected[static_cast<std::size_t>(k)]) << "corner " << n;
            ASSERT_EQ(pictures[1].cb.at(x / 16 * 8 + k % 8, y / 16 * 8 + k / 8), expected[static_cast<std::size_t>(k)]);
            ASSERT_NEAR(others[1].y.at(x, y), expected[static_cast<std::size_t>(k)], 1)
                << "corner " << n << ", libmpeg2";
        }
    }
    EXPECT_GE(seen, 10u) << "pixels tell whether it was done";
    EXPECT_EQ(largest, 2u) << "2047 becomes 2046, and -2047 -2048";
}

}  // namespace
}  // namespace render2mpeg::encoder::mpeg2
