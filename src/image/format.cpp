#include "image/format.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <string_view>

#include "core/checksum.h"
#include "core/error.h"
#include "core/text.h"
#include "image/image.h"

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

constexpr std::size_t signature_bytes = 8;

std::uint32_t big_endian(std::span<const std::byte> bytes) {
    std::uint32_t value = 0;
    for (const std::byte b : bytes.first(4)) value = value << 8 | std::to_integer<std::uint32_t>(b);
    return value;
}

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

struct Name {
    std::string layer;    ///< the part before the last dot
    std::string channel;  ///< the part after it, in lower case
};

Name split(const std::string& name) {
    const std::size_t dot = name.rfind('.');
    if (dot == std::string::npos) return {"", core::lower_case(name)};
    return {name.substr(0, dot), core::lower_case(name.substr(dot + 1))};
}

/// 0..3 for red, green, blue and alpha, 4 for luminance, -1 for all others.
int component_of(const std::string& channel) {
    static const std::map<std::string, int> components{
        {"r", 0}, {"red", 0},  {"g", 1},    {"green", 1}, {"b", 2}, {"blue", 2},     {"a", 3},
        {"y", 4}, {"grey", 4}, {"gray", 4}, {"alpha", 3}, {"i", 4}, {"luminance", 4}};
    const auto found = components.find(channel);
    return found == components.end() ? -1 : found->second;
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

void check_size(int width, int height, std::size_t file_bytes, Format format, const std::string& name) {
    const std::uint64_t pixels = static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
    if (pixels > max_pixels)
        throw core::Error("reading", name,
                          std::to_string(width) + " x " + std::to_string(height) + " pixels: the limit is " +
                              std::to_string(max_pixels) + " in all");
    if (pixels > max_pixels_per_byte(format) * file_bytes)
        throw core::Error("reading", name, "the file is too short for its size in pixels");
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
    Walk walk(bytes);
    walk.skip(14);
    if (walk.little_endian() <= 12) return false;
    walk.skip(12);
    const std::uint32_t how = walk.little_endian();
    return how != 0 && how != 3 && how != 6;
}

std::vector<std::byte> essential_png(std::span<const std::byte> bytes, const std::string& name) {
    constexpr std::array<std::string_view, 5> essential{"IHDR", "PLTE", "tRNS", "IDAT", "IEND"};
    const auto refuse = [&](const std::string& cause) { throw core::Error("reading", name, cause); };
    std::vector<std::byte> kept(bytes.begin(), bytes.begin() + signature_bytes);
    bool has_pixels = false, has_shape = false;

    // Each chunk is four bytes of length, four of type, the content, four of check sum over type and content.
    for (std::span<const std::byte> rest = bytes.subspan(signature_bytes);;) {
        if (rest.size() < 12) refuse("the PNG file is cut off");
        const std::size_t length = big_endian(rest);
        if (length > rest.size() - 12) refuse("the PNG file is cut off");
        const std::span<const std::byte> chunk = rest.first(length + 12);
        const std::string type(reinterpret_cast<const char*>(chunk.data()) + 4, 4);
        rest = rest.subspan(chunk.size());

        const bool sound = core::crc_of(chunk.subspan(4, length + 4)) == big_endian(chunk.subspan(length + 8));
        if (type == "pHYs" && sound && length == 9 && !has_pixels && !has_shape) {
            kept.insert(kept.end(), chunk.begin(), chunk.end());
            has_shape = true;
        } else if (std::find(essential.begin(), essential.end(), type) != essential.end()) {
            if (!sound) refuse("the PNG file is damaged (check sum of " + type + ")");
            kept.insert(kept.end(), chunk.begin(), chunk.end());
            if (type == "IHDR" &&
                (length != 13 || big_endian(chunk.subspan(8)) == 0 || big_endian(chunk.subspan(12)) == 0))
                refuse("it has no pixels");
            has_pixels = has_pixels || type == "IDAT";
            if (type == "IEND") break;
        } else if ((chunk[4] & std::byte{0x20}) == std::byte{0}) {
            // The first letter is a capital: the pixels mean nothing without it.
            refuse("the PNG file is damaged or not standard (a chunk that must be understood is not known)");
        }
    }
    if (!has_pixels) refuse("it has no pixels");
    return kept;
}

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

int ChannelChoice::count() const {
    return static_cast<int>(std::count_if(channel.begin(), channel.end(), [](int c) { return c >= 0; }));
}

bool ChannelChoice::consecutive() const {
    for (int i = 0; i < count(); ++i)
        if (channel[static_cast<std::size_t>(i)] != channel[0] + i) return false;
    return true;
}

ChannelChoice choose_channels(const std::vector<std::string>& names, int alpha_channel) {
    EXPECTS(!names.empty());

    // Gather each layer's colours, layers in the order of the file but the unnamed one first.
    std::vector<std::pair<std::string, std::array<int, 5>>> layers{{"", {-1, -1, -1, -1, -1}}};
    for (std::size_t i = 0; i < names.size(); ++i) {
        const Name name = split(names[i]);
        const int component = component_of(name.channel);
        if (component < 0) continue;
        auto layer = std::find_if(layers.begin(), layers.end(), [&](const auto& l) { return l.first == name.layer; });
        if (layer == layers.end()) layer = layers.insert(layers.end(), {name.layer, {-1, -1, -1, -1, -1}});
        int& place = layer->second[static_cast<std::size_t>(component)];
        if (place < 0) place = static_cast<int>(i);
    }

    // Prefer colours over luminance, in whatever layer.
    for (const auto& [layer, c] : layers)
        if (c[0] >= 0 && c[1] >= 0 && c[2] >= 0)
            return {{c[0], c[1], c[2], c[3] >= 0 ? c[3] : layer.empty() ? alpha_channel : -1}};
    for (const auto& [layer, c] : layers)
        if (c[4] >= 0) return {{c[4], -1, -1, c[3] >= 0 ? c[3] : layer.empty() ? alpha_channel : -1}};

    // Take unnamed channels in their order, alpha apart.
    std::vector<int> others;
    for (int i = 0; i < static_cast<int>(names.size()); ++i)
        if (i != alpha_channel) others.push_back(i);
    if (others.size() >= 3) return {{others[0], others[1], others[2], alpha_channel}};
    return {{others.empty() ? 0 : others[0], -1, -1, others.empty() ? -1 : alpha_channel}};
}

}  // namespace render2mpeg::image
