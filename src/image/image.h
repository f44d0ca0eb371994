#pragma once
// Decoded images, and reading them.
#include <cstddef>
#include <filesystem>
#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/plane.h"
#include "core/rational.h"

namespace render2mpeg::image {

/// A decoded image in float RGBA; grey becomes RGB, alpha 1. 8- and 16-bit code values are scaled to 0..1, not
/// linearised: only the user knows whether they are colours.
struct Image {
    core::Plane<glm::vec4> pixels;  ///< (0, 0) is the upper left
    bool has_alpha = false;         ///< the file had one
    float pixel_aspect = 1;         ///< width over height of a pixel, as OpenEXR and PNG files say it; else 1
    bool high_range = false;        ///< the file held floats (EXR, HDR): scene-linear already
};

/// The largest half float: replaces overflowed values.
inline constexpr float overflowed = 65504.0f;

/// Reads a file, or `bytes` unless empty. `name` is for messages. Throws core::Error, for more than `max_pixels` before
/// allocating.
Image read_image(const std::filesystem::path& path, std::span<const std::byte> bytes, const std::string& name);

/// chosen: a sky of 16384x8192 pixels is read, which takes 3.5 GB as a texture of 8-bit colours. A file of less than a
/// megabyte can claim as many, so that more would be refused by the machine (16384x16384 took 12.8 GB).
inline constexpr std::size_t max_pixels = std::size_t{16384} * 8192;

/// Facts from the header of an image.
struct ImageHeader {
    int width = 0, height = 0;
    bool bytes = false;  ///< 8 bits per channel at most: a texture keeps it so
};

/// The same without its pixels. Throws core::Error where read_image() would refuse it by its header.
ImageHeader read_image_header(const std::filesystem::path& path, std::span<const std::byte> bytes,
                              const std::string& name);

/// One channel of a multilayer OpenEXR: "ViewLayer.Depth.Z".
struct Channel {
    std::string name;
    std::vector<float> values;  ///< row by row
    bool half = false;          ///< stored as 16-bit float
};

/// Facts about a frame from the header of an OpenEXR; missing attributes are left at their defaults.
struct FrameFacts {
    float pixel_aspect = 1;              ///< width over height of a pixel
    std::optional<float> exposure = {};  ///< EV that the display develops it with; not applied
    std::optional<core::Rational> frames_per_second = {};
    std::optional<glm::mat4> world_to_camera = {};  ///< x right, y up, z along the view [OpenEXRAttributes]
    std::optional<glm::mat4> world_to_ndc = {};     ///< (0, 0) the picture's upper left corner, (1, 1) lower right
    std::vector<std::pair<std::string, std::string>> texts = {};  ///< further attributes
};

/// Writes an OpenEXR atomically, with BT.709's primaries and white. Throws core::Error.
void write_exr(const std::filesystem::path& path, int width, int height, std::span<const Channel> channels,
               const FrameFacts& facts = {});

/// Writes an 8-bit PNG likewise; `colors` holds 3 sRGB code values per pixel, or 4 with an alpha that colours are not
/// multiplied by, which the file says.
void write_png(const std::filesystem::path& path, int width, int height, std::span<const unsigned char> colors,
               float pixel_aspect = 1);

/// Opens what writes files of such an ending, .png or .exr, so that a missing module is told at once. Throws
/// core::Error.
void open_writer(const std::string& ending);

/// The bytes of such a PNG file with square pixels. `name` is for messages.
std::vector<unsigned char> png_bytes(int width, int height, std::span<const unsigned char> rgb,
                                     const std::string& name);

/// Channels of an OpenEXR file.
struct ExrChannels {
    int width = 0, height = 0;      ///< of the display window
    std::vector<Channel> channels;  ///< in the file's order, sorted by name
    float pixel_aspect = 1;         ///< width over height of a pixel
};

/// Reads the `wanted` channels of a flat OpenEXR (its first part) over the display window; 0 outside its data. Throws
/// core::Error, for more than `max_pixels` before allocating.
ExrChannels read_exr(const std::filesystem::path& path, const std::function<bool(const std::string&)>& wanted);

/// A frame of an OpenEXR file and other channels of it.
struct ExrFrame {
    Image image;         ///< the colours that read_image() would choose, over the display window
    ExrChannels others;  ///< the requested ones
};

/// Both at once, since channels are packed together. Throws as read_exr().
ExrFrame read_exr_frame(const std::filesystem::path& path, const std::function<bool(const std::string&)>& wanted);

}  // namespace render2mpeg::image
