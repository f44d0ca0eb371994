#include "encoder/prediction.h"

#include <algorithm>

#include "core/error.h"

namespace render2mpeg::encoder {
namespace {

constexpr int side = 16;

/// Samples at half pixels are rounded means of two or four. [H262, 7.6.4]
void predict(const core::Plane<std::uint8_t>& reference, const MacroblockRecord& record, int left, int top,
             core::Plane<std::uint8_t>& out) {
    const int x_whole = record.motion_x >> 1, y_whole = record.motion_y >> 1;
    const int x_half = record.motion_x & 1, y_half = record.motion_y & 1;
    const int last_x = reference.width() - 1, last_y = reference.height() - 1;
    for (int y = top; y < std::min(top + side, out.height()); ++y) {
        const std::uint8_t* upper = reference.row(std::clamp(y + y_whole, 0, last_y));
        const std::uint8_t* lower = reference.row(std::clamp(y + y_whole + y_half, 0, last_y));
        for (int x = left; x < std::min(left + side, out.width()); ++x) {
            const int a = std::clamp(x + x_whole, 0, last_x), b = std::clamp(x + x_whole + x_half, 0, last_x);
            // Full-pixel samples are counted two or four times, which keeps their rounded mean.
            out.at(x, y) = static_cast<std::uint8_t>((upper[a] + upper[b] + lower[a] + lower[b] + 2) >> 2);
        }
    }
}

}  // namespace

core::Plane<std::uint8_t> prediction_of(const CodedPicture& coded, const core::Plane<std::uint8_t>& reference) {
    const core::Plane<std::uint8_t>& decoded = coded.reconstruction.y;
    EXPECTS(reference.width() == decoded.width() && reference.height() == decoded.height());
    core::Plane<std::uint8_t> prediction(decoded.width(), decoded.height(), 0);
    for (int row = 0; row < coded.macroblocks.height(); ++row)
        for (int column = 0; column < coded.macroblocks.width(); ++column) {
            const MacroblockRecord& record = coded.macroblocks.at(column, row);
            if (!record.intra) predict(reference, record, side * column, side * row, prediction);
        }
    return prediction;
}

}  // namespace render2mpeg::encoder
