#include "encoder/av/sequence_facts.h"

#include <algorithm>

#include "core/error.h"
#include "encoder/av/bits.h"

namespace render2mpeg::av {
namespace {

// Start codes and extension identifiers [H262, tables 6-1 and 6-2].
constexpr std::uint8_t user_start_code = 0xb2, sequence_start_code = 0xb3, extension_start_code = 0xb5;
constexpr std::uint32_t sequence_extension = 1, sequence_display_extension = 2;

/// Place of the next 00 00 01 at or after `from`, or the end.
std::size_t next_start_code(std::span<const std::uint8_t> bytes, std::size_t from) {
    constexpr std::uint8_t prefix[3] = {0, 0, 1};
    const auto at = std::search(bytes.begin() + static_cast<std::ptrdiff_t>(from), bytes.end(), prefix, prefix + 3);
    return static_cast<std::size_t>(at - bytes.begin());
}

/// Codes 2 to 4 give the display's aspect ratio [H262, 6.3.3].
core::Rational pixel_of(std::uint32_t aspect_ratio_code, int width, int height) {
    constexpr core::Rational displays[] = {{4, 3}, {16, 9}, {221, 100}};
    if (aspect_ratio_code < 2 || aspect_ratio_code > 4 || width == 0) return {1, 1};
    return core::product(displays[aspect_ratio_code - 2], {height, width});
}

bool read_header(Bits bits, SequenceFacts& facts, std::uint32_t& aspect_ratio_code) {
    facts.width = static_cast<int>(bits.read(12));
    facts.height = static_cast<int>(bits.read(12));
    aspect_ratio_code = bits.read(4);
    const auto rate_code = bits.read(4);
    if (rate_code < 1 || rate_code > core::mpeg2_frame_rates().size()) return false;
    facts.rate = core::mpeg2_frame_rates()[rate_code - 1];
    facts.bit_rate = bits.read(18);
    bits.skip(1);
    facts.buffer_bits = bits.read(10);
    return !bits.overrun();
}

/// True for a sequence extension that is whole.
bool read_extension(Bits bits, SequenceFacts& facts) {
    switch (bits.read(4)) {
        case sequence_extension:
            bits.skip(8);  // profile and level
            facts.progressive = bits.read(1) != 0;
            bits.skip(2);  // chroma_format
            facts.width |= static_cast<int>(bits.read(2)) << 12;
            facts.height |= static_cast<int>(bits.read(2)) << 12;
            facts.bit_rate |= static_cast<std::int64_t>(bits.read(12)) << 18;
            bits.skip(1);
            facts.buffer_bits |= static_cast<std::int64_t>(bits.read(8)) << 10;
            facts.decoding_delay = bits.read(1) != 0 ? 0 : 1;  // low_delay
            return !bits.overrun();
        case sequence_display_extension:
            bits.skip(3);  // video_format
            if (bits.read(1) == 0) return false;
            facts.color_primaries = static_cast<int>(bits.read(8));
            facts.transfer_characteristics = static_cast<int>(bits.read(8));
            facts.matrix_coefficients = static_cast<int>(bits.read(8));
            return false;
        default:
            return false;
    }
}

}  // namespace

SequenceFacts read_sequence(std::span<const std::uint8_t> picture) {
    SequenceFacts facts;
    bool has_header = false, has_extension = false;
    std::uint32_t aspect_ratio_code = 1;
    std::size_t at = next_start_code(picture, 0);
    for (; at + 4 <= picture.size(); at = next_start_code(picture, at + 4)) {
        const std::uint8_t code = picture[at + 3];
        const Bits payload(picture.subspan(at + 4, next_start_code(picture, at + 4) - at - 4));
        if (!has_header) {
            if (at != 0 || code != sequence_start_code || !read_header(payload, facts, aspect_ratio_code)) break;
            has_header = true;
        } else if (code == extension_start_code) {
            has_extension |= read_extension(payload, facts);
        } else if (code != user_start_code) {
            break;
        }
    }
    if (!has_header || !has_extension)
        throw core::Error(
            "the first coded picture of the film does not begin with an MPEG-2 sequence header and extension");

    facts.headers.assign(picture.begin(), picture.begin() + static_cast<std::ptrdiff_t>(std::min(at, picture.size())));
    facts.pixel_aspect = pixel_of(aspect_ratio_code, facts.width, facts.height);
    facts.bit_rate *= 400;           // bit_rate counts 400 bits per second [H262, 6.3.3]
    facts.buffer_bits *= 16 * 1024;  // vbv_buffer_size counts 16 * 1024 bits
    return facts;
}

}  // namespace render2mpeg::av
