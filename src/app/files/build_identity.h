#pragma once

#include <string>

namespace render2mpeg::app {

/// The linker's hash of this program, in hexadecimal digits: two builds that differ have two. Empty where the linker
/// wrote none.
std::string build_identity();

}  // namespace render2mpeg::app
