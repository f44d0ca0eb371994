#pragma once
// Takes a film's inputs along, for machines that do not see this one's files.
#include "app/farm/farm_plan.h"

namespace render2mpeg::app {

/// Copies all inputs of a film into the plan's folder, and changes `words` and `start` so that they name the copies,
/// and outputs by their full names. Throws core::Error.
void pack_inputs(FarmPlan& plan, const RenderJob& film, const RenderOptions& options);

/// Writes plan, job files and inputs into one file beside the folder, e.g. film.mpg.farm.tar. Throws core::Error.
void write_pack(const FarmPlan& plan);

}  // namespace render2mpeg::app
