#pragma once
// Interface of the image modules to the light library in front of them.
#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "image/format.h"
#include "image/image.h"

namespace render2mpeg::image {

/// Interface of render2mpeg_image_module.so (OpenImageIO). Works on memory alone, thread-safe, throws core::Error.
class Codec {
  public:
    virtual ~Codec() = default;

    /// `format` is the format claimed by the bytes; `name` is for messages.
    virtual Image decode(std::span<const std::byte> bytes, Format format, const std::string& name) const = 0;

    /// The same as far as its header goes.
    virtual ImageHeader header_of(std::span<const std::byte> bytes, Format format, const std::string& name) const = 0;

    /// `colors`: as write_png() has them.
    virtual std::vector<unsigned char> encode_png(int width, int height, std::span<const unsigned char> colors,
                                                  float pixel_aspect, const std::string& name) const = 0;
};

/// Interface of render2mpeg_exr_module.so (OpenEXR), a hundredth of OpenImageIO's libraries.
class ExrCodec {
  public:
    virtual ~ExrCodec() = default;

    /// image::read_exr of what certainly begins as an OpenEXR file.
    virtual ExrChannels decode(std::span<const std::byte> bytes, const std::function<bool(const std::string&)>& wanted,
                               const std::string& name) const = 0;

    virtual std::vector<unsigned char> encode(int width, int height, std::span<const Channel> channels,
                                              const FrameFacts& facts, const std::string& name) const = 0;
};

/// Limits windows before OpenEXR allocates their lines, whoever opens the file.
void limit_exr_windows();

/// In exr.cpp and exr_input.cpp, the only files that include OpenEXR.
std::vector<unsigned char> encode_multilayer_exr(int width, int height, std::span<const Channel> channels,
                                                 const FrameFacts& facts, const std::string& name);
ExrChannels decode_multilayer_exr(std::span<const std::byte> bytes,
                                  const std::function<bool(const std::string&)>& wanted, const std::string& name);

}  // namespace render2mpeg::image
