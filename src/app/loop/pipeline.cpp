#include "app/loop/pipeline.h"

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "app/coupling/coupling.h"
#include "app/job/scene_settings.h"
#include "app/loop/glare_filter.h"
#include "app/loop/grain_cost.h"
#include "app/loop/picture_coder.h"
#include "app/loop/statistics_recorder.h"
#include "encoder/latitude.h"
#include "parallel/loops.h"
#include "perceptual/display.h"
#include "renderer/base/allocation.h"
#include "renderer/view/mattes.h"
#include "scene/preparation/traits.h"

namespace render2mpeg::app {
namespace {

/// Paths of a pixel of a frame by paths alone, at most. chosen: 65,536, some 0.4 CPU seconds.
constexpr std::uint64_t most_true_paths = 1u << 16;

/// Of a first rough look's cuts and lamps, as a share of light. chosen: 0.1 of 0.1 and 0.3, at which their errors count
/// as noise of rays: a room by day loses 0.14 dB where 0.2 is asked, else 0.18, and is 5 % cheaper.
constexpr float rough_tolerance = 0.1f;

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
    /// The views of all eyes, one after the other; `look`: by which the renderer looks.
    std::vector<renderer::Frame> look(const EyeSnapshots& worlds,
                                      renderer::Frame (renderer::Renderer::*look)(const scene::Snapshot&));
    /// Coding of the frame, meaningless without a coder, and by it the tolerances of its light.
    encoder::PicturePlan plan(const EyeSnapshots& worlds, const std::vector<renderer::Frame>& frames, Motion& motion);
    /// Rough light, for the tolerances of a frame without a picture before it.
    void look_roughly(const EyeSnapshots& worlds, const std::vector<renderer::Frame>& frames,
                      const encoder::PicturePlan& plan);
    /// Lights the eyes' views one after the other: what one finds on surfaces serves the next. Time stands still
    /// meanwhile.
    std::vector<renderer::Lit> light(const EyeSnapshots& worlds, std::vector<renderer::Frame> frames, int quantiser,
                                     RenderedMotion& motion);
    /// Light of all eyes as they get it, and as it is.
    struct PackedLight {
        renderer::Lit lit;     ///< as LitFrame has it
        core::Radiance shown;  ///< unless it is as `lit` has it
        core::Mattes mattes;
        bool is_filtered = false;

        const core::Radiance& as_shown() const { return is_filtered ? shown : lit.radiance; }
    };
    PackedLight pack(std::vector<renderer::Lit> eyes, const core::Rational& time);
    core::Picture develop(const PackedLight& light, std::int64_t n);
    /// Keeps the frame for the coupling until it is coded.
    void keep_for_coupling(const core::Picture& picture, const renderer::Lit& lit, const core::Radiance& shown,
                           const encoder::PicturePlan& plan);
    void code(const core::Picture& picture, const encoder::PicturePlan& plan, Motion& motion);
    void take(const std::vector<encoder::CodedPicture>& pictures);
    void repeat_coding(std::int64_t n);
    void restore();
    template <class A>
    void archive_state(A& a) {
        for (GlareFilter& filter : shown_) a(filter);
        if (coupling_) a(*coupling_);
    }

