#include "encoder/mpeg2/quantiser.h"

#include <algorithm>
#include <cstring>

#include "core/error.h"
#include "encoder/mpeg2/codes.h"

namespace render2mpeg::encoder::mpeg2 {

const std::array<std::uint8_t, 64> default_intra_matrix = {
    8,  16, 19, 22, 26, 27, 29, 34, 16, 16, 22, 24, 27, 29, 34, 37, 19, 22, 26, 27, 29, 34,
    34, 38, 22, 22, 26, 27, 29, 34, 37, 40, 22, 26, 27, 29, 32, 35, 40, 48, 26, 27, 29, 32,
    35, 40, 48, 58, 26, 27, 29, 34, 38, 46, 56, 69, 27, 29, 35, 38, 46, 56, 69, 83};

namespace {

constexpr int flat_weight = 16;
constexpr std::int32_t highest_coded_level = 2047;  // table B-16
constexpr std::int32_t highest_coefficient = 2047;  // saturation, 7.4.3

constexpr std::size_t transposed(std::size_t raster) {
    return raster % 8 * 8 + raster / 8;
}

std::array<std::uint8_t, 64> make_place_of_scan() {
    std::array<std::uint8_t, 64> places{};
    for (std::size_t i = 0; i < 64; ++i) places[i] = static_cast<std::uint8_t>(transposed(zigzag[i]));
    return places;
}
std::array<std::uint8_t, 64> make_scan_of_raster() {
    std::array<std::uint8_t, 64> scans{};
    for (std::size_t i = 0; i < 64; ++i) scans[zigzag[i]] = static_cast<std::uint8_t>(i);
    return scans;
}

/// Both kinds round to nearest: an intra level l stands for l steps, a non-intra one for l + 1/2, so that truncation is
/// nearest there. What rate makes dearer than it is worth goes afterwards, by real bits (block_coding.h).
Quantiser make(int code) {
    Quantiser q{};
    // No coefficient may saturate: decoders differ there. Coefficients of 8-bit samples reach these limits by rounding
    // errors alone.
    for (std::size_t i = 0; i < 64; ++i) {
        const std::size_t place = transposed(i);
        const std::int32_t intra = default_intra_matrix[i] * code, non_intra = flat_weight * code;
        q.intra.weight[place] = intra;
        q.intra.reciprocal[place] = i == 0 ? 0.0f : 8.0f / static_cast<float>(intra);
        q.intra.highest[place] = std::min(highest_coded_level, highest_coefficient * 8 / intra);
        q.non_intra.weight[place] = non_intra;
        q.non_intra.reciprocal[place] = 8.0f / static_cast<float>(non_intra);
        q.non_intra.highest[place] = std::min(highest_coded_level, (highest_coefficient * 16 / non_intra - 1) / 2);
    }
    q.intra.rounding = 0.5f;
    q.intra.reconstruction = 0;
    q.non_intra.rounding = 0.0f;
    q.non_intra.reconstruction = 1;
    return q;
}

}  // namespace

const std::array<std::uint8_t, 64> place_of_scan = make_place_of_scan();
const std::array<std::uint8_t, 64> scan_of_raster = make_scan_of_raster();

const Quantiser& Quantiser::of(int code) {
    EXPECTS(code >= 1 && code <= 31);
    static const std::array<Quantiser, 31> all = [] {
        std::array<Quantiser, 31> tables;
        for (int c = 1; c <= 31; ++c) tables[static_cast<std::size_t>(c - 1)] = make(c);
        return tables;
    }();
    return all[static_cast<std::size_t>(code - 1)];
}

void control_mismatch(std::int16_t* coefficients) {
    // A sum is odd when the exclusive or of its terms is.
    std::uint64_t all = 0;
    for (int i = 0; i < 64; i += 4) {
        std::uint64_t four;
        std::memcpy(&four, coefficients + i, sizeof four);
        all ^= four;
    }
    all ^= all >> 32;
    all ^= all >> 16;
    if ((all & 1) == 0) coefficients[63] = static_cast<std::int16_t>(coefficients[63] ^ 1);
}

}  // namespace render2mpeg::encoder::mpeg2
