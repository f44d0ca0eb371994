#pragma once
// Codes with libavcodec's encoders, and decodes beside them.
#include <memory>

#include "encoder/av/backend.h"

namespace render2mpeg::av {

/// `Backend::check_encoder` and `Backend::open_encoder` inside the module.
void check_library_encoder(const encoder::Settings& settings);
std::unique_ptr<LibraryEncoder> open_library_encoder(const encoder::Settings& settings, const IndexOffsets& offsets);

}  // namespace render2mpeg::av
