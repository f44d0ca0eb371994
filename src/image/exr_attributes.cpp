#include "image/exr_attributes.h"

#include <algorithm>
#include <cstdint>
#include <string_view>

#include "core/error.h"

namespace render2mpeg::image {
namespace {

/// Reads a file from its start; where that ends it is 0s and empty words.
class Walk {
  public:
    explicit Walk(std::span<const std::byte> bytes)
        : text_(reinterpret_cast<const char*>(bytes.data()), bytes.size()) {}

    std::uint32_t little_endian() {
        std::uint32_t value = 0;
        for (int shift = 0; shift < 32 && !text_.empty(); shift += 8, text_.remove_prefix(1))
            value |= static_cast<std::uint32_t>(static_cast<unsigned char>(text_.front())) << shift;
        return value;
    }
    /// Up to a byte 0, which is taken too.
    std::string_view word() {
        const std::string_view found = text_.substr(0, text_.find('\0'));
        skip(found.size() + 1);
        return found;
    }
    void skip(std::size_t count) { text_.remove_prefix(std::min(count, text_.size())); }
    std::size_t left() const { return text_.size(); }

  private:
    std::string_view text_;
};

}  // namespace

// A file is a mark, a version with flags, and one or more headers; a header is attributes, each a name, a type, a size
// and so many bytes, up to an empty name. Of a file of several parts, an empty header ends them. [OpenEXRFile]
void check_exr_attributes(std::span<const std::byte> bytes, const std::string& name) {
    constexpr std::uint32_t several_parts = 1u << 12;
    Walk walk(bytes);
    walk.little_endian();
    const bool several = (walk.little_endian() & several_parts) != 0;
    bool in_header = false;
    while (walk.left() > 0) {
        const std::string_view attribute = walk.word();
        if (attribute.empty() && (!several || !in_header)) return;
        in_header = !attribute.empty();
        if (!in_header) continue;
        walk.word();
        const std::uint32_t size = walk.little_endian();
        if (size > walk.left()) {
            std::string shown(attribute.substr(0, 60));
            std::replace_if(
                shown.begin(), shown.end(), [](unsigned char c) { return c < 32 || c > 126; }, '?');
            throw core::Error("reading", name,
                              "its attribute \"" + shown + "\" says " + std::to_string(size) +
                                  " bytes, of which the file has " + std::to_string(walk.left()));
        }
        walk.skip(size);
    }
}

}  // namespace render2mpeg::image
