// Reads OpenEXR files from memory, within bounds.
#include <ImfChannelList.h>
#include <ImfCompression.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfPartType.h>
#include <half.h>
#include <immintrin.h>
#include <libdeflate.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <memory>
#include <new>
#include <stdexcept>

#include "core/error.h"
#include "image/module/codec.h"

namespace render2mpeg::image {
namespace {

/// A file in memory; whoever reads beyond its end is told.
class MemoryInput final : public Imf::IStream {
  public:
    MemoryInput(std::span<const std::byte> bytes, const std::string& name)
        : Imf::IStream(name.c_str()), bytes_(bytes) {}
    bool read(char data[], int size) override {
        const auto count = static_cast<std::size_t>(std::max(size, 0));
        if (at_ > bytes_.size() || count > bytes_.size() - at_) throw std::runtime_error("the file is cut off");
        std::memcpy(data, bytes_.data() + at_, count);
        at_ += count;
        return at_ < bytes_.size();
    }
    std::uint64_t tellg() override { return at_; }
    void seekg(std::uint64_t position) override { at_ = static_cast<std::size_t>(position); }

  private:
    std::span<const std::byte> bytes_;
    std::size_t at_ = 0;
};

/// Extent of a window; 0 for one that ends before it begins.
struct Extent {
    std::int64_t width, height;
    explicit Extent(const Imath::Box2i& box)
        : width(std::max<std::int64_t>(0, std::int64_t{box.max.x} - box.min.x + 1)),
          height(std::max<std::int64_t>(0, std::int64_t{box.max.y} - box.min.y + 1)) {}
    std::uint64_t pixels() const { return static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height); }
};

/// Bytes of pixels that a byte of a file can hold at most, by how the file is packed.
std::uint64_t most_unpacked(Imf::Compression packing) {
    switch (packing) {
        case Imf::NO_COMPRESSION:
            return 1;
        case Imf::RLE_COMPRESSION:
            return 64;  // runs of up to 128 bytes in two
        case Imf::ZIPS_COMPRESSION:
        case Imf::ZIP_COMPRESSION:
            return 1032;  // [RFC1951]
        case Imf::PXR24_COMPRESSION:
            return 2 * 1032;  // floats lose a byte first
        case Imf::B44_COMPRESSION:
        case Imf::B44A_COMPRESSION:
            return 1032;  // 16 halves in 3 bytes; what is no half is not packed
        default:
            return 4 * max_pixels_per_byte(Format::exr);
    }
}

/// Bytes of one pixel of all channels.
std::uint64_t bytes_of_pixel(const Imf::Header& header) {
    std::uint64_t bytes = 0;
    for (auto i = header.channels().begin(); i != header.channels().end(); ++i)
        bytes += i.channel().type == Imf::HALF ? 2 : 4;
    return bytes;
}

/// Longest side of a window.
constexpr int longest = 1 << 20;

/// Refuses files by their header, before any pixel has a place.
void check_header(const Imf::Header& header, std::size_t file_bytes, const std::string& name) {
    const Extent display(header.displayWindow()), data(header.dataWindow());
    if (display.pixels() == 0 || data.pixels() == 0) throw core::Error("reading", name, "it has no pixels");
    if (std::max({display.width, display.height, data.width, data.height}) > longest ||
        std::max(display.pixels(), data.pixels()) > max_pixels)
        throw core::Error("reading", name, "it has too many pixels: the limit is " + std::to_string(max_pixels));
    if (std::max(display.pixels(), data.pixels()) > max_pixels_per_byte(Format::exr) * file_bytes ||
        data.pixels() * bytes_of_pixel(header) > most_unpacked(header.compression()) * file_bytes)
        throw core::Error("reading", name, "the file is too short for its size in pixels");
}

/// Moves values from the data window to where it lies in the display window.
std::vector<float> placed(const std::vector<float>& values, const Imath::Box2i& data, const Imath::Box2i& display) {
    const Extent from(data), to(display);
    std::vector<float> result(static_cast<std::size_t>(to.pixels()), 0.0f);
    const std::int64_t left = std::max(data.min.x, display.min.x), right = std::min(data.max.x, display.max.x);
    for (std::int64_t y = std::max(data.min.y, display.min.y); y <= std::min(data.max.y, display.max.y); ++y)
        for (std::int64_t x = left; x <= right; ++x)
            result[static_cast<std::size_t>((y - display.min.y) * to.width + x - display.min.x)] =
                values[static_cast<std::size_t>((y - data.min.y) * from.width + x - data.min.x)];
    return result;
}

static_assert(std::endian::native == std::endian::little, "OpenEXR's files are little endian");

/// Where a channel lies in each line of a chunk, bytes.
struct Place {
    Channel* channel;  ///< null: nobody wants it
    Imf::PixelType type;
    std::size_t offset, bytes;  ///< from the line's beginning; of one value
};

std::vector<Place> places_of(const Imf::Header& header, std::vector<Channel>& channels, std::size_t width) {
    std::vector<Place> places;
    auto next = channels.begin();
    std::size_t offset = 0;
    for (auto i = header.channels().begin(); i != header.channels().end(); ++i) {
        // Both are in the header's order.
        const bool is_wanted = next != channels.end() && next->name == i.name();
        const std::size_t bytes = i.channel().type == Imf::HALF ? 2 : 4;
        places.push_back({is_wanted ? &*next++ : nullptr, i.channel().type, offset, bytes});
        offset += bytes * width;
    }
    return places;
}

/// The bytes of a chunk: bytes 0, 2, 4 ... first and 1, 3, 5 ... then where it was packed, else as they are.
class ChunkBytes {
  public:
    ChunkBytes(std::span<const std::uint8_t> bytes, bool parted)
        : even_(bytes.data()), odd_(bytes.data() + (parted ? (bytes.size() + 1) / 2 : 1)), step_(parted ? 1 : 2) {}

