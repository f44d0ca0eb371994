#include "tests/support/places.h"

namespace render2mpeg::support {

std::filesystem::path source_folder() {
    return RENDER2MPEG_SOURCE_DIR;
}

std::filesystem::path binary_folder() {
    return RENDER2MPEG_BINARY_DIR;
}

}  // namespace render2mpeg::support
