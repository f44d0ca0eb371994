#pragma once
// Refuses OpenEXR files whose headers lie about sizes.
#include <cstddef>
#include <span>
#include <string>

namespace render2mpeg::image {

/// Refuses an OpenEXR file one of whose headers has an attribute that is larger than what is left of the file: the
/// library makes room for it first, 2 GiB for four bytes that say so. Throws core::Error, naming the attribute.
void check_exr_attributes(std::span<const std::byte> bytes, const std::string& name);

}  // namespace render2mpeg::image
