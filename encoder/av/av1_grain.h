#pragma once
// Film grain that AV1's decoders add.
#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "encoder/av/access_unit.h"
#include "encoder/av/av1_headers.h"
#include "encoder/av/grain_table.h"

namespace render2mpeg::av {

/// Writes film grain into the headers of coded pictures [AV1, 5.9.30]: a table, and each frame a seed by its display
/// number. Pictures are coded without it, and decoders add it behind their references [AV1, 7.18.3].
class Av1Grain {
  public:
    /// Grain from the next key frame on; at first there is none.
    void set_table(GrainTable table) { table_ = std::move(table); }

    /// A temporal unit with the grain of its frames; they come in coding order. `number`: display number of the frame
    /// that is shown. Throws as Av1Headers does.
    std::vector<std::uint8_t> with_grain(std::span<const std::uint8_t> unit, std::int64_t number);

  private:
    using BitRow = std::vector<bool>;

    void append_frame(std::vector<std::uint8_t>& out, const Obu& obu, std::int64_t number, bool has_tiles);
    /// film_grain_params() of a frame.
    BitRow parameters(const Av1FrameHeader& frame, std::int64_t number);

    GrainTable table_;
    Av1Headers headers_;
    std::array<bool, 8> has_grain_{};  ///< of references
    std::int64_t first_number_ = 0;    ///< of the group's key frame
    int first_hint_ = 0;
};

}  // namespace render2mpeg::av
