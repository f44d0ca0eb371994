#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace render2mpeg::core {

/// How one picture holds both eyes' pictures: the left one to the left, or above [H264, D.2.26].
enum class FramePacking : std::uint8_t { none, side_by_side, top_bottom };
inline constexpr std::array<std::string_view, 3> packing_names{"none", "side-by-side", "top-bottom"};

constexpr std::string_view name_of(FramePacking packing) {
    return packing_names[static_cast<std::size_t>(packing)];
}

}  // namespace render2mpeg::core
