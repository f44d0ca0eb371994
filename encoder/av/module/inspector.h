#pragma once
// Reads types, quantisers and vectors of a film's pictures, with libavcodec.
#include <filesystem>

#include "encoder/av/inspect.h"

/// Reads how a film is coded with libavcodec: `av::inspect` inside the module.
namespace render2mpeg::av {

/// inspect() of encoder/av/inspect.h.
Inspection inspect_film(const std::filesystem::path& file);

}  // namespace render2mpeg::av
