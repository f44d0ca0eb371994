#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "app/files/publish.h"
#include "app/loop/render_job.h"
#include "app/options/film.h"
#include "app/options/options.h"

namespace render2mpeg::app {

/// All that decides a film's bytes: version, build, instruction set, frames, options and inputs' checksums. Throws
/// core::Error where an input cannot be read.
nlohmann::json identity_of(const RenderJob& film, const RenderOptions& options);

/// The same for a film of finished frames, which cannot be resumed: its command and folder.
nlohmann::json identity_of(const Film& film, const std::string& command);

std::vector<Files> inputs_of(const RenderJob& film, const RenderOptions& options);

}  // namespace render2mpeg::app