    const RenderJob& job_;
    renderer::Renderer& renderer_;
    const Chunk& chunk_;
    RunStatistics& statistics_;
    perceptual::Display display_;
    std::vector<GlareFilter> shown_;  ///< to each eye
    PosedFrames posed_;
    StatisticsRecorder recorder_;
    Auditor auditor_;
    GrainCost grain_cost_;
    LoopObservers observers_;
    std::optional<PictureCoder> coder_;  ///< none: pictures are not coded
    std::optional<Coupling> coupling_;   ///< none: tolerances are fixed
    bool by_latitude_;                   ///< macroblocks of panoramas have quantisers by their latitude
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
      posed_(job),
      recorder_(statistics, job.kind == OutputKind::film),
      auditor_(renderer, display_, job.audit, statistics),
      grain_cost_(job.film(), chunk),
      by_latitude_(!encoder::latitude_factors(job.coding).empty()),
      kept_(kept) {
    for (std::size_t e = 0; e < eyes_of(job.animation->stereo).size(); ++e) shown_.emplace_back(job, statistics);
    renderer.start_chunk(*posed_.at(chunk.first).front());
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

std::vector<core::Visible> visible_of(const std::vector<renderer::Frame>& frames) {
    std::vector<core::Visible> visible;
    for (const renderer::Frame& frame : frames) visible.push_back(frame.visible);
    return visible;
}

std::vector<SeenByEye> seen_in(const std::vector<renderer::Frame>& frames) {
    std::vector<SeenByEye> seen;
    for (const renderer::Frame& frame : frames) seen.push_back({frame.visible, frame.imaged});
    return seen;
}

void ChunkLoop::frame(std::int64_t n) {
    const FrameTimer timer(statistics_);
    const EyeSnapshots worlds = posed_.at(n);
    std::vector<renderer::Frame> frames = look(worlds, &renderer::Renderer::look);
    RenderedMotion motion(job_, posed_, seen_in(frames), worlds, statistics_);

    // Plan its coding, and by it and the eye its tolerances.
    const renderer::Statistics before = renderer_.statistics();
    const encoder::PicturePlan coding = plan(worlds, frames, motion);

    // Light it within them, and show it.
    const PackedLight light =
        pack(this->light(worlds, std::move(frames), coding.quantiser, motion), worlds.front()->time);
    const core::Picture picture = develop(light, n);

    // Keep it, whatever stops, and code it with exact motion.
    const parallel::StopWhen never({});
    observers_.lit({*worlds.front(), light.lit, tolerance_, light.as_shown(), picture, motion, before,
                    renderer_.statistics(), light.mattes});
    keep_for_coupling(picture, light.lit, light.as_shown(), coding);
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
    const EyeSnapshots worlds = posed_.at(n);
    renderer_.prepare(*worlds.front());
    std::vector<renderer::Frame> frames(worlds.size());
    if (coder_) frames = look(worlds, &renderer::Renderer::look_at_middles);
    RenderedMotion motion(job_, posed_, seen_in(frames), worlds, statistics_);
    encoder::PicturePlan coding;
    if (coder_) coding = coder_->plan(n, worlds.front()->cut_before, motion);
    renderer::Lit lit;
    lit.frame.visible = packed(visible_of(frames), job_.animation->stereo);
    const core::Picture picture = kept_->next(n);
    const parallel::StopWhen never({});
    const renderer::Statistics counts = renderer_.statistics();
    observers_.lit_before({*worlds.front(), lit, tolerance_, lit.radiance, picture, motion, counts, counts, {}});
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

std::vector<renderer::Frame> ChunkLoop::look(const EyeSnapshots& worlds,
                                             renderer::Frame (renderer::Renderer::*look)(const scene::Snapshot&)) {
    const StageTimer timer(statistics_, Stage::see);
    std::vector<renderer::Frame> frames;
    for (const auto& world : worlds) frames.push_back((renderer_.*look)(*world));
    return frames;
}

encoder::PicturePlan ChunkLoop::plan(const EyeSnapshots& worlds, const std::vector<renderer::Frame>& frames,
                                     Motion& motion) {
    if (!coder_) return {};
    const scene::Snapshot& world = *worlds.front();
    const encoder::PicturePlan plan = coder_->plan(world.frame, world.cut_before, motion);
    if (!coupling_) return plan;
    if (world.cut_before || plan.number == chunk_.first) coupling_->forget();
    if (coupling_->remembers())
        coupling_->assume_coded();
    else
        look_roughly(worlds, frames, plan);
    const std::int64_t reference = coupling_->remembered();
    const core::MotionField* field = reference == plan.number ? nullptr : motion.to(reference);
    const core::FramePacking packing = job_.animation->stereo;
    const StageTimer timer(statistics_, Stage::tolerate);
    core::ToleranceMap whole = coupling_->tolerate(packed(visible_of(frames), packing), plan, field);
    std::vector<core::ToleranceMap> eyes;
    // Quantisers of macroblocks are wider there by themselves.
    const bool is_wide = by_latitude_ && coupling_->follows_macroblocks();
    for (std::size_t e = 0; e < worlds.size(); ++e) {
        eyes.push_back(part_of(whole, packing, e));
        if (!is_wide) widen_poles(worlds[e]->camera, eyes.back());
        shown_[e].carry_back(eyes.back());
    }
    tolerance_ = packed(std::move(eyes), packing);
    return plan;
}

void ChunkLoop::look_roughly(const EyeSnapshots& worlds, const std::vector<renderer::Frame>& frames,
                             const encoder::PicturePlan& plan) {
    std::vector<renderer::Lit> eyes;
    for (std::size_t e = 0; e < worlds.size(); ++e) {
        const StageTimer timer(statistics_, Stage::preview);
        if (e > 0) {
            const core::MotionField to_left =
                scene::motion_between(frames[e].visible, *worlds[e], *worlds.front(), &frames[e].imaged);
            renderer::Lit& right = eyes.emplace_back();
            right.frame = frames[e];
            right.radiance =
                carried_to_right(eyes.front().radiance, frames.front().visible, frames[e].visible, to_left);
            continue;
        }
        core::ToleranceMap about =
            core::ToleranceMap::uniform(frames[e].visible.width(), frames[e].visible.height(), {0.0f, rough_tolerance});
        about.typical = rough_tolerance;  // rays by price: dark corners need not keep it
        about.most_rays = renderer::pilot_rays;
        eyes.push_back(renderer_.light(*worlds[e], frames[e], {about, renderer::LightingMode::ahead}));
    }
    const PackedLight rough = pack(std::move(eyes), worlds.front()->time);
    const StageTimer timer(statistics_, Stage::tolerate);
    core::Picture picture = display_.develop(rough.as_shown());
    picture.number = plan.number;
    coupling_->take_rough_look(picture, rough.lit.radiance, rough.as_shown(), rough.lit.frame.visible, plan);
}

std::vector<renderer::Lit> ChunkLoop::light(const EyeSnapshots& worlds, std::vector<renderer::Frame> frames,
                                            int quantiser, RenderedMotion& motion) {
    const scene::Snapshot& first = *worlds.front();
    const core::MotionField* to_before = nullptr;
    if (job_.preview && first.frame > chunk_.first && !first.cut_before) to_before = &motion.exact_to(first.frame - 1);
    std::vector<renderer::Lit> eyes;
    for (std::size_t e = 0; e < worlds.size(); ++e) {
        const core::ToleranceMap tolerance = part_of(tolerance_, job_.animation->stereo, e);
        renderer::LightOrder order{tolerance};
        order.exposure = exposure_samples(job_, quantiser, display_);
        core::MotionField before;
        if (to_before != nullptr) {
            before = part_of(*to_before, job_.animation->stereo, e);
            order.to_before = &before;
        }
        if (job_.preview) {
            order.mode = renderer::LightingMode::draft;
        } else if (job_.tolerance.truth) {
            order.mode = renderer::LightingMode::truth;
            order.truth = {*job_.tolerance.truth, most_true_paths};
        }
        const StageTimer timer(statistics_, Stage::shade);
        eyes.push_back(renderer_.light(*worlds[e], std::move(frames[e]), order));
    }
    return eyes;
}

ChunkLoop::PackedLight ChunkLoop::pack(std::vector<renderer::Lit> eyes, const core::Rational& time) {
    PackedLight all;
    const core::FramePacking packing = job_.animation->stereo;
    std::vector<core::Radiance> lit, shown;
    std::vector<core::Mattes> mattes;
    for (std::size_t e = 0; e < eyes.size(); ++e) {
        const core::Radiance& now = shown_[e].of(eyes[e].radiance, time);
        all.is_filtered = &now != &eyes[e].radiance;
        if (all.is_filtered) shown.push_back(now);
        mattes.push_back(renderer::mattes_of(eyes[e].frame));
    }
    if (all.is_filtered) all.shown = packed(std::move(shown), packing);
    all.mattes = packed(std::move(mattes), packing);
    if (eyes.size() == 1) {
        all.lit = std::move(eyes.front());
        return all;
    }
    std::vector<core::Visible> visible;
    for (renderer::Lit& eye : eyes) {
        visible.push_back(std::move(eye.frame.visible));
        lit.push_back(std::move(eye.radiance));
    }
    all.lit.frame.visible = packed(std::move(visible), packing);
    all.lit.radiance = packed(std::move(lit), packing);
    return all;
}

core::Picture ChunkLoop::develop(const PackedLight& light, std::int64_t n) {
    const StageTimer timer(statistics_, Stage::develop);
    core::Picture picture =
        job_.coding.alpha ? display_.develop(light.as_shown(), light.mattes) : display_.develop(light.as_shown());
    picture.number = n;
    return picture;
}

void ChunkLoop::keep_for_coupling(const core::Picture& picture, const renderer::Lit& lit, const core::Radiance& shown,
                                  const encoder::PicturePlan& plan) {
    if (!coupling_) return;
    const StageTimer timer(statistics_, Stage::tolerate);
    LightingCost& cost = statistics_.frames.back().cost;
    cost.share = coupling_->share_of(plan);
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
