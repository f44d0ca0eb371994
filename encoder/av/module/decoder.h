#pragma once
// Decodes a film for verification, with libavcodec.
#include <filesystem>
#include <functional>

#include "core/picture.h"

/// Decodes films with libavcodec: `av::decode` inside the module.
namespace render2mpeg::av {

/// `av::decode` inside the module.
void decode_film(const std::filesystem::path& file, const std::function<void(const core::Picture&)>& picture);

}  // namespace render2mpeg::av
