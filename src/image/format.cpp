#include "image/format.h"

#include <array>
#include <cctype>
#include <cstdint>
#include <string_view>

#include "core/text.h"

namespace render2mpeg::image {
namespace {

using namespace std::string_view_literals;

struct Mark {
    Format format;
    std::string_view bytes;
    std::size_t at = 0;
};

/// First bytes by each format's own specification.
constexpr std::array marks{
    Mark{Format::png, "\x89PNG\r\n\x1a\n"sv},
    Mark{Format::jpeg, "\xff\xd8\xff"sv},
    Mark{Format::exr, "\x76\x2f\x31\x01"sv},
    Mark{Format::hdr, "#?RADIANCE"sv},
    Mark{Format::hdr, "#?RGBE"sv},
    Mark{Format::bmp, "BM"sv},
    Mark{Format::tiff, "II*\0"sv},
    Mark{Format::tiff, "MM\0*"sv},
    Mark{Format::gif, "GIF87a"sv},
    Mark{Format::gif, "GIF89a"sv},
    Mark{Format::webp, "WEBP"sv, 8},
    Mark{Format::psd, "8BPS"sv},
    Mark{Format::dds, "DDS "sv},
};

bool has_mark(std::string_view text, const Mark& mark) {
    return text.size() >= mark.at + mark.bytes.size() && text.substr(mark.at, mark.bytes.size()) == mark.bytes;
}

/// P1..P6 (bits, grey, colour) and Pf, PF (float), each followed by white space.
bool is_pnm(std::string_view text) {
    return text.size() >= 3 && text[0] == 'P' && std::string_view("123456fF").find(text[1]) != std::string_view::npos &&
           std::isspace(static_cast<unsigned char>(text[2])) != 0;
}

bool is_tga(std::string_view text, const std::string& name) {
    constexpr auto footer = "TRUEVISION-XFILE.\0"sv;
    if (text.size() >= footer.size() && text.substr(text.size() - footer.size()) == footer) return true;
    return core::ending_of(name) == ".tga" && text.size() >= 18;
}

}  // namespace

const char* name_of(Format format) {
    constexpr std::array names{"png",  "jpeg", "openexr", "hdr", "targa", "bmp",
                               "tiff", "gif",  "webp",    "psd", "dds",   "pnm"};
    return names[static_cast<std::size_t>(format)];
}

std::uint64_t max_pixels_per_byte(Format format) {
    switch (format) {
        case Format::png:
            return 8 * 1032;  // deflate packs 1032 bytes into one [RFC1951], a byte holds 8 pixels of one bit
        case Format::tga:
            return 128;  // runs of 128 pixels in two bytes and more
        case Format::pnm:
            return 8;  // one bit per pixel
        case Format::dds:
            return 2;  // blocks of 16 pixels in 8 bytes
        default:
            return 16384;  // chosen: what no picture needs; runs, arithmetic codes and fax codes have no limit of their
                           // own
    }
}

std::optional<Format> format_of(std::span<const std::byte> bytes, const std::string& name) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    for (const Mark& mark : marks)
        if (has_mark(text, mark)) return mark.format;
    if (is_pnm(text)) return Format::pnm;
    if (is_tga(text, name)) return Format::tga;
    return std::nullopt;
}

bool is_cut_off_jpeg(std::span<const std::byte> bytes) {
    const auto byte_at = [&](std::size_t i) { return std::to_integer<std::uint8_t>(bytes[i]); };

    // Step over the segments before the first scan: their contents (thumbnails) may hold end markers of their own.
    // [T81, B.1.1]
    std::size_t at = 2;
    while (true) {
        if (at + 4 > bytes.size() || byte_at(at) != 0xff) return true;
        const std::uint8_t marker = byte_at(at + 1);
        if (marker == 0xff) {  // fill bytes before a marker
            ++at;
            continue;
        }
        const std::size_t length = byte_at(at + 2) * std::size_t{256} + byte_at(at + 3);
        at += 2 + length;
        if (marker == 0xda) break;
    }

    // In coded data 0xff is followed by 0, so that an end marker is one.
    for (; at + 1 < bytes.size(); ++at)
        if (byte_at(at) == 0xff && byte_at(at + 1) == 0xd9) return false;
    return true;
}

bool is_packed_bmp(std::span<const std::byte> bytes) {
    // After the file's own 14 bytes a header begins with its size; that of 12 bytes knows no packing, all others say at
    // byte 16 of theirs how: 0 not at all, 3 and 6 with masks.
    constexpr std::size_t header = 14, packing = header + 16;
    if (bytes.size() < packing + 4) return false;
    const auto number_at = [&](std::size_t at) {
        std::uint32_t value = 0;
        for (std::size_t k = 4; k-- > 0;) value = value << 8 | std::to_integer<std::uint32_t>(bytes[at + k]);
        return value;
    };
    if (number_at(header) <= 12) return false;
    const std::uint32_t how = number_at(packing);
    return how != 0 && how != 3 && how != 6;
}

}  // namespace render2mpeg::image
