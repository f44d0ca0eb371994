#include "app/loop/pipeline.h"

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "app/loop/coding_terms.h"
#include "app/loop/coupling.h"
#include "app/loop/picture_coder.h"
#include "app/loop/preview.h"
#include "app/loop/scene_settings.h"
#include "app/loop/shown_light.h"
#include "app/loop/statistics_recorder.h"
#include "parallel/loops.h"
#include "perceptual/display.h"
#include "scene/preparation/traits.h"

namespace render2mpeg::app {
namespace {

/// Paths of a pixel of a frame by paths alone, at most. chosen: 65,536, some 0.4 CPU seconds.
constexpr std::uint64_t most_true_paths = 1u << 16;

class ChunkLoop {
  public:
    ChunkLoop(const RenderJob& job, renderer::Renderer& renderer, const Chunk& chunk, LoopObserver& observer,
              RunStatistics& statistics);

    void frame(std::int64_t n);
    void finish();

  private:
    renderer::Seen see(const scene::Snapshot& world);
    renderer::Seen complete(const scene::Snapshot& world, renderer::Seen seen, const core::ToleranceMap& tolerance,
                            int quantiser);
    /// Plan of the frame; meaningless without a coder.
    encoder::PicturePlan plan(const scene::Snapshot& world, Motion& motion);
    /// Tolerances of the frame's light. Valid until the next frame.
    const core::ToleranceMap& tolerate(const scene::Snapshot& world, const renderer::Seen& seen,
                                       const PlannedPicture& plan, Motion& motion);
    /// Rough light in place of a previous picture.
    void imagine(const scene::Snapshot& world, const renderer::Seen& seen, const PlannedPicture& plan);
    core::Radiance shade(const scene::Snapshot& world, const core::ToleranceMap& tolerance, const renderer::Seen& seen);
    core::Radiance draft(const scene::Snapshot& world, const renderer::Seen& seen, const core::ToleranceMap& tolerance,
                         RenderedMotion& motion);
    core::Picture develop(const core::Radiance& radiance, std::int64_t n);
    /// Keeps a picture for the coupling until it is coded.
    void keep(const core::Picture& picture, const core::Radiance& radiance, const renderer::Seen& seen,
              const PlannedPicture& plan);
    void take(const std::vector<encoder::CodedPicture>& pictures);

