#include "encoder/mpeg2/kernels/quantiser.h"

#include <algorithm>
#include <cstring>

#include "core/error.h"
#include "encoder/mpeg2/bitstream/codes.h"

namespace render2mpeg::encoder::mpeg2 {

namespace {

constexpr std::int32_t highest_coded_level = 2047;  // table B-16
constexpr std::int32_t highest_coefficient = 2047;  // saturation, 7.4.3

constexpr std::size_t transposed(std::size_t raster) {
    return raster % 8 * 8 + raster / 8;
}

constexpr std::array<std::uint8_t, 64> make_place_of_scan() {
    std::array<std::uint8_t, 64> places{};
    for (std::size_t i = 0; i < 64; ++i) places[i] = static_cast<std::uint8_t>(transposed(zigzag[i]));
    return places;
}
constexpr std::array<std::uint8_t, 64> make_scan_of_raster() {
    std::array<std::uint8_t, 64> scans{};
    for (std::size_t i = 0; i < 64; ++i) scans[zigzag[i]] = static_cast<std::uint8_t>(i);
    return scans;
}

/// Both kinds round to nearest: an intra level l stands for l steps, a non-intra one for l + 1/2, so that truncation is
/// nearest there. What rate makes dearer than it is worth goes afterwards, by real bits (block_coding.h).
Quantiser make(const Matrices& matrices, int code) {
    Quantiser q{};
    // No coefficient may saturate: decoders differ there. Coefficients of 8-bit samples reach these limits by rounding
    // errors alone.
    for (std::size_t i = 0; i < 64; ++i) {
        const std::size_t place = transposed(i);
        const std::int32_t intra = matrices.intra[i] * code, non_intra = matrices.non_intra[i] * code;
        q.intra.weight[place] = intra;
        q.intra.reciprocal[place] = i == 0 ? 0.0f : 8.0f / static_cast<float>(intra);
        q.intra.highest[place] = std::min(highest_coded_level, highest_coefficient * 8 / intra);
        q.non_intra.weight[place] = non_intra;
        q.non_intra.reciprocal[place] = 8.0f / static_cast<float>(non_intra);
        q.non_intra.highest[place] = std::min(highest_coded_level, (highest_coefficient * 16 / non_intra - 1) / 2);
    }
    for (QuantTable* table : {&q.intra, &q.non_intra})
        table->largest_reciprocal = *std::max_element(table->reciprocal, table->reciprocal + 64);
    q.intra.rounding = 0.5f;
    q.intra.reconstruction = 0;
    q.non_intra.rounding = 0.0f;
    q.non_intra.reconstruction = 1;
    return q;
}

}  // namespace

constinit const std::array<std::uint8_t, 64> place_of_scan = make_place_of_scan();
constinit const std::array<std::uint8_t, 64> scan_of_raster = make_scan_of_raster();

const Quantiser& Quantiser::of(int code) {
    return QuantiserSet::standard().of(code);
}

QuantiserSet::QuantiserSet(const Matrices& matrices) {
    EXPECTS(matrices.intra[0] == 8);
    for (const Matrix* matrix : {&matrices.intra, &matrices.non_intra})
        EXPECTS(std::find(matrix->begin(), matrix->end(), 0) == matrix->end());
    for (int code = 1; code <= 31; ++code) tables_[static_cast<std::size_t>(code - 1)] = make(matrices, code);
}

const Quantiser& QuantiserSet::of(int code) const {
    EXPECTS(code >= 1 && code <= 31);
    return tables_[static_cast<std::size_t>(code - 1)];
}

const QuantiserSet& QuantiserSet::standard() {
    static const QuantiserSet set{Matrices{}};
    return set;
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
