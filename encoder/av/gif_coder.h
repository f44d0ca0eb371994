#pragma once
// Our own coder of GIF films [GIF89a].
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/plane.h"
#include "encoder/av/rgb_picture.h"
#include "encoder/coder.h"

namespace render2mpeg::av {

/// Codes each picture at once: what changed since its pixel was last painted, with a palette of just that, dithered
/// [Floyd1976]. So a scene has more than 256 colours, and dither rests where the picture does. A chunk begins with a
/// whole picture. Where films have alpha, each picture stands alone, and pixels of less than a half are open.
class GifCoder final : public encoder::Coder {
  public:
    /// Settings that av::check lets pass.
    explicit GifCoder(const encoder::Settings& settings);

    encoder::PicturePlan plan(std::int64_t number, const encoder::PictureFacts& facts, bool first_of_chunk) override;
    std::vector<encoder::CodedPicture> push(const core::Picture& picture, const encoder::PicturePlan& plan,
                                            std::span<const core::MotionField> motion,
                                            const encoder::Hints& hints) override;
    std::vector<encoder::CodedPicture> flush() override { return {}; }

  private:
    struct Part {
        int left, top, right, bottom;  ///< right and bottom lie behind it
    };

    Rgb wanted(const core::Picture& picture, int x, int y) const;
    /// Marks what is to be painted; none: nothing is.
    std::optional<Part> find_changes(const core::Picture& picture, bool whole);
    /// Indices of the part's pixels; the index behind the palette's is transparent.
    std::vector<std::uint8_t> paint(const Part& part, const class GifPalette& palette);

    const encoder::Settings settings_;
    const RgbMatrix matrix_;
    std::optional<std::int64_t> last_;  ///< that was planned
    std::int64_t coding_order_ = 0;
    core::Plane<Rgb> wanted_;           ///< of this picture
    core::Plane<Rgb> painted_;          ///< wanted where a pixel was last painted
    core::Plane<Rgb> shown_;            ///< whole code values
    core::Plane<std::uint8_t> is_new_;  ///< pixels that are painted
};

/// Throws core::Error where GIF cannot show so many pictures per second.
void check_gif(const encoder::Settings& settings);

}  // namespace render2mpeg::av
