#pragma once
// All settings of a film.
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "app/coupling/coupling.h"
#include "app/files/light_file.h"
#include "app/job/eyes.h"
#include "app/options/film.h"
#include "app/options/options.h"
#include "app/options/output_kind.h"
#include "app/system/image_reader.h"
#include "core/rational.h"
#include "core/tolerance_map.h"
#include "encoder/av/sound.h"
#include "encoder/types.h"
#include "perceptual/display.h"
#include "renderer/base/plan.h"
#include "renderer/renderer.h"
#include "renderer/surface/texture_store.h"
#include "scene/model/animation.h"
#include "scene/pose/snapshot.h"

namespace render2mpeg::app {

struct CacheChoice {
    renderer::CacheUse use = renderer::CacheUse::off;
    std::string reason;  ///< for the plan's table

    bool keeps() const { return use != renderer::CacheUse::off; }
};

/// For reports: off, on, or static (records live while light stays).
std::string cache_word(const renderer::Settings& rendering);

/// Whether a run with these counts used the cache.
inline bool kept_records(const renderer::Settings& rendering, const renderer::Statistics& found) {
    return rendering.cache == renderer::CacheUse::on || found.cache.created > 0;
}

/// All settings of a film, with the options' gaps filled. Constant while it is rendered.
struct RenderJob {
    std::shared_ptr<const scene::Animation> animation;
    std::shared_ptr<ImageReader> images;               ///< of the animation
    std::shared_ptr<renderer::TextureStore> textures;  ///< likewise
    core::FrameRate rate;
    FrameRange frames;
    scene::PictureFormat format;  ///< of the pictures, which hold those of all eyes; `rendering` has that of one eye
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
    bool measures_exposure = false;  ///< no exposure is given
    core::View view;
    bool preview = false;     ///< a draft (app/options/film.h)
    bool rough = false;       ///< a first pass: its light is too rough to tell whether it changes
    bool is_sample = false;   ///< frames that stand for a film
    bool two_passes = false;  ///< the first one finds `allocations`
    std::vector<encoder::BitAllocation> allocations;  ///< one per frame, or none
    bool images_in_turn = false;                      ///< read one at a time: memory is short
    std::optional<int> exposure_samples;              ///< none: by quantiser
    int audit = 0;                   ///< pixels of every frame that are gathered again without clustering
    LightExtent known_light;         ///< of the light file
    std::optional<ChunkRange> part;  ///< chunks that this run makes of it; none: all

    std::int64_t frame_count() const { return frames.count(); }
    Size size() const { return {format.width, format.height}; }
    /// None: its pictures are files.
    std::optional<encoder::Codec> codec() const {
        return kind == OutputKind::film ? std::optional(coding.codec) : std::nullopt;
    }
    std::vector<Chunk> chunks() const;
    /// For two eyes: each has its part of the picture.
    bool is_stereo() const { return animation->stereo != core::FramePacking::none; }
    scene::Snapshot snapshot(std::int64_t frame) const { return snapshot(frame, eyes_of(animation->stereo).front()); }
    scene::Snapshot snapshot(std::int64_t frame, scene::Eye eye) const {
        return scene::snapshot_at(*animation, frame, core::time_of(frame, rate), rendering.format, shutter(), eye);
    }
    /// Makes its pictures about as large as this; both eyes' parts are alike.
    void resize(const Size& size) {
        format.width = size.width, format.height = size.height;
        rendering.format = of_eye(format, animation->stereo);
        format = packed(rendering.format, animation->stereo);
        coding.width = format.width, coding.height = format.height;
    }
    /// Closed where no frame would show that it is open.
    scene::ShutterInterval shutter() const {
        return plan.runs(renderer::Pass::shutter) ? scene::interval_of(animation->shutter, rate.hertz.value())
                                                  : scene::ShutterInterval();
    }
    core::ToleranceMap tolerance_map() const;
    /// Whether something is seen through the picture: its world, or holes.
    bool is_transparent() const;
    /// Whether images of its frames, or its pictures, have alpha.
    bool has_alpha() const;
    /// With 0 EV before the exposure is known.
    perceptual::Display display() const {
        const int grain = kind == OutputKind::film ? encoder::grain_of_pictures(coding) : coding.grain;
        return {exposure.value_or(0), colors().matrix, view, encoder::facts_of(coding.codec).exact_chroma(), grain};
    }
    perceptual::PictureColors colors() const { return {perceptual::matrix_for(format.height, view), view}; }
    Film film() const {
        return {animation->source, frames, coding, keyframes, disc, core::name_of(rendering.isa), sound};
    }
};

/// The film without a row of its plan (renderer::PlanRow::effect).
RenderJob without(const RenderJob& film, renderer::Pass effect);

/// The film as by --preview (app/options/film.h), in the same size.
RenderJob draft_of(const RenderJob& film);

/// The film as by --effort (app/options/film.h), with no more eye samples than it has, since references have the
/// film's own. What `options` give stays.
RenderJob at_effort(const RenderJob& film, const Effort& effort, const RenderOptions& options);

renderer::Renderer renderer_of(const RenderJob& film, std::optional<renderer::Renderer::KnownLight> known = {});

/// Refuses missing files and other kinds, with the nearest name beside it. Throws core::Error.
void check_scene(const std::filesystem::path& input);

/// Loads the scene and settles every setting. Throws core::Error.
RenderJob prepare(const RenderOptions& options);

/// Sound of the frames by the options, else `scenes`, the scene's own; decoded once in a probe. Throws core::Error for
/// unreadable sound, or an `output` without sound.
av::Sound sound_of(const CodingOptions& options, const std::optional<std::filesystem::path>& scenes,
                   const std::filesystem::path& output, const FrameRange& frames, const core::FrameRate& rate);

}  // namespace render2mpeg::app
