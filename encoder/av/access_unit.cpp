#include "encoder/av/access_unit.h"

#include <algorithm>
#include <cstddef>

#include "core/error.h"
#include "encoder/codec.h"

namespace render2mpeg::av {
namespace {

enum class UnitKind { header, picture, comment };

/// By nal_unit_type. [H264, table 7-1], [H265, table 7-1] The display that a film is made for belongs to the headers
/// [H265, D.2.28], how pictures hold those of two eyes to the pictures [H264, D.2.26].
UnitKind kind_of_nal(encoder::Codec codec, std::span<const std::uint8_t> unit) {
    if (codec == encoder::Codec::h264) {
        const int type = unit[0] & 31;
        if (type >= 1 && type <= 5) return UnitKind::picture;
        constexpr int sei = 6, frame_packing = 45;
        if (type == sei && unit.size() > 2 && unit[1] == frame_packing) return UnitKind::picture;
        return type == 7 || type == 8 ? UnitKind::header : UnitKind::comment;
    }
    const int type = (unit[0] >> 1) & 63;
    if (type < 32) return UnitKind::picture;
    constexpr int prefix_sei = 39, mastering_display = 137;
    if (type == prefix_sei && unit.size() > 2 && unit[2] == mastering_display) return UnitKind::header;
    return type <= 34 ? UnitKind::header : UnitKind::comment;
}

/// By obu_type. [AV1, 6.2.2] The display that a film is made for belongs to the headers [AV1, 6.7.4].
UnitKind kind_of_obu(const Obu& obu) {
    if (obu.type() == 1) return UnitKind::header;
    constexpr int metadata = 5, mastering_display = 2;
    if (obu.type() == metadata && !obu.payload.empty() && obu.payload[0] == mastering_display) return UnitKind::header;
    return obu.type() == 3 || obu.type() == 4 || obu.type() == 6 || obu.type() == 7 ? UnitKind::picture
                                                                                    : UnitKind::comment;
}

void put(AccessUnit& unit, UnitKind kind, std::span<const std::uint8_t> bytes, bool with_start_code) {
    if (kind == UnitKind::comment) return;
    std::vector<std::uint8_t>& out = kind == UnitKind::header ? unit.headers : unit.pictures;
    if (with_start_code) out.insert(out.end(), {0, 0, 0, 1});
    out.insert(out.end(), bytes.begin(), bytes.end());
}

/// The place of the next start code prefix, or the end.
std::size_t next_start(std::span<const std::uint8_t> bytes, std::size_t from) {
    for (std::size_t i = from; i + 3 <= bytes.size(); ++i)
        if (bytes[i] == 0 && bytes[i + 1] == 0 && bytes[i + 2] == 1) return i;
    return bytes.size();
}

AccessUnit nal_units_apart(encoder::Codec codec, std::span<const std::uint8_t> bytes) {
    AccessUnit unit;
    for (std::size_t start = next_start(bytes, 0); start < bytes.size();) {
        const std::size_t begin = start + 3;
        start = next_start(bytes, begin);
        std::size_t end = start;
        // A unit ends with a bit that is set: zeros belong to the next start code.
        while (end > begin && bytes[end - 1] == 0) --end;
        if (end > begin) {
            const auto nal = bytes.subspan(begin, end - begin);
            put(unit, kind_of_nal(codec, nal), nal, true);
        }
    }
    return unit;
}

AccessUnit obus_apart(std::span<const std::uint8_t> bytes) {
    AccessUnit unit;
    for (const Obu& obu : obus_of(bytes)) put(unit, kind_of_obu(obu), obu.bytes, false);
    return unit;
}

/// The length of what a container keeps apart, in four bytes, comes first.
AccessUnit parts_apart(encoder::Codec codec, std::span<const std::uint8_t> bytes) {
    std::size_t length = 0;
    for (std::size_t i = 0; i < 4 && i < bytes.size(); ++i) length = length << 8 | bytes[i];
    if (bytes.size() < 4 || length > bytes.size() - 4)
        throw core::Error("coded picture: its headers are longer than it is");
    const auto at = bytes.begin() + 4, middle = at + static_cast<std::ptrdiff_t>(length);
    AccessUnit unit{{}, {middle, bytes.end()}, {}};
    (codec == encoder::Codec::vp9 ? unit.alpha : unit.headers).assign(at, middle);
    return unit;
}

}  // namespace

std::vector<Obu> obus_of(std::span<const std::uint8_t> bytes) {
    std::vector<Obu> obus;
    for (std::size_t at = 0; at < bytes.size();) {
        const bool has_extension = (bytes[at] & 4) != 0, has_size = (bytes[at] & 2) != 0;
        std::size_t place = at + (has_extension ? 2 : 1), size = 0;
        for (int shift = 0; has_size && shift < 56 && place < bytes.size(); shift += 7) {
            size |= static_cast<std::size_t>(bytes[place] & 127) << shift;
            if ((bytes[place++] & 128) == 0) break;
        }
        if (!has_size || size > bytes.size() - std::min(place, bytes.size()))
            throw core::Error("AV1: a unit of the stream has no size that fits");
        obus.push_back({bytes.subspan(at, place + size - at), bytes.subspan(place, size)});
        at = place + size;
    }
    return obus;
}

bool has_byte_stream(encoder::Codec codec) {
    return !encoder::facts_of(codec).master && codec != encoder::Codec::vp9;
}

std::vector<std::uint8_t> put_together(std::span<const std::uint8_t> apart, std::span<const std::uint8_t> picture) {
    std::vector<std::uint8_t> bytes(4 + apart.size() + picture.size());
    for (std::size_t i = 0; i < 4; ++i) bytes[i] = static_cast<std::uint8_t>(apart.size() >> (24 - 8 * i));
    std::ranges::copy(apart, bytes.begin() + 4);
    std::ranges::copy(picture, bytes.end() - static_cast<std::ptrdiff_t>(picture.size()));
    return bytes;
}

AccessUnit taken_apart(encoder::Codec codec, std::span<const std::uint8_t> bytes) {
    if (!has_byte_stream(codec)) return parts_apart(codec, bytes);
    AccessUnit unit = codec == encoder::Codec::av1 ? obus_apart(bytes) : nal_units_apart(codec, bytes);
    if (unit.headers.empty() && unit.pictures.empty())
        throw core::Error("coded picture: the stream has no units that are known");
    return unit;
}

}  // namespace render2mpeg::av
