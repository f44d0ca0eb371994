#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "app/loop/observer.h"
#include "app/options/film.h"
#include "app/report/frame_view.h"

namespace render2mpeg::app {

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
    perceptual::ColorMatrix matrix_;
    std::optional<core::Picture> lit_, decoded_;
    core::Plane<float> tolerance_, error_;  ///< over luminance; empty: not known
    nlohmann::json earlier_;                ///< of an earlier run
    std::string coding_;                    ///< "a B picture, quantiser 6, 1.2 kB"
};

}  // namespace render2mpeg::app
