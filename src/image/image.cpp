#include "image/image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <memory>
#include <set>
#include <system_error>

#include "core/error.h"
#include "core/module.h"
#include "core/plain_file.h"
#include "image/format.h"
#include "image/module/codec.h"
#include "image/png_jpeg.h"
#include "image/stored_image.h"

namespace render2mpeg::image {
namespace {

namespace fs = std::filesystem;

/// Larger files are refused: 4 GiB holds the largest image at 16 bytes per pixel.
constexpr std::uintmax_t max_file_bytes = std::uintmax_t{1} << 32;

/// Opens OpenEXR at the first call, which takes some milliseconds, and limits its windows.
const ExrCodec& exr_codec() {
    static const ExrCodec& opened = *core::module_function<const ExrCodec*()>("exr", "render2mpeg_exr_codec")();
    return opened;
}

/// Opens OpenImageIO at the first call, which costs half a second. It reads OpenEXR files by the same library, which
/// must have its limits before.
const Codec& codec() {
    static const Codec& opened =
        (exr_codec(), *core::module_function<const Codec*()>("image", "render2mpeg_image_codec")());
    return opened;
}

std::vector<std::byte> bytes_of_file(const fs::path& path, const std::string& name) {
    std::error_code failure;
    const fs::file_status status = fs::status(path, failure);
    if (!fs::exists(status)) throw core::Error("reading", name, "no such file");
    if (const std::string why = core::why_no_plain_file(path); !why.empty()) throw core::Error("reading", name, why);
    const std::uintmax_t size = fs::file_size(path, failure);
    if (failure) throw core::Error("reading", name, failure.message());
    if (size > max_file_bytes) throw core::Error("reading", name, "larger than 4 GiB");

    std::vector<std::byte> bytes(static_cast<std::size_t>(size));
    std::ifstream file(path, std::ios::binary);
    file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    if (!file) throw core::Error("reading", name, "cannot be opened or read");
    return bytes;
}

/// An encoded image that a decoder may see.
struct Encoded {
    /// Takes a path with nothing in memory as a file, and memory as it is. Throws core::Error.
    Encoded(const fs::path& path, std::span<const std::byte> memory, const std::string& name) : bytes(memory) {
        if (bytes.empty()) bytes = storage = bytes_of_file(path, name);
        if (bytes.empty()) throw core::Error("reading", name, "the image is empty");

        // Refuse data that no decoder should see.
        const std::optional<Format> known = format_of(bytes, name.empty() ? path.string() : name);
        if (!known)
            throw core::Error(
                "reading", name,
                "not an image of a known kind (PNG, JPEG, OpenEXR, HDR, TGA, BMP, TIFF, GIF, WebP, PSD, DDS, PNM)");
        format = *known;
        if (format == Format::jpeg && is_cut_off_jpeg(bytes))
            throw core::Error("reading", name, "the JPEG file is cut off");
        if (format == Format::bmp && is_packed_bmp(bytes))
            throw core::Error("reading", name, "BMP files whose pixels are packed are not read");
        if (format == Format::exr) check_exr_attributes(bytes, name);
        if (format == Format::png) bytes = storage = essential_png(bytes, name);
    }
    Encoded(const Encoded&) = delete;
    Encoded& operator=(const Encoded&) = delete;

