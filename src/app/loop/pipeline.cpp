#include "app/loop/pipeline.h"

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "app/loop/coupling.h"
#include "app/loop/glare_filter.h"
#include "app/loop/grain_cost.h"
#include "app/loop/picture_coder.h"
#include "app/loop/scene_settings.h"
#include "app/loop/statistics_recorder.h"
#include "parallel/loops.h"
#include "perceptual/display.h"
#include "renderer/view/mattes.h"
#include "scene/preparation/traits.h"

namespace render2mpeg::app {
namespace {

/// Paths of a pixel of a frame by paths alone, at most. chosen: 65,536, some 0.4 CPU seconds.
constexpr std::uint64_t most_true_paths = 1u << 16;

/// Of a first rough look, as a share of light. chosen: 0.3 of 0.1 to 0.6, which light the frame alike in half to a
/// quarter of the time.
constexpr float rough_tolerance = 0.3f;

class ChunkLoop {
  public:
    ChunkLoop(const RenderJob& job, renderer::Renderer& renderer, const Chunk& chunk, LoopObserver& observer,
              RunStatistics& statistics, KeptFrames* kept);

    void frame(std::int64_t n);
    /// A frame that an earlier run lit. The last of them brings the state that they left.
    void repeat(std::int64_t n);
    /// Keeps the frames so far for a later run.
    void keep(bool at_once);
    /// `whole`: all frames were lit.
    void finish(bool whole);

  private:
    renderer::Frame look(const scene::Snapshot& world);
    /// Coding of the frame, meaningless without a coder, and by it the tolerances of its light.
    encoder::PicturePlan plan(const scene::Snapshot& world, const renderer::Frame& frame, Motion& motion);
    /// Rough light, for the tolerances of a frame without a picture before it.
    void look_roughly(const scene::Snapshot& world, const renderer::Frame& frame, const encoder::PicturePlan& plan);
    renderer::Lit light(const scene::Snapshot& world, renderer::Frame frame, int quantiser, RenderedMotion& motion);
    core::Picture develop(const core::Radiance& radiance, const renderer::Frame& seen, std::int64_t n);
    /// Keeps the frame for the coupling until it is coded.
    void keep_for_coupling(const core::Picture& picture, const renderer::Lit& lit, const core::Radiance& shown,
                           const encoder::PicturePlan& plan);
    void code(const core::Picture& picture, const encoder::PicturePlan& plan, Motion& motion);
    void take(const std::vector<encoder::CodedPicture>& pictures);
    void repeat_coding(std::int64_t n);
    void restore();
    template <class A>
    void archive_state(A& a) {
        a(shown_);
        if (coupling_) a(*coupling_);
    }

