#include "encoder/av/av1_grain.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "core/error.h"
#include "core/sampling.h"

namespace render2mpeg::av {
namespace {

void put(std::vector<bool>& bits, int value, int count) {
    for (int i = count - 1; i >= 0; --i) bits.push_back((value >> i & 1) != 0);
}

/// A payload's first bits, these behind them, and in a frame its tiles from the next whole byte on.
std::vector<std::uint8_t> with_bits(const Obu& obu, std::size_t end, const std::vector<bool>& bits, bool has_tiles) {
    std::vector<std::uint8_t> result(obu.payload.begin(), obu.payload.begin() + static_cast<std::ptrdiff_t>(end / 8));
    std::size_t count = end / 8 * 8;
    const auto add = [&](bool bit) {
        if (count % 8 == 0) result.push_back(0);
        if (bit) result.back() = static_cast<std::uint8_t>(result.back() | 0x80 >> count % 8);
        ++count;
    };
    for (std::size_t i = count; i < end; ++i) add((obu.payload[i / 8] >> (7 - i % 8) & 1) != 0);
    // Bits up to the next whole byte are as they must be, where the header was read rightly.
    const std::size_t whole = (end + 7) / 8;
    for (std::size_t i = end; i < 8 * whole || (!has_tiles && i == end); ++i) {
        const bool bit = i / 8 < obu.payload.size() && (obu.payload[i / 8] >> (7 - i % 8) & 1) != 0;
        if (bit != (!has_tiles && i == end)) throw core::Error("AV1: a frame header does not end where it should");
    }
    for (const bool bit : bits) add(bit);
    if (!has_tiles) add(true);
    if (has_tiles)
        result.insert(result.end(), obu.payload.begin() + static_cast<std::ptrdiff_t>(whole), obu.payload.end());
    return result;
}

/// Appends a unit with another payload [AV1, 5.3, 4.10.5].
void append(std::vector<std::uint8_t>& out, const Obu& obu, std::span<const std::uint8_t> payload) {
    out.insert(out.end(), obu.bytes.begin(), obu.bytes.begin() + (obu.has_extension() ? 2 : 1));
    std::size_t size = payload.size();
    for (; size > 127; size >>= 7) out.push_back(static_cast<std::uint8_t>(size | 128));
    out.push_back(static_cast<std::uint8_t>(size));
    out.insert(out.end(), payload.begin(), payload.end());
}

}  // namespace

Av1Grain::BitRow Av1Grain::parameters(const Av1FrameHeader& frame, std::int64_t number) {
    BitRow bits;
    put(bits, table_.points.empty() ? 0 : 1, 1);  // apply_grain
    if (table_.points.empty()) return bits;
    put(bits, static_cast<int>(core::mix(static_cast<std::uint64_t>(number)) & 0xffff), 16);
    if (frame.is_inter) {
        const auto has_grain = [&](int reference) { return has_grain_[static_cast<std::size_t>(reference)]; };
        const auto known = std::ranges::find_if(frame.references, has_grain);
        put(bits, known == frame.references.end() ? 1 : 0, 1);  // update_grain
        if (known != frame.references.end()) {
            put(bits, *known, 3);
            return bits;
        }
    }
    put(bits, static_cast<int>(table_.points.size()), 4);
    for (const GrainTable::Point& point : table_.points) {
        put(bits, point.luma, 8);
        put(bits, point.scaling, 8);
    }
    put(bits, 0, 1 + 4 + 4);  // chroma_scaling_from_luma, num_cb_points, num_cr_points
    put(bits, table_.scaling_shift - 8, 2);
    put(bits, table_.lag, 2);
    for (int i = 0; i < table_.weights(); ++i) put(bits, table_.filter[static_cast<std::size_t>(i)] + 128, 8);
    put(bits, GrainTable::filter_shift - 6, 2);
    put(bits, table_.noise_shift, 2);
    put(bits, table_.lag > 0 ? 1 : 0, 1);  // overlap_flag: white noise has no seams
    put(bits, 1, 1);                       // clip_to_restricted_range
    return bits;
}

void Av1Grain::append_frame(std::vector<std::uint8_t>& out, const Obu& obu, std::int64_t number, bool has_tiles) {
    const Av1FrameHeader frame = headers_.read_frame(obu.payload);
    if (frame.shows_existing) {
        out.insert(out.end(), obu.bytes.begin(), obu.bytes.end());
        return;
    }
    if (frame.is_key) {
        first_number_ = number;
        first_hint_ = frame.order_hint;
    }
    const auto hint_of_shown = static_cast<int>(first_hint_ + number - first_number_);
    const std::int64_t own = number + headers_.distance(frame.order_hint, hint_of_shown);
    append(out, obu, with_bits(obu, frame.end, frame.can_be_shown ? parameters(frame, own) : BitRow(), has_tiles));
    for (std::size_t i = 0; i < has_grain_.size(); ++i)
        if ((frame.refreshed >> i & 1) != 0) has_grain_[i] = frame.can_be_shown && !table_.points.empty();
}

std::vector<std::uint8_t> Av1Grain::with_grain(std::span<const std::uint8_t> unit, std::int64_t number) {
    enum { sequence_header = 1, frame_header = 3, whole_frame = 6, repeated_header = 7 };
    std::vector<std::uint8_t> result;
    for (const Obu& obu : obus_of(unit)) {
        if (obu.type() == repeated_header) throw core::Error("AV1: film grain cannot be told in repeated headers");
        if (obu.type() == sequence_header) {
            const std::size_t place = headers_.read_sequence(obu.payload);
            std::vector<std::uint8_t> header(obu.payload.begin(), obu.payload.end());
            header[place / 8] = static_cast<std::uint8_t>(header[place / 8] | 0x80 >> place % 8);
            append(result, obu, header);
        } else if (obu.type() == frame_header || obu.type() == whole_frame) {
            append_frame(result, obu, number, obu.type() == whole_frame);
        } else {
            result.insert(result.end(), obu.bytes.begin(), obu.bytes.end());
        }
    }
    return result;
}

}  // namespace render2mpeg::av
