#pragma once
// Renews macroblocks by intra coding before decoders' inverse transforms drift apart.
#include <cstdint>

#include "core/plane.h"
#include "encoder/types.h"

/// Says when a macroblock must be intra again.
namespace render2mpeg::encoder::mpeg2 {

/// Decoders' inverse transforms round differently, and what they differ by adds up from one P picture to the next: a
/// macroblock is renewed before it is coded 132 times in P pictures. Skipped ones and B pictures do not count.
/// [H262, annex A]
inline constexpr int most_predictions = 131;

/// Counts for each macroblock how often it was coded in P pictures since it was intra, and says when it is due.
class IntraRefresh {
  public:
    IntraRefresh(int columns, int rows) : predictions_(columns, rows), due_(columns, rows) {}

    /// 1 where the next P picture has to be intra. Macroblocks come due at different times, so that no picture has to
    /// renew all of them.
    const core::Plane<std::uint8_t>& due() const { return due_; }
    /// Takes notice of a picture as it was coded.
    void record(PictureType type, const core::Plane<MacroblockRecord>& macroblocks);

  private:
    core::Plane<std::uint8_t> predictions_;
    core::Plane<std::uint8_t> due_;
};

}  // namespace render2mpeg::encoder::mpeg2
