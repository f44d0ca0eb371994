#pragma once
// Motion vectors in half pixels, and how they are coded.
#include <algorithm>
#include <cstdint>
#include <vector>

#include "encoder/mpeg2/bitstream/bit_writer.h"

/// Motion vectors and prediction modes, their ranges, and how vectors are coded.
namespace render2mpeg::encoder::mpeg2 {

/// A motion vector in half pixels, y down.
struct Vector {
    std::int16_t x = 0, y = 0;

    bool operator==(const Vector&) const = default;
    bool is_zero() const { return x == 0 && y == 0; }
};

/// The smallest and largest components of vectors, zero among them.
struct VectorExtent {
    Vector low, high;

    void include(Vector v) {
        low = {std::min(low.x, v.x), std::min(low.y, v.y)};
        high = {std::max(high.x, v.x), std::max(high.y, v.y)};
    }
};

/// How a macroblock is predicted: direction 0 is forward (from an earlier picture), 1 backward (from a later one);
/// both: the mean of the two. Neither: not predicted. A direction that is not used still has a vector where it stands
/// for what the stream predicts the next one from.
struct PredictionMode {
    Vector vector[2];
    bool uses[2] = {true, false};

    bool operator==(const PredictionMode&) const = default;
};

/// Vectors that a macroblock may use; both ends belong to it. It always holds the zero vector.
struct VectorRange {
    int low_x, high_x, low_y, high_y;

    bool contains(Vector v) const { return v.x >= low_x && v.x <= high_x && v.y >= low_y && v.y <= high_y; }
    /// The nearest vector inside; takes any numbers.
    Vector clamp(int x, int y) const {
        return {static_cast<std::int16_t>(std::clamp(x, low_x, high_x)),
                static_cast<std::int16_t>(std::clamp(y, low_y, high_y))};
    }
    Vector clamp(Vector v) const { return clamp(v.x, v.y); }
};

/// Vectors that keep the prediction of macroblock (column, row) inside the picture [H262, 7.6.3.8] and that the f_codes
/// can express: -16 * 2^(f_code - 1) .. 16 * 2^(f_code - 1) - 1. [H262, table 7-8]
VectorRange vector_range(int column, int row, int columns, int rows, int horizontal_f_code, int vertical_f_code);

/// The smallest f_code, at least 1, for components from `low` to `high`.
int f_code_for(int low, int high);

/// Bits of one component's difference from its prediction. Both lie in the range of the f_code.
int component_bits(int difference, int f_code);

/// Bits by which a component may grow where it is written with a smaller f_code than it was decided with: short codes
/// with many residual bits become long ones with few. The most over all f_codes and differences (test).
inline constexpr int f_code_margin = 4;

/// The same from a table, for differences up to twice that range; beyond costs more than all within.
class ComponentBits {
  public:
    explicit ComponentBits(int f_code);
    int operator()(int difference) const {
        const int i = difference + reach_;
        return i >= 0 && i < 2 * reach_ ? bits_[static_cast<std::size_t>(i)] : beyond_;
    }

  private:
    int reach_;
    int beyond_;
    std::vector<std::uint8_t> bits_;
};

/// Writes one component as motion_code and motion_residual. [H262, 7.6.3.1]
void write_component(BitWriter& out, int difference, int f_code);

}  // namespace render2mpeg::encoder::mpeg2
