#pragma once
// What a render writes: checked before hours go into it, and opened.
#include <memory>
#include <nlohmann/json_fwd.hpp>

#include "app/files/consent.h"
#include "app/files/work_folder.h"
#include "app/loop/render_job.h"
#include "app/options/options.h"

namespace render2mpeg::app {

/// Whether the output is one file, which is made in a work folder.
bool is_one_file(const RenderJob& film);

/// Refuses what needs no scene to be refused: outputs that nobody can write, and films that are there already. To be
/// called before a scene is read, which may take minutes. Throws core::Error or Refusal.
void check_before_reading(const RenderOptions& options);

/// Refuses outputs that would take the place of other files, or show what there is none of. Writes nothing. Throws
/// core::Error.
void check_outputs(const RenderJob& film, const RenderOptions& options);

/// Outputs of the film, for require_consent().
Wishes written_by(const RenderJob& film, const RenderOptions& options);

/// Sees that all outputs can be written before hours go into them; from now on no other run has the film.
std::unique_ptr<WorkFolder> open_outputs(const RenderOptions& options, const nlohmann::json& identity);

}  // namespace render2mpeg::app
