#include "encoder/mpeg2/bitstream/vector.h"

#include <cstdlib>

#include "encoder/mpeg2/bitstream/codes.h"

namespace render2mpeg::encoder::mpeg2 {
namespace {

/// A difference as the stream has it: taken modulo the range of vectors.
struct Component {
    int magnitude;  ///< of motion_code, 0..16
    bool negative;
    int residual;  ///< r_size = f_code - 1 bits
};

Component component_of(int difference, int f_code) {
    const int r_size = f_code - 1;
    const int range = 32 << r_size;
    if (difference < -range / 2) difference += range;
    if (difference >= range / 2) difference -= range;
    if (difference == 0) return {0, false, 0};
    const int magnitude = std::abs(difference) - 1;
    return {(magnitude >> r_size) + 1, difference < 0, magnitude & ((1 << r_size) - 1)};
}

}  // namespace

VectorRange vector_range(int column, int row, int columns, int rows, int horizontal_f_code, int vertical_f_code) {
    const int reach_x = 16 << (horizontal_f_code - 1), reach_y = 16 << (vertical_f_code - 1);
    return {std::max(-32 * column, -reach_x), std::min(32 * (columns - 1 - column), reach_x - 1),
            std::max(-32 * row, -reach_y), std::min(32 * (rows - 1 - row), reach_y - 1)};
}

int f_code_for(int low, int high) {
    int f_code = 1;
    while (low < -(16 << (f_code - 1)) || high > (16 << (f_code - 1)) - 1) ++f_code;
    return f_code;
}

int component_bits(int difference, int f_code) {
    const Component c = component_of(difference, f_code);
    if (c.magnitude == 0) return motion_codes[0].length;
    return motion_codes[static_cast<std::size_t>(c.magnitude)].length + 1 + (f_code - 1);
}

ComponentBits::ComponentBits(int f_code) : reach_(32 << (f_code - 1)), beyond_(motion_codes[16].length + 1 + f_code) {
    bits_.reserve(static_cast<std::size_t>(2 * reach_));
    for (int d = -reach_; d < reach_; ++d) bits_.push_back(static_cast<std::uint8_t>(component_bits(d, f_code)));
}

void write_component(BitWriter& out, int difference, int f_code) {
    const Component c = component_of(difference, f_code);
    out.put(motion_codes[static_cast<std::size_t>(c.magnitude)]);
    if (c.magnitude == 0) return;
    out.put(c.negative ? 1 : 0, 1);
    out.put(static_cast<std::uint32_t>(c.residual), f_code - 1);
}

}  // namespace render2mpeg::encoder::mpeg2
