#pragma once
// The default quantiser matrices, and how they are kept.
#include <array>
#include <cstdint>

/// Quantiser matrices as the stream has them.
namespace render2mpeg::encoder::mpeg2 {

/// Entries of a quantiser matrix in raster order, 1..255.
using Matrix = std::array<std::uint8_t, 64>;

/// The default matrices [H262, 6.3.11]; the non-intra one is flat 16.
extern const Matrix default_intra_matrix, default_non_intra_matrix;

struct Matrices {
    Matrix intra = default_intra_matrix;  ///< its first entry must be 8
    Matrix non_intra = default_non_intra_matrix;

    bool operator==(const Matrices&) const = default;
};

}  // namespace render2mpeg::encoder::mpeg2
