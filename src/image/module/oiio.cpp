// Reads and writes images with OpenImageIO.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <cctype>
#include <cmath>
#include <memory>
#include <new>
#include <string>

#include "core/error.h"
#include "image/format.h"
#include "image/module/codec.h"

namespace render2mpeg::image {
namespace {

/// The first line of a message, without the white space about it.
std::string one_line(const std::string& message) {
    std::string line = message.substr(0, message.find_first_of("\r\n"));
    while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back())) != 0) line.pop_back();
    if (line.find("nexpected end of file") != std::string::npos) return "the file is cut off";
    return line.empty() ? "the image is damaged" : line;
}

/// Refuses images by their header, before any pixel has a place.
void check_header(const OIIO::ImageSpec& spec, std::size_t file_bytes, Format format, const std::string& name) {
    if (spec.width <= 0 || spec.height <= 0 || spec.nchannels <= 0)
        throw core::Error("reading", name, "it has no pixels");
    // OpenImageIO makes room for all of them at once.
    constexpr int most_channels = 1024;
    if (spec.nchannels > most_channels)
        throw core::Error("reading", name, "it has " + std::to_string(spec.nchannels) + " channels");
    if (spec.depth > 1 || spec.deep) throw core::Error("reading", name, "volumes and deep images are not read");
    check_size(spec.width, spec.height, file_bytes, format, name);
}

/// Reads the chosen channels straight to where they belong.
void read_channels(OIIO::ImageInput& input, const ChannelChoice& choice, core::Plane<glm::vec4>& pixels,
                   const std::string& name) {
    constexpr auto stride = static_cast<OIIO::stride_t>(sizeof(glm::vec4));
    auto* const base = reinterpret_cast<float*>(pixels.row(0));
    const auto read = [&](int first, int count, int component) {
        if (!input.read_image(0, 0, first, first + count, OIIO::TypeDesc::FLOAT, base + component, stride))
            throw core::Error("reading", name, one_line(input.geterror()));
    };
    if (choice.consecutive())
        read(choice.channel[0], choice.count(), 0);
    else
        for (int component = 0; component < 4; ++component)
            if (choice.channel[static_cast<std::size_t>(component)] >= 0)
                read(choice.channel[static_cast<std::size_t>(component)], 1, component);
}

/// Gives grey images three channels and all images an alpha.
void fill_in(const ChannelChoice& choice, core::Plane<glm::vec4>& pixels) {
    const bool grey = choice.is_grey();
    const bool opaque = choice.channel[3] < 0;
    for (glm::vec4& pixel : pixels.values()) {
        if (grey) pixel.y = pixel.z = pixel.x;
        if (opaque) pixel.w = 1;
    }
}

/// An image whose header was read and found good.
struct Opened {
    Opened(std::span<const std::byte> bytes, Format format, const std::string& name)
        : reader(const_cast<std::byte*>(bytes.data()), bytes.size()), input(OIIO::ImageInput::create(name_of(format))) {
        if (!input) throw core::Error("reading", name, one_line(OIIO::geterror()));
        EXPECTS(input->supports("ioproxy"));
        OIIO::Filesystem::IOProxy* source = &reader;

        // Ask for colours as they are stored; gamma, profiles and orientation in the file are ignored [glTF2, 3.8.3].
        OIIO::ImageSpec wishes;
        wishes.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &source);
        wishes.attribute("oiio:UnassociatedAlpha", 1);
        if (!input->open(name, spec, wishes)) throw core::Error("reading", name, one_line(input->geterror()));
        check_header(spec, bytes.size(), format, name);
    }

    OIIO::Filesystem::IOMemReader reader;
    std::unique_ptr<OIIO::ImageInput> input;  ///< reads from `reader`
    OIIO::ImageSpec spec;
};

/// Calls `read`; its failures become a core::Error of one line.
template <class Read>
auto told_in_one_line(const std::string& name, Read&& read) {
    try {
        return read();
    } catch (const core::Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw core::Error("reading", name, "not enough memory for its pixels");
    } catch (const std::exception& failure) {
        throw core::Error("reading", name, one_line(failure.what()));
    }
}

class OiioCodec final : public Codec {
  public:
    OiioCodec() {
        // Whoever reads many images does so in threads of his own.
        OIIO::attribute("threads", 1);
        OIIO::attribute("exr_threads", -1);
    }

    Image decode(std::span<const std::byte> bytes, Format format, const std::string& name) const override {
        return told_in_one_line(name, [&] {
            const Opened file(bytes, format, name);
            const OIIO::ImageSpec& spec = file.spec;
            const ChannelChoice choice = choose_channels(spec.channelnames, spec.alpha_channel);
            Image image;
            image.pixels = core::Plane<glm::vec4>(spec.width, spec.height);
            image.has_alpha = choice.channel[3] >= 0;
            image.high_range = spec.format.is_floating_point();
            // OpenEXR's pixelAspectRatio, PNG's pHYs.
            if (format == Format::exr || format == Format::png) {
                const float aspect = spec.get_float_attribute("PixelAspectRatio", 1.0f);
                if (std::isfinite(aspect) && aspect > 0) image.pixel_aspect = aspect;
            }
            read_channels(*file.input, choice, image.pixels, name);
            fill_in(choice, image.pixels);
            return image;
        });
    }

    ImageHeader header_of(std::span<const std::byte> bytes, Format format, const std::string& name) const override {
        return told_in_one_line(name, [&] {
            const Opened file(bytes, format, name);
            return ImageHeader{file.spec.width, file.spec.height, file.spec.format.size() == 1};
        });
    }

    std::vector<unsigned char> encode_png(int width, int height, std::span<const unsigned char> colors,
                                          float pixel_aspect, const std::string& name) const override {
        std::vector<unsigned char> bytes;
        OIIO::Filesystem::IOVecOutput writer(bytes);
        const auto output = OIIO::ImageOutput::create("png", &writer);
        if (!output) throw core::Error("writing", name, one_line(OIIO::geterror()));
        const auto channels =
            static_cast<int>(colors.size() / (static_cast<std::size_t>(width) * static_cast<std::size_t>(height)));
        OIIO::ImageSpec spec(width, height, channels, OIIO::TypeDesc::UINT8);
        // PNG's colours are not multiplied by alpha, nor are these. [PNG, 6.2]
        if (channels == 4) spec.attribute("oiio:UnassociatedAlpha", 1);
        // Chunk sRGB, and gAMA and cHRM for readers that do not know it. [PNG, 11.3.3.5]
        spec.attribute("oiio:ColorSpace", "sRGB");
        // PNG says pixels per unit along each axis; without a unit only their ratio counts. [PNG, 11.3.5.3: pHYs]
        if (pixel_aspect != 1) {
            spec.attribute("ResolutionUnit", "none");
            spec.attribute("XResolution", 10000.0f);
            spec.attribute("YResolution", 10000.0f * pixel_aspect);
        }
        if (!output->open(name, spec) || !output->write_image(OIIO::TypeDesc::UINT8, colors.data()) || !output->close())
            throw core::Error("writing", name, one_line(output->geterror()));
        return bytes;
    }
};

}  // namespace
}  // namespace render2mpeg::image

extern "C" const render2mpeg::image::Codec* render2mpeg_image_codec() {
    static const render2mpeg::image::OiioCodec codec;
    return &codec;
}
