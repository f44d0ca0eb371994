#pragma once
// Mattes by name in OpenEXR files [Cryptomatte].
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/mattes.h"
#include "image/image.h"

namespace render2mpeg::image {

/// Names that mattes go by, by index.
struct MatteNames {
    std::vector<std::string> objects, materials;
};

/// MurmurHash3_x86_32 with seed 0.
std::uint32_t matte_hash(std::string_view name);

/// The hash as a float that is neither infinite, NaN nor denormal.
float matte_id(std::string_view name);

/// Adds the layers ViewLayer.CryptoObject00 to 02 and CryptoMaterial00 to 02, six ranks each, to the channels, and what
/// says so to the header. Parts of one name are one.
void add_cryptomatte(const core::Mattes& mattes, const MatteNames& names, std::vector<Channel>& channels,
                     FrameFacts& facts);

}  // namespace render2mpeg::image
