#include "encoder/av/gif_codes.h"

#include <algorithm>
#include <bit>
#include <cstddef>

#include "core/error.h"

namespace render2mpeg::av {
namespace {

void put16(GifBytes& out, int value) {
    out.push_back(static_cast<std::uint8_t>(value & 255));
    out.push_back(static_cast<std::uint8_t>(value >> 8 & 255));
}

/// Codes of growing length, the lowest bit first.
class CodeWriter {
  public:
    void put(unsigned code, int bits) {
        held_ |= code << count_;
        for (count_ += bits; count_ >= 8; count_ -= 8) {
            bytes_.push_back(static_cast<std::uint8_t>(held_ & 255));
            held_ >>= 8;
        }
    }
    GifBytes finish() {
        if (count_ > 0) bytes_.push_back(static_cast<std::uint8_t>(held_));
        return std::move(bytes_);
    }

  private:
    GifBytes bytes_;
    unsigned held_ = 0;
    int count_ = 0;
};

/// Variable-length LZW [GIF89a, appendix F] of indices below 2^`depth`.
GifBytes compressed(std::span<const std::uint8_t> indices, int depth) {
    constexpr unsigned most_codes = 4096;
    const unsigned clear = 1u << depth, end = clear + 1;
    // By a known string's code and the index behind it: the code of both, 0 where there is none.
    std::vector<std::uint16_t> longer(std::size_t{most_codes} << depth);
    unsigned next = end + 1;
    int bits = depth + 1;
    CodeWriter out;
    out.put(clear, bits);
    unsigned string = indices.front();
    for (std::size_t i = 1; i < indices.size(); ++i) {
        std::uint16_t& known = longer[(std::size_t{string} << depth) + indices[i]];
        if (known != 0) {
            string = known;
            continue;
        }
        out.put(string, bits);
        string = indices[i];
        if (next < most_codes) {
            known = static_cast<std::uint16_t>(next);
            if (next == 1u << bits) ++bits;
            ++next;
        } else {
            out.put(clear, bits);
            std::ranges::fill(longer, std::uint16_t{0});
            next = end + 1;
            bits = depth + 1;
        }
    }
    out.put(string, bits);
    // The decoder has one more string than codes were put since, and reads the end as long.
    if (next == 1u << bits && bits < 12) ++bits;
    out.put(end, bits);
    return out.finish();
}

}  // namespace

GifBytes gif_header(int width, int height) {
    GifBytes out{'G', 'I', 'F', '8', '9', 'a'};
    put16(out, width);
    put16(out, height);
    out.insert(out.end(), {0x70, 0, 0});  // no palette of the film
    out.insert(out.end(), {0x21, 0xff, 11, 'N', 'E', 'T', 'S', 'C', 'A', 'P', 'E', '2', '.', '0', 3, 1, 0, 0, 0});
    return out;
}

GifBytes gif_image(const GifImage& image) {
    const std::size_t pixels = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
    EXPECTS(image.colors.size() <= 255 && image.indices.size() == pixels && pixels > 0);
    const auto transparent = static_cast<std::uint8_t>(image.colors.size());
    const int depth = std::max(2, static_cast<int>(std::bit_width(image.colors.size())));
    const int disposal = image.is_cleared ? 2 : 1;
    GifBytes out{0x21, 0xf9, 4, static_cast<std::uint8_t>(disposal << 2 | 1)};
    put16(out, image.hundredths);
    out.insert(out.end(), {transparent, 0, 0x2c});
    for (const int number : {image.x, image.y, image.width, image.height}) put16(out, number);
    out.push_back(static_cast<std::uint8_t>(0x80 | (depth - 1)));
    for (std::size_t i = 0; i < std::size_t{1} << depth; ++i) {
        const std::array<std::uint8_t, 3> color =
            i < image.colors.size() ? image.colors[i] : std::array<std::uint8_t, 3>{};
        out.insert(out.end(), color.begin(), color.end());
    }
    out.push_back(static_cast<std::uint8_t>(depth));
    const GifBytes codes = compressed(image.indices, depth);
    for (std::size_t at = 0; at < codes.size(); at += 255) {
        const std::size_t count = std::min<std::size_t>(255, codes.size() - at);
        out.push_back(static_cast<std::uint8_t>(count));
        const auto first = codes.begin() + static_cast<std::ptrdiff_t>(at);
        out.insert(out.end(), first, first + static_cast<std::ptrdiff_t>(count));
    }
    out.push_back(0);
    return out;
}

}  // namespace render2mpeg::av
