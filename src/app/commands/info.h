#pragma once

#include <functional>
#include <string>

#include "app/options/options.h"

namespace render2mpeg::app {

/// `render2mpeg info`: prints how a film's pictures are coded (docs/first-film.md). Returns the exit status: 1 where
/// pictures are damaged. Throws core::Error where the file is no MPEG-2 film.
int info(const InfoOptions& options);

/// What info() prints of a film: the damage (empty where there is none), '\0', and the tables or JSON. Calls
/// `film_is_read` when other libraries have done their part. Throws core::Error.
std::string info_of(const InfoOptions& options, const std::function<void()>& film_is_read);

}  // namespace render2mpeg::app
