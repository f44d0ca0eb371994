#pragma once
// Exposure, effects and cache by command line and scene.
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "app/job/render_job.h"
#include "perceptual/display.h"
#include "renderer/renderer.h"
#include "scene/model/load_options.h"
#include "scene/preparation/traits.h"

namespace render2mpeg::app {

/// What of the command line decides how a scene is read. Throws UsageError.
scene::LoadOptions load_options_of(const RenderOptions& options);

/// --projection: all cameras show panoramas. Throws UsageError where one has no eye.
void set_projection(scene::Animation& animation, const std::string& name);

/// --stereo wins over the scene. Throws UsageError for pictures that cannot hold two eyes'.
void set_stereo(scene::Animation& animation, const RenderOptions& options, Size of_eye);

/// Notes where panoramas are stretched in pictures of this size.
void tell_shape(scene::Animation& animation, Size size);

/// What a film and its container are to say of its panoramas and eyes; notes where they cannot.
void describe_view(scene::Animation& animation, const RenderOptions& options, encoder::Settings& coding);
/// The same of finished frames, in a line where the file cannot. Throws UsageError for pictures that cannot hold two
/// eyes'.
void describe_view(const EncodeOptions& options, encoder::Settings& coding);

/// The scene's chapters, as far as these frames show them; notes where files cannot have any.
void set_chapters(scene::Animation& animation, const RenderOptions& options, const FrameRange& frames,
                  encoder::Labels& labels);

/// --shutter, --f-stop, --focus, --fog, --glare and --transparent win over the scene. Throws UsageError for
/// contradictions.
void change_scene(scene::Animation& animation, const RenderOptions& options);

/// Adds samples per pixel to the reasons of the plan's rows.
void tell_samples(RenderJob& film);

/// Samples of a pixel blurred by shutter or lens: as many as survive this quantiser
/// (docs/measurements.md#shutter-and-lens), uncoded frames as with quantiser 4.
renderer::ExposureSamples exposure_samples(const RenderJob& film, int quantiser);

/// The same for a picture on this display: more where lamps show, unless given by hand.
renderer::ExposureSamples exposure_samples(const RenderJob& film, int quantiser, const perceptual::Display& display);

/// `asked`: on, off or auto, which caches where that pays in pictures of `pixels`. `reference`: nothing is cached.
/// `rays`: renderer::Indirect::rays.
CacheChoice choose_cache(const std::string& asked, const scene::Traits& traits, bool rays, bool reference,
                         std::int64_t frames, std::int64_t pixels);

}  // namespace render2mpeg::app
