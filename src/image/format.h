#pragma once
// Tells image files apart and reads their sizes, before a library does.
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace render2mpeg::image {

/// The kinds of file that are read. Whatever else OpenImageIO could open is refused: every parser is a door.
enum class Format { png, jpeg, exr, hdr, tga, bmp, tiff, gif, webp, psd, dds, pnm };

/// "png", "jpeg", ...: the words that OpenImageIO uses.
const char* name_of(Format format);

/// The most pixels that a byte of such a file can hold; files that claim more are cut off, or a trap.
std::uint64_t max_pixels_per_byte(Format format);

/// Refuses an image by what its header says, before any pixel has a place. Throws core::Error.
void check_size(int width, int height, std::size_t file_bytes, Format format, const std::string& name);

/// Format by first bytes; TGA by its ending or footer. None for others.
std::optional<Format> format_of(std::span<const std::byte> bytes, const std::string& name);

/// Whether a JPEG lacks its end marker behind the first scan; decoders would answer with grey pixels.
bool is_cut_off_jpeg(std::span<const std::byte> bytes);

/// Whether a BMP is run-length packed: no scene has such, and OpenImageIO 2.4 crashes on inconsistent ones.
bool is_packed_bmp(std::span<const std::byte> bytes);

/// A PNG file with nothing but its pixels and their shape: the chunks IHDR, PLTE, tRNS, IDAT and IEND, and pHYs where
/// it is sound. A file's colour information is ignored by decree [glTF2, 3.8.3], and libpng prints warnings about
/// profiles and damage to the terminal. Throws core::Error, naming the file, where a chunk is truncated, its checksum
/// is wrong, or a critical chunk is unknown.
std::vector<std::byte> essential_png(std::span<const std::byte> bytes, const std::string& name);

/// Refuses an OpenEXR with an attribute larger than the rest of the file, for which the library would allocate up to 2
/// GiB. Throws core::Error.
void check_exr_attributes(std::span<const std::byte> bytes, const std::string& name);

/// Which of a file's channels become red, green, blue and alpha; -1: none. A grey image has red only.
struct ChannelChoice {
    std::array<int, 4> channel{-1, -1, -1, -1};

    bool is_grey() const { return channel[1] < 0; }
    int count() const;
    /// Whether they follow one another in the file in the order of their components, so that they are read at once.
    bool consecutive() const;
};

/// Takes R, G, B and A (also red, green, blue, alpha, in any case) of the unnamed layer, else of the first layer that
/// has colours
/// ("ViewLayer.Combined.R"); else Y, else the first three channels of at least three, else the first alone as grey.
/// `alpha_channel`: what the file calls its alpha, or -1. There is at least one channel.
ChannelChoice choose_channels(const std::vector<std::string>& names, int alpha_channel);

}  // namespace render2mpeg::image