    /// Two bytes from an even place on.
    std::uint32_t pair(std::size_t at) const {
        const std::size_t i = at / 2 * step_;
        return even_[i] | std::uint32_t{odd_[i]} << 8;
    }

  private:
    const std::uint8_t *even_, *odd_;
    std::size_t step_;
};

/// One line of a channel.
void convert(const ChunkBytes& chunk, std::size_t at, Imf::PixelType type, std::span<float> values) {
    if (type == Imf::HALF) {
        for (std::size_t i = 0; i < values.size(); ++i) {
            half value;
            value.setBits(static_cast<std::uint16_t>(chunk.pair(at + 2 * i)));
            values[i] = value;
        }
        return;
    }
    for (std::size_t i = 0; i < values.size(); ++i) {
        const std::uint32_t bits = chunk.pair(at + 4 * i) | chunk.pair(at + 4 * i + 2) << 16;
        values[i] = type == Imf::UINT ? static_cast<float>(bits) : std::bit_cast<float>(bits);
    }
}

/// Each byte of a packed chunk is the difference to the one before, plus 128. [OpenEXRFile]
void undo_differences(std::span<std::uint8_t> bytes) {
    // Sixteen at a time: after sums over 1, 2, 4 and 8 neighbours each byte has those of all before it.
    const __m128i bias = _mm_set1_epi8(-128);
    __m128i sum = bias;
    std::size_t i = 0;
    for (; i + 16 <= bytes.size(); i += 16) {
        auto* at = reinterpret_cast<__m128i*>(bytes.data() + i);
        __m128i v = _mm_add_epi8(_mm_loadu_si128(at), bias);
        v = _mm_add_epi8(v, _mm_slli_si128(v, 1));
        v = _mm_add_epi8(v, _mm_slli_si128(v, 2));
        v = _mm_add_epi8(v, _mm_slli_si128(v, 4));
        v = _mm_add_epi8(v, _mm_slli_si128(v, 8));
        v = _mm_add_epi8(v, sum);
        _mm_storeu_si128(at, v);
        sum = _mm_set1_epi8(static_cast<char>(bytes[i + 15]));
    }
    auto last = static_cast<std::uint8_t>(i > 0 ? bytes[i - 1] : 128);
    for (; i < bytes.size(); ++i) bytes[i] = last = static_cast<std::uint8_t>(last + bytes[i] - 128);
}

/// Unpacks chunks of scan lines, which OpenEXR 3.1 does four times as slowly.
class ZipUnpacker {
  public:
    ZipUnpacker() : inflate_(libdeflate_alloc_decompressor(), &libdeflate_free_decompressor) {
        if (!inflate_) throw std::bad_alloc();
    }

    /// Fills `bytes` with the chunk's even bytes, then its odd ones. False where `packed` is no chunk of that size.
    bool unpack(std::span<const char> packed, std::span<std::uint8_t> bytes) {
        if (libdeflate_zlib_decompress(inflate_.get(), packed.data(), packed.size(), bytes.data(), bytes.size(),
                                       nullptr) != LIBDEFLATE_SUCCESS)
            return false;
        undo_differences(bytes);
        return true;
    }

