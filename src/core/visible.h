#pragma once
// The border type of primary visibility: what each pixel shows.
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>

#include "core/packed_normal.h"
#include "core/plane.h"
#include "core/surface_address.h"

namespace render2mpeg::core {

/// What kind of thing a pixel shows, and so how it moves. `reflected`: a mirror or glass, whose image moves neither
/// with its surface nor with the world.
enum class PixelClass : std::uint8_t { none, surface, sky, reflected };

/// What one frame's pixels see: small enough to keep for several frames. All planes have the frame's size. Where a
/// pixel holds several surfaces, it is the one at the pixel's centre.
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
