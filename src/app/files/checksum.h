#pragma once

#include <cstdint>
#include <string>

#include "core/checksum.h"
#include "core/picture.h"

namespace render2mpeg::app {

using core::Checksum;
using core::checksum_of;

/// Of a picture's three planes.
std::uint64_t checksum_of(const core::Picture& picture);

/// Of this program: two builds that differ have two. Empty where it cannot be read.
std::string build_identity();

/// 16 hexadecimal digits.
std::string text_of(std::uint64_t checksum);

}  // namespace render2mpeg::app
