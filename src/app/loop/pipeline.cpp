#include "app/loop/pipeline.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <span>

#include "app/loop/coupling.h"
#include "app/loop/preview.h"
#include "app/loop/statistics_recorder.h"
#include "encoder/encoder.h"
#include "encoder/motion_nonuniformity.h"
#include "image/layers.h"
#include "perceptual/motion_sensitivity.h"
#include "scene/pose/motion.h"

namespace render2mpeg::app {
namespace {

/// Pictures after frame n before another shot begins, a keyframe comes or the chunk ends.
std::int64_t frames_left(const RenderJob& film, std::int64_t n, std::int64_t last) {
    std::int64_t left = last - n;
    for (const scene::Shot& shot : film.animation->shots)
        if (shot.frame > n) left = std::min(left, shot.frame - 1 - n);
    return film.keyframes.frames_left(n, left);
}

void write_frame_layers(const RenderJob& film, const std::filesystem::path& folder, const core::Visible& visible,
                        const core::Radiance& radiance, const core::ToleranceMap& tolerance,
                        const scene::Snapshot& world) {
    const core::MotionField before =
        scene::motion_between(visible, world, film.snapshot(std::max<std::int64_t>(0, world.frame - 1)));
    const core::MotionField after = scene::motion_between(visible, world, film.snapshot(world.frame + 1));
    image::write_layers(numbered(layers_in(folder), world.frame), visible, radiance, &before, &after,
                        film.format.pixel_aspect, &tolerance);
}

/// One chunk in the making: frames come one after the other.
class ChunkLoop {
  public:
    ChunkLoop(const RenderJob& film, renderer::Renderer& renderer, const Chunk& chunk, const Destination& destination,
              RunStatistics& statistics);

    void frame(std::int64_t n);
    void finish();

  private:
    /// What the frame's light may be off by, before it is lit.
    core::ToleranceMap tolerances(const scene::Snapshot& world, const renderer::Seen& seen,
                                  const encoder::PicturePlan& plan, std::span<const core::MotionField> motion);
    /// Rough light for the eye, where there is no picture before.
    void imagine(const scene::Snapshot& world, const renderer::Seen& seen, const encoder::PicturePlan& plan);
    void write(const std::vector<encoder::CodedPicture>& pictures);

