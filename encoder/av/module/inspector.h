#pragma once

#include <filesystem>

#include "encoder/av/inspect.h"

namespace render2mpeg::av {

/// inspect() of encoder/av/inspect.h.
Inspection inspect_film(const std::filesystem::path& file);

}  // namespace render2mpeg::av
