#pragma once
// The border type of primary visibility: the point seen at each pixel.
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>

#include "core/packed_normal.h"
#include "core/plane.h"
#include "core/surface_address.h"

namespace render2mpeg::core {

/// Kind of a pixel's thing, by its motion. `reflected`: a mirror or glass, whose image moves neither with surface nor
/// world.
enum class PixelClass : std::uint8_t { none, surface, sky, reflected };

/// Primary visibility of a frame at pixel centres, in planes of the frame's size; small enough to keep for several
/// frames.
struct Visible {
    std::int64_t frame = 0;
    Plane<SurfaceAddress> address;         ///< no surface where the class is `none` or `sky`
    Plane<float> depth;                    ///< along the camera's axis, scene units, > 0; +infinity for the sky
    Plane<PackedNormal> geometric_normal;  ///< world space, turned to the viewer
    Plane<PackedNormal> shading_normal;    ///< world space, on the geometric normal's side
    Plane<std::uint32_t> material;         ///< index into Animation::materials; no_id for the sky
    Plane<PixelClass> kind;

    int width() const { return depth.width(); }
    int height() const { return depth.height(); }

    Visible() = default;
    Visible(std::int64_t frame_number, int width, int height)
        : frame(frame_number),
          address(width, height),
          depth(width, height, std::numeric_limits<float>::infinity()),
          geometric_normal(width, height),
          shading_normal(width, height),
          material(width, height, no_id),
          kind(width, height, PixelClass::none) {}
};

}  // namespace render2mpeg::core