    const RenderJob& job_;
    renderer::Renderer& renderer_;
    const Chunk& chunk_;
    RunStatistics& statistics_;
    perceptual::Display display_;
    GlareFilter shown_;
    PosedFrames posed_;
    StatisticsRecorder recorder_;
    Auditor auditor_;
    GrainCost grain_cost_;
    LoopObservers observers_;
    std::optional<PictureCoder> coder_;  ///< none: pictures are not coded
    std::optional<Coupling> coupling_;   ///< none: tolerances are fixed
    core::ToleranceMap tolerance_;       ///< of the frame's light
    KeptFrames* kept_;                   ///< null: no frames are kept
};

ChunkLoop::ChunkLoop(const RenderJob& job, renderer::Renderer& renderer, const Chunk& chunk, LoopObserver& observer,
                     RunStatistics& statistics, KeptFrames* kept)
    : job_(job),
      renderer_(renderer),
      chunk_(chunk),
      statistics_(statistics),
      display_(job.display()),
      shown_(job, statistics),
      posed_(job),
      recorder_(statistics, job.kind == OutputKind::film),
      auditor_(renderer, display_, job.audit, statistics),
      grain_cost_(job.film(), chunk),
      kept_(kept) {
    renderer.start_chunk(*posed_.at(chunk.first));
    if (job.kind == OutputKind::film)
        coder_.emplace(job.film(), chunk, job.allocations, shots_of(*job.animation), statistics,
                       !job.rough && scene::traits_of(*job.animation).lights_change);
    if (job.tolerance.coupled && coder_)
        coupling_.emplace(display_, job.coding, job.coupling);
    else
        tolerance_ = job.tolerance_map();
    observers_.add(recorder_);
    if (job.audit > 0) observers_.add(auditor_);
    if (coder_ && !job.rough && !job.is_sample) observers_.add(grain_cost_);
    observers_.add(observer);
}

void ChunkLoop::frame(std::int64_t n) {
    const FrameTimer timer(statistics_);
    const std::shared_ptr<const scene::Snapshot> world = posed_.at(n);
    renderer::Frame frame = look(*world);
    RenderedMotion motion(job_, posed_, frame.visible, *world, statistics_, frame.imaged);

    // Plan its coding, and by it and the eye its tolerances.
    const encoder::PicturePlan coding = plan(*world, frame, motion);

    // Light it within them, and show it.
    const renderer::Statistics before = renderer_.statistics();
    const renderer::Lit lit = light(*world, std::move(frame), coding.quantiser, motion);
    const core::Radiance& shown = shown_.of(lit.radiance, world->time);
    const core::Picture picture = develop(shown, lit.frame, n);

    // Keep it, whatever stops, and code it with exact motion.
    const parallel::StopWhen never({});
    observers_.lit({*world, lit, tolerance_, shown, picture, motion, before, renderer_.statistics()});
    keep_for_coupling(picture, lit, shown, coding);
    code(picture, coding, motion);
    if (kept_ != nullptr && n < chunk_.last) kept_->add(picture);
}

void ChunkLoop::repeat(std::int64_t n) {
    repeat_coding(n);
    if (n - chunk_.first + 1 < kept_->frames()) return;
    try {
        restore();
    } catch (const std::exception& error) {
        kept_->drop();
        throw core::Error("lit frames of an earlier run are damaged (" + std::string(error.what()) +
                          "); they are removed, and --resume lights them anew");
    }
}

/// Lights of every instant follow from those before; of what is seen the coder asks pixels' motion alone.
void ChunkLoop::repeat_coding(std::int64_t n) {
    const std::shared_ptr<const scene::Snapshot> world = posed_.at(n);
    renderer_.prepare(*world);
    renderer::Lit lit;
    if (coder_) lit.frame = timed(statistics_, Stage::see, [&] { return renderer_.look_at_middles(*world); });
    RenderedMotion motion(job_, posed_, lit.frame.visible, *world, statistics_, lit.frame.imaged);
    encoder::PicturePlan coding;
    if (coder_) coding = coder_->plan(n, world->cut_before, motion);
    const core::Picture picture = kept_->next(n);
    const parallel::StopWhen never({});
    const renderer::Statistics counts = renderer_.statistics();
    observers_.lit_before({*world, lit, tolerance_, lit.radiance, picture, motion, counts, counts});
    if (!coder_) return;
    statistics_.frames.back().type = "-IPB"[static_cast<int>(coding.type)];
    take(coder_->code(picture, coding, motion));
}

void ChunkLoop::restore() {
    const std::unique_ptr<core::ArchiveReader> state = kept_->state();
    renderer_.restore(*state);
    archive_state(*state);
    // What lighting took is known; the rest of their entries is found again.
    RunStatistics earlier;
    app::restore(earlier, kept_->statistics());
    std::vector<FrameEntry> frames = std::exchange(statistics_.frames, {});
    for (std::size_t i = 0; i < frames.size(); ++i) frames[i].cost = earlier.frames.at(i).cost;
    earlier.frames.clear();
    statistics_ = sum_of(earlier, statistics_);
    statistics_.frames = std::move(frames);
    renderer_.count_anew();
}

void ChunkLoop::keep(bool at_once) {
    if (kept_ == nullptr) return;
    kept_->keep(totals_of(statistics_, renderer_), at_once, [&](core::ArchiveWriter& state) {
        renderer_.save(state);
        archive_state(state);
    });
}

void ChunkLoop::finish(bool whole) {
    if (coder_) take(coder_->flush());
    if (whole) grain_cost_.measure(statistics_);
}

renderer::Frame ChunkLoop::look(const scene::Snapshot& world) {
    const StageTimer timer(statistics_, Stage::see);
    return renderer_.look(world);
}

encoder::PicturePlan ChunkLoop::plan(const scene::Snapshot& world, const renderer::Frame& frame, Motion& motion) {
    if (!coder_) return {};
    const encoder::PicturePlan plan = coder_->plan(world.frame, world.cut_before, motion);
    if (!coupling_) return plan;
    if (world.cut_before || plan.number == chunk_.first) coupling_->forget();
    if (!coupling_->remembers()) look_roughly(world, frame, plan);
    const std::int64_t reference = coupling_->remembered();
    const core::MotionField* field = reference == plan.number ? nullptr : motion.to(reference);
    const StageTimer timer(statistics_, Stage::tolerate);
    tolerance_ = coupling_->tolerate(frame.visible, plan, field);
    widen_poles(world.camera, tolerance_);
    shown_.carry_back(tolerance_);
    return plan;
}

void ChunkLoop::look_roughly(const scene::Snapshot& world, const renderer::Frame& frame,
                             const encoder::PicturePlan& plan) {
    core::ToleranceMap about =
        core::ToleranceMap::uniform(frame.visible.width(), frame.visible.height(), {0.0f, rough_tolerance});
    about.typical = rough_tolerance;  // rays by price: dark corners need not keep it
    const renderer::Lit rough = [&] {
        const StageTimer timer(statistics_, Stage::preview);
        return renderer_.light(world, frame, {about, renderer::LightingMode::sparse});
    }();
    const core::Radiance& shown = shown_.of(rough.radiance, world.time);
    const StageTimer timer(statistics_, Stage::tolerate);
    core::Picture picture = display_.develop(shown);
    picture.number = plan.number;
    coupling_->take_rough_look(picture, rough.radiance, rough_tolerance, shown, frame.visible, plan);
}

renderer::Lit ChunkLoop::light(const scene::Snapshot& world, renderer::Frame frame, int quantiser,
                               RenderedMotion& motion) {
    renderer::LightOrder order{tolerance_};
    order.exposure = exposure_samples(job_, quantiser, display_);
    if (job_.preview) {
        order.mode = renderer::LightingMode::draft;
        if (world.frame > chunk_.first && !world.cut_before) order.to_before = &motion.exact_to(world.frame - 1);
    } else if (job_.tolerance.truth) {
        order.mode = renderer::LightingMode::truth;
        order.truth = {*job_.tolerance.truth, most_true_paths};
    }
    const StageTimer timer(statistics_, Stage::shade);
    return renderer_.light(world, std::move(frame), order);
}

core::Picture ChunkLoop::develop(const core::Radiance& radiance, const renderer::Frame& seen, std::int64_t n) {
    const StageTimer timer(statistics_, Stage::develop);
    const bool has_alpha = job_.kind == OutputKind::film && job_.has_alpha();
    core::Picture picture =
        has_alpha ? display_.develop(radiance, renderer::mattes_of(seen)) : display_.develop(radiance);
    picture.number = n;
    return picture;
}

void ChunkLoop::keep_for_coupling(const core::Picture& picture, const renderer::Lit& lit, const core::Radiance& shown,
                                  const encoder::PicturePlan& plan) {
    if (!coupling_) return;
    const StageTimer timer(statistics_, Stage::tolerate);
    LightingCost& cost = statistics_.frames.back().cost;
    cost.share = coupling_->share();
    cost.loss = coupling_->keep(picture, lit.radiance, shown, lit.frame.visible, plan).value_or(-1);
}

void ChunkLoop::code(const core::Picture& picture, const encoder::PicturePlan& plan, Motion& motion) {
    if (!coder_) return;
    statistics_.frames.back().type = "-IPB"[static_cast<int>(plan.type)];
    take(coder_->code(picture, plan, motion));
}

void ChunkLoop::take(const std::vector<encoder::CodedPicture>& pictures) {
    for (const encoder::CodedPicture& coded : pictures) {
        if (coupling_) {
            const StageTimer timer(statistics_, Stage::tolerate);
            coupling_->judge(coded);
        }
        observers_.coded(coded);
    }
}

}  // namespace

bool render_chunk(const RenderJob& job, renderer::Renderer& renderer, const Chunk& chunk, LoopObserver& observer,
                  RunStatistics& statistics, const std::function<bool()>& frame_done,
                  const std::function<bool()>& stops, KeptFrames* kept) {
    observer.begins(chunk);
    const std::int64_t lit = kept == nullptr ? 0 : kept->frames();
    std::optional<ChunkLoop> loop;
    bool whole = true;
    try {
        const parallel::StopWhen stop(stops);
        loop.emplace(job, renderer, chunk, observer, statistics, kept);
        for (std::int64_t n = chunk.first; n <= chunk.last && whole; ++n) {
            const bool is_new = n - chunk.first >= lit;
            if (is_new)
                loop->frame(n);
            else
                loop->repeat(n);
            whole = frame_done() || n == chunk.last;
            if (is_new && n < chunk.last) loop->keep(!whole);
        }
    } catch (const parallel::Stopped&) {
        whole = false;
    }
    if (loop) loop->finish(whole);
    if (whole) observer.ends(chunk);
    return whole;
}

bool render_through(const RenderJob& film, LoopObserver& observer, RunStatistics& statistics,
                    const std::function<bool()>& goes_on) {
    renderer::Renderer renderer = renderer_of(film);
    bool whole = true;
    for (const Chunk& chunk : chunks_of(film.frames, film.coding.gop)) {
        bool wanted = true;
        whole = render_chunk(film, renderer, chunk, observer, statistics, [&] { return wanted = goes_on(); });
        whole = whole && (wanted || chunk.last == film.frames.last);
        if (!whole) break;
    }
    statistics = totals_of(statistics, renderer);
    return whole;
}

}  // namespace render2mpeg::app