  private:
    std::unique_ptr<libdeflate_decompressor, void (*)(libdeflate_decompressor*)> inflate_;
};

/// Whether read_zipped() reads files with such a header: ZIP or ZIPS, scan lines, one value per pixel in every channel.
bool is_zipped(const Imf::Header& header) {
    if (header.compression() != Imf::ZIP_COMPRESSION && header.compression() != Imf::ZIPS_COMPRESSION) return false;
    for (auto i = header.channels().begin(); i != header.channels().end(); ++i)
        if (i.channel().xSampling != 1 || i.channel().ySampling != 1) return false;
    return !header.hasTileDescription() && (!header.hasType() || header.type() == Imf::SCANLINEIMAGE);
}

/// Reads these channels of such a file, each of which has a name and room for the data window. Throws what OpenEXR
/// throws, and std::runtime_error where a chunk is no whole one.
void read_zipped(Imf::InputFile& file, std::vector<Channel>& channels) {
    const Imath::Box2i data = file.header().dataWindow();
    const auto width = static_cast<std::size_t>(std::int64_t{data.max.x} - data.min.x + 1);
    const std::vector<Place> places = places_of(file.header(), channels, width);
    const std::size_t line = places.back().offset + places.back().bytes * width;
    const int lines = file.header().compression() == Imf::ZIP_COMPRESSION ? 16 : 1;  // of a chunk [OpenEXRFile]
    ZipUnpacker zip;
    const std::int64_t height = std::int64_t{data.max.y} - data.min.y + 1;
    std::vector<std::uint8_t> unpacked(line * static_cast<std::size_t>(std::min<std::int64_t>(lines, height)));
    for (std::int64_t first = data.min.y; first <= data.max.y; first += lines) {
        const auto count = static_cast<std::size_t>(std::min<std::int64_t>(lines, data.max.y - first + 1));
        const char* packed = nullptr;
        int size = 0;
        file.rawPixelData(static_cast<int>(first), packed, size);

        // Data that would not shrink is stored unpacked.
        const std::span<std::uint8_t> room(unpacked.data(), line * count);
        if (size <= 0 || static_cast<std::size_t>(size) > room.size())
            throw std::runtime_error("its pixels are not whole");
        const bool is_packed = static_cast<std::size_t>(size) < room.size();
        if (!is_packed) std::copy_n(packed, room.size(), room.data());
        if (is_packed && !zip.unpack({packed, static_cast<std::size_t>(size)}, room))
            throw std::runtime_error("its pixels cannot be unpacked");
        const ChunkBytes chunk(room, is_packed);
        for (std::size_t y = 0; y < count; ++y)
            for (const Place& place : places)
                if (place.channel != nullptr)
                    convert(chunk, y * line + place.offset, place.type,
                            {place.channel->values.data() + (static_cast<std::size_t>(first - data.min.y) + y) * width,
                             width});
    }
}

}  // namespace

void limit_exr_windows() {
    Imf::Header::setMaxImageSize(longest, longest);
    Imf::Header::setMaxTileSize(longest, longest);
}

ExrChannels decode_multilayer_exr(std::span<const std::byte> bytes,
                                  const std::function<bool(const std::string&)>& wanted, const std::string& name) try {
    MemoryInput stream(bytes, name);
    Imf::InputFile file(stream, 0);
    const Imf::Header& header = file.header();
    check_header(header, bytes.size(), name);
    const Imath::Box2i data = header.dataWindow(), display = header.displayWindow();
    const Extent extent(data);

    // Name the channels first: their values must not move once the library knows where they are.
    ExrChannels result{static_cast<int>(Extent(display).width),
                       static_cast<int>(Extent(display).height),
                       {},
                       header.pixelAspectRatio()};
    for (auto i = header.channels().begin(); i != header.channels().end(); ++i)
        if (wanted(i.name())) {
            if (i.channel().xSampling != 1 || i.channel().ySampling != 1)
                throw core::Error("reading", name, "channel " + std::string(i.name()), "it has not a value per pixel");
            result.channels.push_back({i.name(), std::vector<float>(static_cast<std::size_t>(extent.pixels())),
                                       i.channel().type == Imf::HALF});
        }
    if (result.channels.empty()) return result;

    // The library addresses pixel (x, y) as base + x and y strides, also where the window does not begin at 0.
    Imf::FrameBuffer frame;
    for (Channel& channel : result.channels)
        frame.insert(channel.name, Imf::Slice::Make(Imf::FLOAT, channel.values.data(), data, sizeof(float),
                                                    sizeof(float) * static_cast<std::size_t>(extent.width)));
    if (is_zipped(header)) {
        read_zipped(file, result.channels);
    } else {
        file.setFrameBuffer(frame);
        file.readPixels(data.min.y, data.max.y);
    }
    if (data != display)
        for (Channel& channel : result.channels) channel.values = placed(channel.values, data, display);
    return result;
} catch (const core::Error&) {
    throw;
} catch (const std::bad_alloc&) {
    throw core::Error("reading", name, "not enough memory for its pixels");
} catch (const std::exception& failure) {
    const std::string message = failure.what();
    throw core::Error("reading", name, message.substr(0, message.find_first_of("\r\n")));
}

}  // namespace render2mpeg::image
