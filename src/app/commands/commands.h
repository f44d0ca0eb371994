#pragma once
#include <functional>
#include <string>

#include "app/loop/run_statistics.h"
#include "app/options/options.h"

namespace render2mpeg::app {

/// `render2mpeg encode`: frames and motion of any renderer to a film. Returns the exit status: 0, or 130 after an
/// interruption. Throws core::Error.
int encode(const EncodeOptions& options, const std::string& command);

/// `render2mpeg info`: prints how a film's pictures are coded (docs/first-film.md). Returns the exit status: 1 where
/// pictures are damaged. Throws core::Error where the file is no MPEG-2 film.
int info(const InfoOptions& options);

/// What info() prints of a film: the damage (empty where there is none), '\0', and the tables or JSON. Calls
/// `film_is_read` when other libraries have done their part. Throws core::Error.
std::string info_of(const InfoOptions& options, const std::function<void()>& film_is_read);

/// `render2mpeg render`. Returns the exit status: 0, or 130 after an interruption. Throws core::Error. `rendered` is
/// filled where it is not null.
int render(const RenderOptions& options, const std::string& command, Rendered* rendered = nullptr);

/// `render2mpeg plan`.
int plan(const PlanOptions& options);

/// `render2mpeg watch`: a draft of the film, and another one whenever its files change, in a player or a file, until
/// the player is closed or the user interrupts. Returns the exit status. Throws core::Error for what no change of the
/// files would mend.
int watch(const RenderOptions& options, const std::string& command);

}  // namespace render2mpeg::app
