#include "core/plain_file.h"

#include <system_error>

namespace render2mpeg::core {

std::string why_no_plain_file(const std::filesystem::path& file) {
    using enum std::filesystem::file_type;
    std::error_code failure;
    const auto is_not = [](const char* kind) {
        return std::string("it is a ") + kind + "; plain files alone are read";
    };
    switch (std::filesystem::status(file, failure).type()) {
        case regular:
            return {};
        case directory:
            return is_not("folder");
        case block:
        case character:
            return is_not("device");
        case fifo:
            return is_not("pipe");
        case socket:
            return is_not("socket");
        default:
            return "there is no such file";
    }
}

}  // namespace render2mpeg::core
