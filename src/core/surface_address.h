#pragma once
// Points that stay on their surface whatever moves or deforms it.
#include <cstdint>

namespace render2mpeg::core {

inline constexpr std::uint32_t no_id = 0xffffffffu;

/// A point that stays on its surface whatever moves or deforms it: p = (1 - u - v) p0 + u p1 + v p2 of a triangle; of a
/// strand's segment u along it and v across what is seen of it, both 0..1.
struct SurfaceAddress {
    std::uint32_t object = no_id;     ///< index into Animation::objects; no_id: no surface
    std::uint32_t primitive = no_id;  ///< triangle or segment within the object's mesh
    float u = 0;                      ///< weight of the triangle's second vertex, 0..1
    float v = 0;                      ///< weight of its third, 0..1

    bool is_surface() const { return object != no_id; }
    bool operator==(const SurfaceAddress&) const = default;
};

}  // namespace render2mpeg::core