    const RenderJob& film_;
    renderer::Renderer& renderer_;
    const Chunk& chunk_;
    const Destination& destination_;
    RunStatistics& statistics_;
    bool codes_;
    perceptual::Display display_;
    encoder::Encoder encoder_;
    StatisticsRecorder recorder_;
    std::optional<Coupling> coupling_;
    core::ToleranceMap fixed_;
};

ChunkLoop::ChunkLoop(const RenderJob& film, renderer::Renderer& renderer, const Chunk& chunk,
                     const Destination& destination, RunStatistics& statistics)
    : film_(film),
      renderer_(renderer),
      chunk_(chunk),
      destination_(destination),
      statistics_(statistics),
      codes_(film.kind == OutputKind::film),
      display_(film.exposure.value_or(0), perceptual::matrix_for(film.format.height)),
      encoder_(film.coding),
      recorder_(statistics) {
    renderer.start_chunk(film.snapshot(chunk.first));
    if (film.tolerance.coupled && codes_)
        coupling_.emplace(display_, film.coupling, film.coding.tune);
    else
        fixed_ = film.tolerance_map();
}

void ChunkLoop::finish() {
    if (codes_) write(timed(statistics_, Stage::encode, [&] { return encoder_.flush(); }));
}

void ChunkLoop::write(const std::vector<encoder::CodedPicture>& pictures) {
    for (const encoder::CodedPicture& coded : pictures) {
        recorder_.coded(coded);
        if (coupling_) timed(statistics_, Stage::tolerate, [&] { coupling_->judge(coded); });
        if (destination_.film != nullptr) destination_.film->append(coded);
        if (destination_.observer != nullptr) destination_.observer->coded(coded);
    }
}

void ChunkLoop::imagine(const scene::Snapshot& world, const renderer::Seen& seen, const encoder::PicturePlan& plan) {
    const core::Radiance rough = timed(statistics_, Stage::preview, [&] { return preview(renderer_, world, seen); });
    timed(statistics_, Stage::tolerate, [&] {
        core::Picture picture = display_.develop(rough);
        picture.number = plan.number;
        coupling_->imagine(picture, rough, seen.visible, plan);
    });
}

core::ToleranceMap ChunkLoop::tolerances(const scene::Snapshot& world, const renderer::Seen& seen,
                                         const encoder::PicturePlan& plan, std::span<const core::MotionField> motion) {
    if (world.cut_before || plan.number == chunk_.first) coupling_->forget();
    if (!coupling_->remembers()) imagine(world, seen, plan);

    // The encoder's own motion may lead there already.
    const std::int64_t reference = coupling_->remembered();
    core::MotionField field;
    const core::MotionField* way = nullptr;
    for (const core::MotionField& known : motion)
        if (known.reference == reference) way = &known;
    if (way == nullptr && reference != plan.number && film_.plan.runs(renderer::Pass::motion)) {
        field = timed(statistics_, renderer::Pass::motion,
                      [&] { return scene::motion_between(seen.visible, world, film_.snapshot(reference)); });
        way = &field;
    }
    return timed(statistics_, Stage::tolerate, [&] { return coupling_->tolerate(seen.visible, plan, way); });
}

void ChunkLoop::frame(std::int64_t n) {
    const double start = cpu_seconds();
    const scene::Snapshot world = film_.snapshot(n);
    const renderer::Seen seen = timed(statistics_, Stage::see, [&] { return renderer_.see(world); });

    // Plan how it will be coded, and what that and the eye allow its light to be off by.
    encoder::PicturePlan coding;
    std::vector<core::MotionField> motion;
    if (codes_) {
        encoder::PictureFacts facts = facts_of(film_, world, chunk_);
        timed(statistics_, renderer::Pass::motion, [&] { tell_motion(film_, chunk_, seen.visible, world, facts); });
        coding = encoder_.plan(n, facts, n == chunk_.first);
        motion =
            timed(statistics_, renderer::Pass::motion, [&] { return motion_of(film_, coding, seen.visible, world); });
    }
    const core::ToleranceMap coupled = coupling_ ? tolerances(world, seen, coding, motion) : core::ToleranceMap();
    const core::ToleranceMap& tolerance = coupling_ ? coupled : fixed_;
    const renderer::Statistics before = renderer_.statistics();  // what the first, rough look took is no frame's
    const core::Radiance radiance =
        timed(statistics_, Stage::shade, [&] { return renderer_.shade(world, seen, tolerance); });
    core::Picture picture = timed(statistics_, Stage::develop, [&] { return display_.develop(radiance); });
    picture.number = n;
    recorder_.rendered(n, before, renderer_.statistics());
    if (film_.audit > 0)
        recorder_.audited(timed(statistics_.audit.seconds,
                                [&] { return renderer_.audit(world, seen, tolerance, radiance, film_.audit); }),
                          tolerance);

    for (const std::uint8_t luma : picture.y.values())
        statistics_.brightest_luma = std::max<int>(statistics_.brightest_luma, luma);

    // Encode it with the renderer's own motion, or write it as it is.
    if (coupling_)
        timed(statistics_, Stage::tolerate, [&] { coupling_->keep(picture, radiance, seen.visible, coding); });
    if (destination_.observer != nullptr)
        destination_.observer->lit({world, seen.visible, tolerance, radiance, picture});
    if (codes_) {
        recorder_.keep(picture);
        const auto onward = timed(statistics_, renderer::Pass::motion,
                                  [&] { return onward_motion(film_, coding, seen.visible, world); });
        const encoder::Hints hints{onward ? &*onward : nullptr};
        write(timed(statistics_, Stage::encode, [&] { return encoder_.push(picture, coding, motion, hints); }));
    }
    if (destination_.sink != nullptr) destination_.sink->write(radiance, picture);
    if (destination_.layers != nullptr)
        timed(statistics_, renderer::Pass::layers,
              [&] { write_frame_layers(film_, *destination_.layers, seen.visible, radiance, tolerance, world); });
    recorder_.took(cpu_seconds() - start);
}

}  // namespace

encoder::PictureFacts facts_of(const RenderJob& film, const scene::Snapshot& world, const Chunk& chunk) {
    encoder::PictureFacts facts;
    facts.cut_before = world.cut_before;
    facts.frames_left = frames_left(film, world.frame, chunk.last);
    facts.keyframe = film.keyframes.begins_at(world.frame);
    facts.left_in_chunk = chunk.last - world.frame;
    facts.last_chunk = chunk.last == film.frames.last;
    if (!film.allocations.empty())
        facts.allocation = film.allocations[static_cast<std::size_t>(world.frame - film.frames.first)];
    return facts;
}

void tell_motion(const RenderJob& film, const Chunk& chunk, const core::Visible& visible, const scene::Snapshot& world,
                 encoder::PictureFacts& facts) {
    if (world.frame == chunk.first || world.cut_before || !film.plan.runs(renderer::Pass::motion)) return;
    const core::MotionField motion = scene::motion_between(visible, world, film.snapshot(world.frame - 1));
    facts.motion_nonuniformity = encoder::motion_nonuniformity(motion);
    if (film.coding.rate_control.mode == encoder::RateMode::constant_quality)
        facts.sensitivity = perceptual::motion_sensitivity(motion, film.rate.hertz.value());
}

std::vector<core::MotionField> motion_of(const RenderJob& film, const encoder::PicturePlan& coding,
                                         const core::Visible& visible, const scene::Snapshot& world) {
    std::vector<core::MotionField> fields;
    if (!film.plan.runs(renderer::Pass::motion)) return fields;
    for (const std::int64_t reference : coding.references)
        fields.push_back(scene::motion_between(visible, world, film.snapshot(reference)));
    return fields;
}

std::optional<core::MotionField> onward_motion(const RenderJob& film, const encoder::PicturePlan& coding,
                                               const core::Visible& visible, const scene::Snapshot& world) {
    if (!coding.horizon) return std::nullopt;
    if (film.plan.runs(renderer::Pass::motion))
        return scene::motion_between(visible, world, film.snapshot(*coding.horizon));
    core::MotionField still{coding.number, *coding.horizon, {}, {}, {}};
    still.vector = core::Plane<glm::vec2>(visible.width(), visible.height(), glm::vec2{0.0f});
    still.kind = core::Plane<core::PixelClass>(visible.width(), visible.height(), core::PixelClass::surface);
    return still;
}

bool render_chunk(const RenderJob& film, renderer::Renderer& renderer, const Chunk& chunk,
                  const Destination& destination, RunStatistics& statistics, const std::function<bool()>& frame_done) {
    if (destination.observer != nullptr) destination.observer->begins(chunk);
    ChunkLoop loop(film, renderer, chunk, destination, statistics);
    bool whole = true;
    for (std::int64_t n = chunk.first; n <= chunk.last && whole; ++n) {
        loop.frame(n);
        whole = frame_done() || n == chunk.last;
    }
    loop.finish();
    if (whole && destination.observer != nullptr) destination.observer->ends(chunk);
    return whole;
}

}  // namespace render2mpeg::app
