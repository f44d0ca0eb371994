#pragma once
// Reads usual PNG and JPEG files by their own libraries, which start at once.
#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "image/format.h"
#include "image/image.h"
#include "image/stored_image.h"

namespace render2mpeg::image {

/// Decodes a PNG of at most 8 bits a channel (without other chunks than essential_png() keeps) or a JPEG of grey or
/// three colours; none for what is left to OpenImageIO. Throws core::Error as read_image().
std::optional<StoredImage> decode_png_or_jpeg(std::span<const std::byte> bytes, Format format, const std::string& name);

/// The same without its pixels.
std::optional<ImageHeader> header_of_png_or_jpeg(std::span<const std::byte> bytes, Format format,
                                                 const std::string& name);

}  // namespace render2mpeg::image
