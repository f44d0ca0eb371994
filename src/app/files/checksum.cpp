#include "app/files/checksum.h"

#include <filesystem>

#include "core/error.h"

namespace render2mpeg::app {

std::uint64_t checksum_of(const core::Picture& picture) {
    Checksum sum;
    for (const core::Plane<std::uint8_t>* plane : {&picture.y, &picture.cb, &picture.cr}) sum.add(plane->values());
    return sum.value();
}

std::string build_identity() {
    try {
        return text_of(checksum_of(std::filesystem::path("/proc/self/exe")));
    } catch (const core::Error&) {
        return {};
    }
}

std::string text_of(std::uint64_t checksum) {
    return core::checksum_text(checksum);
}

}  // namespace render2mpeg::app
