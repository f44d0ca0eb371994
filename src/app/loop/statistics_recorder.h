#pragma once
// Records the statistics of pictures between their making and their coding.
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "app/loop/observer.h"
#include "app/loop/run_statistics.h"
#include "core/motion_field.h"
#include "core/picture.h"
#include "core/plane.h"
#include "encoder/types.h"
#include "perceptual/display.h"
#include "renderer/renderer.h"

namespace render2mpeg::app {

/// Adds an entry for every frame of a chunk to the statistics. Frames come one after the other.
class StatisticsRecorder : public LoopObserver {
  public:
    /// `coded`: pictures are going to be coded, and kept until then.
    StatisticsRecorder(RunStatistics& statistics, bool coded)
        : statistics_(statistics), first_(statistics.frames.size()), coded_(coded) {}

    /// Opens the entry of a frame with what gathering its light took: the growth of the renderer's counts.
    void lit(const LitFrame& frame) override;
    void lit_before(const LitFrame& frame) override { lit(frame); }
    void read(const core::Picture& picture, const core::MotionField* motion) override;
    /// Completes the entry of a picture that was coded.
    void coded(const encoder::CodedPicture& coded) override;

  private:
    /// A picture that is coded, and the one before it.
    struct Step {
        bool known = false;                       ///< there is one before, and how it moved from there
        std::optional<core::MotionField> motion;  ///< to the one before; none: nothing moves
        core::Plane<std::int16_t> error;          ///< of luma; empty: not coded yet
    };

    FrameEntry& entry_of(std::int64_t number);
    /// Keeps the motion that the picture came by; it is the encoder's later.
    void keep(const core::Picture& picture, bool known, const core::MotionField* motion);
    /// Measures the picture's pumping where it and the one before are coded.
    void measure_pumping(std::int64_t number);

    RunStatistics& statistics_;
    std::size_t first_;
    bool coded_;
    std::map<std::int64_t, core::Picture> waiting_;
    std::map<std::int64_t, Step> steps_;  ///< of pictures whose pumping, or that of the next, is still to be measured
};

/// Gathers some pixels of every frame again without clustering, finds their truth by paths, and adds their errors to
/// the statistics.
class Auditor : public LoopObserver {
  public:
    /// `pixels` of each frame, which `display` shows.
    Auditor(renderer::Renderer& renderer, const perceptual::Display& display, int pixels, RunStatistics& statistics)
        : renderer_(renderer), display_(display), pixels_(pixels), statistics_(statistics) {}

    void lit(const LitFrame& frame) override;

  private:
    /// A pixel whose point is looked for in the next frame.
    struct Point {
        glm::ivec2 place{0};
        std::uint32_t object = 0;
        float depth = 0;
        renderer::CodeErrors errors{};
    };

    double luma(glm::vec3 light) const { return static_cast<double>(perceptual::luma_of(display_, light)); }
    /// Adds what errors changed by where this frame shows the points of the frame before.
    void follow(const LitFrame& frame);
    /// Places in this frame that show those points: at most one of each.
    std::vector<std::optional<glm::ivec2>> places_of_points(const LitFrame& frame) const;
    /// Keeps some of the pixels for the next frame.
    void keep(const LitFrame& frame, std::span<const renderer::ValidatedPixel> pixels);

    std::vector<Point> before_;
    std::int64_t next_ = -1;  ///< frame that follows the one of `before_`
    renderer::Renderer& renderer_;
    const perceptual::Display& display_;
    int pixels_;
    RunStatistics& statistics_;
};

}  // namespace render2mpeg::app
