#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "app/job/render_job.h"
#include "app/loop/run_statistics.h"
#include "core/motion_field.h"
#include "core/visible.h"
#include "scene/pose/motion.h"
#include "scene/pose/snapshot.h"

namespace render2mpeg::app {

/// Motion of one frame's pixels to other frames. Each field is found once.
class Motion {
  public:
    virtual ~Motion() = default;

    /// To another frame; null where nothing moves or motion is unknown. Valid until take().
    const core::MotionField* to(std::int64_t reference);
    /// Moves out the fields to these frames; empty where to() gives null.
    std::vector<core::MotionField> take(std::span<const std::int64_t> references);
    /// To the last picture that depends on this one; null: unknown. Valid until take().
    virtual const core::MotionField* onward(std::int64_t horizon) { return to(horizon); }

  private:
    virtual std::optional<core::MotionField> find(std::int64_t reference) = 0;

    std::map<std::int64_t, core::MotionField> found_;
};

/// An instant as each eye looks at it, in the order of eyes_of().
using EyeSnapshots = std::vector<std::shared_ptr<const scene::Snapshot>>;

/// Snapshots of recently used frames.
class PosedFrames {
  public:
    explicit PosedFrames(const RenderJob& job) : job_(job) {}
    EyeSnapshots at(std::int64_t frame);

  private:
    const RenderJob& job_;
    std::vector<EyeSnapshots> latest_;  ///< the last one asked for comes last
};

/// All that motion needs to know of an eye's view.
struct SeenByEye {
    core::Visible visible;
    scene::MirrorImages imaged{};
};

/// Exact motion of a rendered frame.
class RenderedMotion : public Motion {
  public:
    /// `seen` shows `worlds`, eye by eye; references must outlive it. Time counts as the pass `motion`.
    RenderedMotion(const RenderJob& job, PosedFrames& posed, std::vector<SeenByEye> seen, EyeSnapshots worlds,
                   RunStatistics& statistics)
        : job_(job), posed_(posed), seen_(std::move(seen)), worlds_(std::move(worlds)), statistics_(statistics) {}

    /// As to(), also where nothing moves.
    const core::MotionField& exact_to(std::int64_t reference);
    /// Never null.
    const core::MotionField* onward(std::int64_t horizon) override;

  private:
    std::optional<core::MotionField> find(std::int64_t reference) override;
    core::MotionField between(std::int64_t reference);

    const RenderJob& job_;
    PosedFrames& posed_;
    std::vector<SeenByEye> seen_;
    EyeSnapshots worlds_;
    RunStatistics& statistics_;
    std::map<std::int64_t, core::MotionField> still_;  ///< fields of a scene in which nothing moves
};

}  // namespace render2mpeg::app
