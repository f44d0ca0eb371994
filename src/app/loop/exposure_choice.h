#pragma once
// How frames are exposed: what the command line says of shutter and lens, and how many samples a picture shows.
#include "app/loop/render_job.h"
#include "perceptual/display.h"

namespace render2mpeg::app {

/// Lets --shutter, --f-stop and --focus win over what the scene says. Throws UsageError for what cannot be meant.
void set_exposure(scene::Animation& animation, const RenderOptions& options);

/// Lets --fog win over how far one sees by what the scene says.
void set_fog(scene::Animation& animation, const RenderOptions& options);

/// Lets --glare win over what the scene says.
void set_glare(scene::Animation& animation, const RenderOptions& options);

/// Lets the rows of the film's plan tell how many samples pixels get.
void tell_samples(RenderJob& film);

/// Samples of a pixel that shutter or lens blur, for a picture to be coded with this quantiser: as many as make a
/// difference after coding (docs/measurements.md#shutter-and-lens). What is not coded gets as many as quantiser 4.
renderer::ExposureSamples exposure_samples(const RenderJob& film, int quantiser);

/// The same for a picture that is shown like this: where lamps show, more of them if they are not told by hand.
renderer::ExposureSamples exposure_samples(const RenderJob& film, int quantiser, const perceptual::Display& display);

}  // namespace render2mpeg::app
