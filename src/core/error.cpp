#include "core/error.h"

namespace render2mpeg::core {
namespace {

std::string join(std::string_view doing, std::string_view file, std::string_view object, std::string_view cause) {
    std::string line;
    line.append(doing).append(" ").append(file);
    if (!object.empty()) line.append(": ").append(object);
    return line.append(": ").append(cause);
}

}  // namespace

Error::Error(std::string_view doing, std::string_view file, std::string_view cause)
    : std::runtime_error(join(doing, file, {}, cause)) {}

Error::Error(std::string_view doing, std::string_view file, std::string_view object, std::string_view cause)
    : std::runtime_error(join(doing, file, object, cause)) {}

ContractViolation::ContractViolation(const char* condition, const char* file, int line)
    : std::logic_error(std::string("broken contract: ") + condition + " (" + file + ":" + std::to_string(line) + ")") {}

}  // namespace render2mpeg::core
