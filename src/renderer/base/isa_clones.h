#pragma once
// The renderer's name for functions compiled by instruction set.
#include "core/isa_clones.h"

namespace render2mpeg::renderer {

namespace inlined = core::inlined;

}  // namespace render2mpeg::renderer
