#include "encoder/mpeg2/macroblock/intra_refresh.h"

#include <algorithm>

namespace render2mpeg::encoder::mpeg2 {
namespace {

/// P pictures by which a macroblock is renewed too early.
/// chosen: 0..31, so that a thirty-second of a picture is renewed at a time (a pattern without rows or columns).
int early(int column, int row) {
    return (column * 5 + row * 13) % 32;
}

}  // namespace

void IntraRefresh::record(PictureType type, const core::Plane<MacroblockRecord>& macroblocks) {
    if (type == PictureType::bidirectional) return;
    EXPECTS(macroblocks.width() == due_.width() && macroblocks.height() == due_.height());
    for (int row = 0; row < due_.height(); ++row)
        for (int column = 0; column < due_.width(); ++column) {
            const MacroblockRecord& m = macroblocks.at(column, row);
            std::uint8_t& count = predictions_.at(column, row);
            // Minimal pictures renew nothing, however long that is due.
            count = static_cast<std::uint8_t>(m.intra ? 0 : std::min(255, count + (m.skipped ? 0 : 1)));
            due_.at(column, row) = count >= most_predictions - early(column, row) ? 1 : 0;
        }
}

}  // namespace render2mpeg::encoder::mpeg2
