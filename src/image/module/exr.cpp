// Reads and writes OpenEXR files.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <half.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/error.h"
#include "image/module/codec.h"

namespace render2mpeg::image {
namespace {

/// A file in memory.
class MemoryStream final : public Imf::OStream {
  public:
    explicit MemoryStream(const std::string& name) : Imf::OStream(name.c_str()) {}
    void write(const char data[], int size) override {
        const std::size_t end = at_ + static_cast<std::size_t>(size);
        if (end > bytes_.size()) bytes_.resize(end);
        std::memcpy(bytes_.data() + at_, data, static_cast<std::size_t>(size));
        at_ = end;
    }
    std::uint64_t tellp() override { return at_; }
    void seekp(std::uint64_t position) override { at_ = static_cast<std::size_t>(position); }
    std::vector<unsigned char> take() { return std::move(bytes_); }

  private:
    std::vector<unsigned char> bytes_;
    std::size_t at_ = 0;
};

/// OpenEXR multiplies row vectors, GLM columns: the numbers lie in memory alike.
Imath::M44f matrix_of(const glm::mat4& matrix) {
    Imath::M44f result;
    for (int i = 0; i < 4; ++i)
        for (int k = 0; k < 4; ++k) result[i][k] = matrix[i][k];
    return result;
}

Imf::Header header_of(int width, int height, const FrameFacts& facts) {
    Imf::Header header(width, height, facts.pixel_aspect);
    header.compression() = Imf::ZIP_COMPRESSION;
    Imf::addChromaticities(header, Imf::Chromaticities());  // BT.709's
    if (facts.exposure) header.insert("exposure", Imf::FloatAttribute(*facts.exposure));
    if (facts.frames_per_second)
        Imf::addFramesPerSecond(
            header, {static_cast<int>(facts.frames_per_second->num), static_cast<int>(facts.frames_per_second->den)});
    if (facts.world_to_camera) Imf::addWorldToCamera(header, matrix_of(*facts.world_to_camera));
    if (facts.world_to_ndc) Imf::addWorldToNDC(header, matrix_of(*facts.world_to_ndc));
    for (const auto& [name, text] : facts.texts) header.insert(name, Imf::StringAttribute(text));
    return header;
}

/// Clamps finite values to the largest half, so that they stay finite.
std::vector<half> halves_of(const std::vector<float>& values) {
    std::vector<half> halves(values.size());
    std::transform(values.begin(), values.end(), halves.begin(), [](float v) {
        return half(std::isfinite(v) ? std::clamp(v, -static_cast<float>(HALF_MAX), static_cast<float>(HALF_MAX)) : v);
    });
    return halves;
}

}  // namespace

std::vector<unsigned char> encode_multilayer_exr(int width, int height, std::span<const Channel> channels,
                                                 const FrameFacts& facts, const std::string& name) try {
    // Describe the channels. The library keeps them sorted by name, whatever our order.
    Imf::Header header = header_of(width, height, facts);
    for (const Channel& channel : channels)
        header.channels().insert(channel.name, Imf::Channel(channel.half ? Imf::HALF : Imf::FLOAT));

    // Point at the values; halves live until the file is written.
    std::vector<std::vector<half>> halves(channels.size());
    Imf::FrameBuffer frame;
    for (std::size_t c = 0; c < channels.size(); ++c) {
        const Channel& channel = channels[c];
        const auto columns = static_cast<std::size_t>(width);
        if (channel.half) {
            halves[c] = halves_of(channel.values);
            frame.insert(channel.name, Imf::Slice(Imf::HALF, reinterpret_cast<char*>(halves[c].data()), sizeof(half),
                                                  sizeof(half) * columns));
        } else {
            // The library's interface for writing lacks a const.
            char* base = reinterpret_cast<char*>(const_cast<float*>(channel.values.data()));
            frame.insert(channel.name, Imf::Slice(Imf::FLOAT, base, sizeof(float), sizeof(float) * columns));
        }
    }

    // Write without threads of the library: the bytes are the same, and the process has its own. The file closes at the
    // brace.
    MemoryStream stream(name);
    {
        Imf::OutputFile file(stream, header, 0);
        file.setFrameBuffer(frame);
        file.writePixels(height);
    }
    return stream.take();
} catch (const core::Error&) {
    throw;
} catch (const std::exception& failure) {
    throw core::Error("writing", name, failure.what());
}

namespace {

class OpenExrCodec final : public ExrCodec {
  public:
    OpenExrCodec() { limit_exr_windows(); }

    ExrChannels decode(std::span<const std::byte> bytes, const std::function<bool(const std::string&)>& wanted,
                       const std::string& name) const override {
        return decode_multilayer_exr(bytes, wanted, name);
    }

    std::vector<unsigned char> encode(int width, int height, std::span<const Channel> channels, const FrameFacts& facts,
                                      const std::string& name) const override {
        return encode_multilayer_exr(width, height, channels, facts, name);
    }
};

}  // namespace
}  // namespace render2mpeg::image

extern "C" const render2mpeg::image::ExrCodec* render2mpeg_exr_codec() {
    static const render2mpeg::image::OpenExrCodec codec;
    return &codec;
}
