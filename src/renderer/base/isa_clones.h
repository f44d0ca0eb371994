#pragma once

#include "core/isa_clones.h"

namespace render2mpeg::renderer {

namespace inlined = core::inlined;

}  // namespace render2mpeg::renderer
