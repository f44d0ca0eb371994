#pragma once
// Everything that decides a film, with the options' gaps filled, and its making.
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "app/loop/cache_choice.h"
#include "app/loop/coupling.h"
#include "app/options/effort.h"
#include "app/options/film.h"
#include "app/options/options.h"
#include "app/options/output_kind.h"
#include "core/rational.h"
#include "core/tolerance_map.h"
#include "encoder/av/sound.h"
#include "encoder/types.h"
#include "perceptual/display.h"
#include "renderer/base/plan.h"
#include "renderer/renderer.h"
#include "scene/model/animation.h"
#include "scene/pose/snapshot.h"

namespace render2mpeg::app {

/// Everything that decides a film: the scene and all settings, with the options' gaps filled. Constant while it is
/// rendered.
struct RenderJob {
    std::shared_ptr<const scene::Animation> animation;
    core::FrameRate rate;
    FrameRange frames;
    scene::PictureFormat format;
    renderer::Settings rendering;
    renderer::Wanted wanted;  ///< of the plan
    renderer::Plan plan{{}};
    CacheChoice cache;  ///< as `rendering` has it
    encoder::Settings coding;
    Keyframes keyframes;
    av::Sound sound;                    ///< as in Film
    bool disc = false;                  ///< program streams are a DVD's
    core::Rational pixel_aspect{1, 1};  ///< width by height of a pixel, as in `format`
    ToleranceRequest tolerance;
    CouplingSettings coupling;  ///< where the tolerance is coupled
    OutputKind kind = OutputKind::film;
    std::optional<float> exposure;   ///< EV; none: to be measured
    bool measures_exposure = false;  ///< nobody says it
    core::View view;
    bool preview = false;     ///< a draft (app/options/effort.h)
    bool rough = false;       ///< a first pass: its light is too rough to tell whether it changes
    bool two_passes = false;  ///< the first one finds `allocations`
    std::vector<encoder::BitAllocation> allocations;  ///< one per frame, or none
    bool images_in_turn = false;                      ///< decode one at a time: memory is short
    std::optional<int> exposure_samples;              ///< none: by quantiser
    int audit = 0;                   ///< pixels of every frame that are gathered again without clustering
    std::optional<ChunkRange> part;  ///< chunks that this run makes of it; none: all

    std::int64_t frame_count() const { return frames.last - frames.first + 1; }
    /// The chunks that are to be made.
    std::vector<Chunk> chunks() const;
    scene::Snapshot snapshot(std::int64_t frame) const {
        return scene::snapshot_at(*animation, frame, core::time_of(frame, rate), format, shutter());
    }
    /// Closed where no frame would show that it is open.
    scene::ShutterInterval shutter() const {
        return plan.runs(renderer::Pass::shutter) ? scene::interval_of(animation->shutter, rate.hertz.value())
                                                  : scene::ShutterInterval();
    }
    core::ToleranceMap tolerance_map() const;
    /// With 0 EV before the exposure is known.
    perceptual::Display display() const { return {exposure.value_or(0), perceptual::matrix_for(format.height), view}; }
    Film film() const {
        return {animation->source, frames, coding, keyframes, disc, core::name_of(rendering.isa), sound};
    }
};

/// The film without what a row of its plan gives (renderer::PlanRow::effect).
RenderJob without(const RenderJob& film, renderer::Pass effect);

/// The film as --preview makes it where no option says more (app/options/effort.h), in the same size.
RenderJob draft_of(const RenderJob& film);

/// The film as --effort makes it where no option says more (app/options/effort.h), with no more eye samples than it
/// has: beside references with its own they would count as errors.
RenderJob at_effort(const RenderJob& film, const Effort& effort);

/// The film's renderer, its textures read.
renderer::Renderer renderer_of(const RenderJob& film);

/// Refuses what is no scene, or not there, with the name beside it that may have been meant. Throws core::Error.
void check_scene(const std::filesystem::path& input);

/// Loads the scene and settles every setting. Throws core::Error for all that cannot be rendered or coded.
RenderJob prepare(const RenderOptions& options);

/// One exposure for the film, in EV: a few small, coarse frames spread over it are lit and their luminances judged.
float measure_exposure(const RenderJob& film);

/// The sound of a film of these frames: that of the options, else `scenes`, the scene's own. Decodes it once, in a
/// probe. Throws core::Error where it cannot be read, or where `output` is a film that cannot have any.
av::Sound sound_of(const CodingOptions& options, const std::optional<std::filesystem::path>& scenes,
                   const std::filesystem::path& output, const FrameRange& frames, const core::FrameRate& rate);

}  // namespace render2mpeg::app
