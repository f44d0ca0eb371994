#pragma once
#include "app/job/render_job.h"

namespace render2mpeg::app {

/// Exposure of the film in EV, by a few small, coarse frames.
float measure_exposure(const RenderJob& film);

}  // namespace render2mpeg::app
