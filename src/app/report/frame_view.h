#pragma once
// The middle of a frame, for a page.
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "app/loop/observer.h"
#include "app/options/film.h"
#include "core/picture.h"
#include "core/plane.h"
#include "perceptual/display.h"
#include "perceptual/heatmap.h"

namespace render2mpeg::app {

/// Central crop of pictures of this size, for a report: pixel for pixel, since downscaling hides coding artefacts.
struct ViewBox {
    int left = 0, top = 0, width = 0, height = 0;  ///< left and top are even
};
ViewBox view_of(int width, int height);

/// The part of a plane or picture that a box shows. The picture's planes keep their siting.
core::Picture part_of(const core::Picture& picture, const ViewBox& box);
core::Plane<float> part_of(const core::Plane<float>& plane, const ViewBox& box);

struct ShownPicture {
    std::string name;
    core::Picture picture;
};

/// How wide a picture is shown where the page has room: thumbnails enlarged by a whole number, which keeps their pixels
/// square.
int shown_width(int width);

/// A picture as a PNG file within the page.
std::string source_of(const std::string& name, const core::Picture& picture, const perceptual::PictureColors& colors);

/// Two pictures of one size that a page shows upon each other, with a slider; `with_difference`: and a switch to the
/// difference of the two, amplified, on grey.
nlohmann::json pair_of(const std::string& title, const ShownPicture& left, const ShownPicture& right,
                       const perceptual::PictureColors& colors, bool with_difference);

/// Values in false colours with their legend.
nlohmann::json heat_of(const std::string& title, const core::Plane<float>& values, const perceptual::HeatScale& scale);

/// Keeps the middle of one frame of a render for its report: as lit, as decoded, and the tolerance of its light.
class SampleFrameObserver : public LoopObserver {
  public:
    /// The frame in the middle of the film.
    explicit SampleFrameObserver(const RenderJob& film);

    /// Whether the frame that is kept is among these.
    bool is_in(const Chunk& chunk) const { return frame_ >= chunk.first && frame_ <= chunk.last; }
    /// Restores the output of figures() from the run that made the frame.
    void take_up(const nlohmann::json& figures) { earlier_ = figures; }

    void lit(const LitFrame& frame) override;
    void coded(const encoder::CodedPicture& coded) override;

    /// For a page: a pair where the frame was coded, and false colours where its tolerances differ. Null where the
    /// frame was not made.
    nlohmann::json figures() const;

  private:
    std::int64_t frame_;
    encoder::Codec codec_;
    perceptual::PictureColors colors_;
    std::optional<core::Picture> lit_, decoded_;
    core::Plane<float> tolerance_, error_;  ///< over luminance; empty: not known
    nlohmann::json earlier_;                ///< of an earlier run
    std::string coding_;                    ///< "a B picture, quantiser 6, 1.2 kB"
};

}  // namespace render2mpeg::app