    const RenderJob& job_;
    renderer::Renderer& renderer_;
    const Chunk& chunk_;
    RunStatistics& statistics_;
    perceptual::Display display_;
    ShownLight shown_;
    PosedFrames posed_;
    StatisticsRecorder recorder_;
    Auditor auditor_;
    LoopObservers observers_;
    std::optional<PictureCoder> coder_;  ///< none: pictures are not coded
    CodingTerms terms_;
    std::optional<Coupling> coupling_;  ///< none: tolerances are fixed
    core::ToleranceMap tolerance_;
};

ChunkLoop::ChunkLoop(const RenderJob& job, renderer::Renderer& renderer, const Chunk& chunk, LoopObserver& observer,
                     RunStatistics& statistics)
    : job_(job),
      renderer_(renderer),
      chunk_(chunk),
      statistics_(statistics),
      display_(job.display()),
      shown_(job, statistics),
      posed_(job),
      recorder_(statistics, job.kind == OutputKind::film),
      auditor_(renderer, display_, job.audit, statistics),
      terms_(job.coding) {
    renderer.start_chunk(*posed_.at(chunk.first));
    if (job.kind == OutputKind::film)
        coder_.emplace(job.film(), chunk, job.allocations, shots_of(*job.animation), statistics,
                       !job.rough && scene::traits_of(*job.animation).lights_change);
    if (job.tolerance.coupled && coder_)
        coupling_.emplace(display_, job.coupling);
    else
        tolerance_ = job.tolerance_map();
    observers_.add(recorder_);
    if (job.audit > 0) observers_.add(auditor_);
    observers_.add(observer);
}

void ChunkLoop::frame(std::int64_t n) {
    const FrameTimer timer(statistics_);
    const std::shared_ptr<const scene::Snapshot> world = posed_.at(n);
    renderer::Seen seen = see(*world);
    RenderedMotion motion(job_, posed_, seen.visible, *world, statistics_, &seen.imaged);

    // Plan its coding, and tolerances by it and the eye.
    const encoder::PicturePlan coding = plan(*world, motion);
    const PlannedPicture planned = terms_.planned(coding);
    const core::ToleranceMap& tolerance = tolerate(*world, seen, planned, motion);

    // Light it; a rough look counts apart.
    const renderer::Statistics before = renderer_.statistics();
    seen = complete(*world, std::move(seen), tolerance, coding.quantiser);
    const core::Radiance radiance =
        job_.preview ? draft(*world, seen, tolerance, motion) : shade(*world, tolerance, seen);
    const core::Radiance& shown = shown_.of(radiance, world->time);
    const core::Picture picture = develop(shown, n);

    // A lit frame is kept, whatever stops.
    const parallel::StopWhen never({});
    observers_.lit({*world, seen, tolerance, radiance, shown, picture, motion, before, renderer_.statistics()});

    // Code it with the renderer's own motion.
    if (coder_) statistics_.frames.back().type = "-IPB"[static_cast<int>(coding.type)];
    keep(picture, shown, seen, planned);
    if (coder_) take(coder_->code(picture, coding, motion));
}

void ChunkLoop::finish() {
    if (coder_) take(coder_->flush());
}

renderer::Seen ChunkLoop::see(const scene::Snapshot& world) {
    const StageTimer timer(statistics_, Stage::see);
    return renderer_.see(world);
}

renderer::Seen ChunkLoop::complete(const scene::Snapshot& world, renderer::Seen seen,
                                   const core::ToleranceMap& tolerance, int quantiser) {
    const StageTimer timer(statistics_, Stage::shade);
    const renderer::ExposureSamples samples = exposure_samples(job_, quantiser, display_);
    return renderer_.complete(world, std::move(seen), &tolerance, &samples);
}

encoder::PicturePlan ChunkLoop::plan(const scene::Snapshot& world, Motion& motion) {
    const parallel::StopWhen never({});
    return coder_ ? coder_->plan(world.frame, world.cut_before, motion) : encoder::PicturePlan();
}

const core::ToleranceMap& ChunkLoop::tolerate(const scene::Snapshot& world, const renderer::Seen& seen,
                                              const PlannedPicture& plan, Motion& motion) {
    if (!coupling_) return tolerance_;
    if (world.cut_before || plan.number == chunk_.first) coupling_->forget();
    if (!coupling_->remembers()) imagine(world, seen, plan);
    const std::int64_t reference = coupling_->remembered();
    const core::MotionField* field = reference == plan.number ? nullptr : motion.to(reference);
    const StageTimer timer(statistics_, Stage::tolerate);
    tolerance_ = coupling_->tolerate(seen.visible, plan, field);
    shown_.carry_back(tolerance_);
    return tolerance_;
}

void ChunkLoop::imagine(const scene::Snapshot& world, const renderer::Seen& seen, const PlannedPicture& plan) {
    const core::Radiance rough = [&] {
        const StageTimer timer(statistics_, Stage::preview);
        return preview(renderer_, world, renderer_.complete(world, seen, nullptr));
    }();
    const core::Radiance& shown = shown_.of(rough, world.time);
    const StageTimer timer(statistics_, Stage::tolerate);
    core::Picture picture = display_.develop(shown);
    picture.number = plan.number;
    coupling_->imagine(picture, shown, seen.visible, plan);
}

core::Radiance ChunkLoop::shade(const scene::Snapshot& world, const core::ToleranceMap& tolerance,
                                const renderer::Seen& seen) {
    const StageTimer timer(statistics_, Stage::shade);
    if (job_.tolerance.truth) return renderer_.trace(world, seen, {*job_.tolerance.truth, most_true_paths});
    return renderer_.shade(world, seen, tolerance);
}

core::Radiance ChunkLoop::draft(const scene::Snapshot& world, const renderer::Seen& seen,
                                const core::ToleranceMap& tolerance, RenderedMotion& motion) {
    const bool goes_on = world.frame > chunk_.first && !world.cut_before;
    const core::MotionField* to_before = goes_on ? &motion.exact_to(world.frame - 1) : nullptr;
    const StageTimer timer(statistics_, Stage::shade);
    return renderer_.draft(world, seen, tolerance, to_before);
}

core::Picture ChunkLoop::develop(const core::Radiance& radiance, std::int64_t n) {
    const StageTimer timer(statistics_, Stage::develop);
    core::Picture picture = display_.develop(radiance);
    picture.number = n;
    return picture;
}

void ChunkLoop::keep(const core::Picture& picture, const core::Radiance& radiance, const renderer::Seen& seen,
                     const PlannedPicture& plan) {
    if (!coupling_) return;
    const StageTimer timer(statistics_, Stage::tolerate);
    coupling_->keep(picture, radiance, seen.visible, plan);
}

void ChunkLoop::take(const std::vector<encoder::CodedPicture>& pictures) {
    for (const encoder::CodedPicture& coded : pictures) {
        if (coupling_) {
            const StageTimer timer(statistics_, Stage::tolerate);
            if (const std::optional<JudgedPicture> judged = terms_.coded(coded)) coupling_->judge(*judged);
        }
        observers_.coded(coded);
    }
}

}  // namespace

bool render_chunk(const RenderJob& job, renderer::Renderer& renderer, const Chunk& chunk, LoopObserver& observer,
                  RunStatistics& statistics, const std::function<bool()>& frame_done,
                  const std::function<bool()>& stops) {
    observer.begins(chunk);
    std::optional<ChunkLoop> loop;
    bool whole = true;
    try {
        const parallel::StopWhen stop(stops);
        loop.emplace(job, renderer, chunk, observer, statistics);
        for (std::int64_t n = chunk.first; n <= chunk.last && whole; ++n) {
            loop->frame(n);
            whole = frame_done() || n == chunk.last;
        }
    } catch (const parallel::Stopped&) {
        whole = false;
    }
    if (loop) loop->finish();
    if (whole) observer.ends(chunk);
    return whole;
}

}  // namespace render2mpeg::app
