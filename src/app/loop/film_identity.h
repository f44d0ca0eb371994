#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "app/files/publish.h"
#include "app/loop/render_job.h"
#include "app/options/film.h"
#include "app/options/options.h"

namespace render2mpeg::app {

/// What decides a film's bytes: version, instruction set, frames, the options that count, and what the files hold that
/// it is made from. Two runs with one identity make one film. Reads all inputs. Throws core::Error where one cannot be
/// read.
nlohmann::json identity_of(const RenderJob& film, const RenderOptions& options);

/// The same for a film of frames from outside, which cannot be resumed: by its command and the folder that was given
/// in.
nlohmann::json identity_of(const Film& film, const std::string& command);

/// The files that a film is made from, as far as they are known.
std::vector<Files> inputs_of(const RenderJob& film, const RenderOptions& options);

}  // namespace render2mpeg::app
