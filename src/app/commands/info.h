#pragma once

#include "app/options/options.h"

namespace render2mpeg::app {

/// `render2mpeg info`: prints how a film's pictures are coded (docs/info.md). Returns the exit status: 1 where pictures
/// are damaged. Throws core::Error where the file is no MPEG-2 film.
int info(const InfoOptions& options);

}  // namespace render2mpeg::app