    std::vector<std::byte> storage;  ///< of `bytes`, where these are no caller's
    std::span<const std::byte> bytes;
    Format format = Format::png;
};

std::vector<std::byte> bytes_of_exr(const fs::path& path) {
    const std::string name = path.string();
    std::vector<std::byte> bytes = bytes_of_file(path, name);
    if (format_of(bytes, name) != Format::exr) throw core::Error("reading", name, "not an OpenEXR file");
    check_exr_attributes(bytes, name);
    return bytes;
}

/// Readers of a folder of frames must never see half a file: the name appears when the bytes are there.
void replace_file(const fs::path& path, std::span<const unsigned char> bytes) {
    fs::path unfinished = path;
    unfinished += ".part";
    std::ofstream file(unfinished, std::ios::binary | std::ios::trunc);
    file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    file.close();
    std::error_code failure;
    if (file) fs::rename(unfinished, path, failure);
    if (file && !failure) return;

    std::error_code ignored;
    fs::remove(unfinished, ignored);
    throw core::Error("writing", path.string(),
                      failure ? failure.message() : "cannot be created or written (folder, permissions, disk space?)");
}

}  // namespace

Image read_image(const fs::path& path, std::span<const std::byte> bytes, const std::string& name) {
    const Encoded file(path, bytes, name);
    const std::optional<StoredImage> stored = decode_png_or_jpeg(file.bytes, file.format, name);
    if (!stored) return codec().decode(file.bytes, file.format, name);
    Image image{core::Plane<glm::vec4>(stored->width, stored->height), stored->has_alpha, stored->pixel_aspect};
    std::transform(stored->codes.begin(), stored->codes.end(), image.pixels.values().begin(), StoredImage::value_of);
    return image;
}

StoredImage read_stored_image(const fs::path& path, std::span<const std::byte> bytes, const std::string& name) {
    const Encoded file(path, bytes, name);
    if (std::optional<StoredImage> stored = decode_png_or_jpeg(file.bytes, file.format, name)) return *stored;
    const auto image = std::make_shared<const Image>(codec().decode(file.bytes, file.format, name));
    StoredImage stored(*image);
    if (stored.codes.empty()) stored.memory = image;
    return stored;
}

ImageHeader read_image_header(const fs::path& path, std::span<const std::byte> bytes, const std::string& name) {
    const Encoded file(path, bytes, name);
    const std::optional<ImageHeader> header = header_of_png_or_jpeg(file.bytes, file.format, name);
    return header ? *header : codec().header_of(file.bytes, file.format, name);
}

void open_decoder(const fs::path& path, std::span<const std::byte> bytes, const std::string& name) {
    std::array<std::byte, 16> start{};
    if (bytes.empty() &&
        std::ifstream(path, std::ios::binary).read(reinterpret_cast<char*>(start.data()), start.size()))
        bytes = start;
    const std::optional<Format> format = format_of(bytes, name);
    if (format != Format::png && format != Format::jpeg) codec();
}

ExrChannels read_exr(const fs::path& path, const std::function<bool(const std::string&)>& wanted) {
    return exr_codec().decode(bytes_of_exr(path), wanted, path.string());
}

ExrFrame read_exr_frame(const fs::path& path, const std::function<bool(const std::string&)>& wanted) {
    const std::string name = path.string();
    const std::vector<std::byte> bytes = bytes_of_exr(path);

    // See which channels there are, then read those that anybody wants.
    std::vector<std::string> names;
    exr_codec().decode(
        bytes,
        [&](const std::string& channel) {
            names.push_back(channel);
            return false;
        },
        name);
    if (names.empty()) throw core::Error("reading", name, "it has no channels");
    const ChannelChoice choice = choose_channels(names, -1);
    const auto component_of = [&](const std::string& channel) {
        for (std::size_t c = 0; c < 4; ++c)
            if (choice.channel[c] >= 0 && names[static_cast<std::size_t>(choice.channel[c])] == channel)
                return static_cast<int>(c);
        return -1;
    };
    ExrChannels read = exr_codec().decode(
        bytes, [&](const std::string& channel) { return component_of(channel) >= 0 || wanted(channel); }, name);

    // Part colours from the others.
    ExrFrame frame;
    frame.image.pixels = core::Plane<glm::vec4>(read.width, read.height, glm::vec4(0, 0, 0, 1));
    frame.image.has_alpha = choice.channel[3] >= 0;
    frame.image.pixel_aspect = read.pixel_aspect;
    frame.image.high_range = true;
    frame.others = {read.width, read.height, {}, read.pixel_aspect};
    for (Channel& channel : read.channels) {
        const int component = component_of(channel.name);
        for (std::size_t i = 0; component >= 0 && i < channel.values.size(); ++i)
            frame.image.pixels.values()[i][component] = channel.values[i];
        if (wanted(channel.name)) frame.others.channels.push_back(std::move(channel));
    }
    if (choice.is_grey())
        for (glm::vec4& pixel : frame.image.pixels.values()) pixel.y = pixel.z = pixel.x;
    return frame;
}

void write_exr(const fs::path& path, int width, int height, std::span<const Channel> channels,
               const FrameFacts& facts) {
    EXPECTS(width > 0 && height > 0 && !channels.empty());
    EXPECTS(facts.pixel_aspect > 0 && std::isfinite(facts.pixel_aspect));
    std::set<std::string> names;
    for (const Channel& channel : channels) {
        EXPECTS(!channel.name.empty() && names.insert(channel.name).second);
        EXPECTS(channel.values.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    }
    replace_file(path, exr_codec().encode(width, height, channels, facts, path.string()));
}

std::vector<unsigned char> png_bytes(int width, int height, std::span<const unsigned char> rgb,
                                     const std::string& name) {
    EXPECTS(width > 0 && height > 0);
    EXPECTS(rgb.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3);
    return codec().encode_png(width, height, rgb, 1, name);
}

void open_writer(const std::string& ending) {
    EXPECTS(ending == ".png" || ending == ".exr");
    if (ending == ".png")
        codec();
    else
        exr_codec();
}

void write_png(const fs::path& path, int width, int height, std::span<const unsigned char> colors, float pixel_aspect) {
    EXPECTS(width > 0 && height > 0 && pixel_aspect > 0 && std::isfinite(pixel_aspect));
    const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    EXPECTS(colors.size() == 3 * pixels || colors.size() == 4 * pixels);
    replace_file(path, codec().encode_png(width, height, colors, pixel_aspect, path.string()));
}

}  // namespace render2mpeg::image
