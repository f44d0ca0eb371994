#pragma once
// How many B pictures stand between two P pictures.
#include <cstdint>
#include <optional>

#include "encoder/types.h"

/// Decides types and references of pictures.
namespace render2mpeg::encoder::mpeg2 {

/// How far from an I or P picture the next P picture is to lie, >= 1, where `rest` >= 1 pictures of the GOP follow.
/// Runs of B pictures are as long as a look-ahead says, else as `most_b`, the motion's non-uniformity and the change of
/// light allow (PictureFacts), and as alike as the rest can be parted: so no lone picture is left over at the GOP's
/// end. `ends_intra`: the last run ends at the next GOP's I picture; none before it is longer.
std::int64_t next_reference_after(std::int64_t rest, bool ends_intra, int most_b, const PictureFacts& facts);

/// Decides types and references, in display order.
class PictureOrder {
  public:
    /// As in Settings.
    PictureOrder(int gop, int b_pictures) : gop_(gop), b_pictures_(b_pictures) {}

    /// Whether a GOP has to begin with the next picture.
    bool gop_is_over(std::int64_t number) const { return !last_ || number - gop_start_ >= gop_; }
    /// Everything of the next picture's plan but its quantiser. `may_open`: B pictures from this one on may refer to
    /// the next GOP's I picture, where that is promised.
    PicturePlan plan(std::int64_t number, const PictureFacts& facts, bool starts_gop, bool may_open);
    /// Whether an I picture stands in coding order where the picture planned last stands in display order.
    bool intra_stands_there() const { return last_ == intra_place_; }
    /// Promised pictures beyond those planned will not come.
    void cut_short() { later_ = last_.value_or(later_); }

    std::optional<std::int64_t> last() const { return last_; }  ///< number of the picture planned last

  private:
    int gop_, b_pictures_;
    std::optional<std::int64_t> last_;
    std::int64_t gop_start_ = 0;
    std::int64_t earlier_ = 0, later_ = 0;  ///< I or P pictures around the one planned last, or itself
    std::int64_t intra_place_ = 0;          ///< of the newest I picture in coding order
};

}  // namespace render2mpeg::encoder::mpeg2
