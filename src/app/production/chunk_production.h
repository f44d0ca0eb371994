#pragma once

#include <cstddef>

#include "app/production/production.h"

namespace render2mpeg::app {

/// Makes the chunks that have no file yet, up to `at_once` beside each other, and adds their files and statistics to
/// the render's, in the order of the film. Of those that an interruption stopped only the one that follows the whole
/// ones is among them, incomplete. A failure stops all; throws the first one in the order of the film. Returns whether
/// all are whole.
bool make_chunks(const OpenRender& open, std::size_t at_once);

}  // namespace render2mpeg::app
