#pragma once
// A gather point: a surface point that light is gathered for.
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "core/mattes.h"
#include "core/packed_normal.h"
#include "core/visible.h"
#include "renderer/surface/surface_point.h"

namespace render2mpeg::renderer {

/// Pixels of a tile: one macroblock.
inline constexpr int tile_size = 16;

/// Two samples of a pixel lie on one surface if their normals differ by less than this. chosen: cos 11 degrees, where
/// the cosine of light at 45 degrees changes by a fifth over the pixel; tried 0.9..0.999 on the rim of a sphere.
inline constexpr float same_normal = 0.98f;

/// Places of a pixel's surface that shadow rays may leave beside the first.
inline constexpr int most_other_places = 3;

/// The mirrors and panes of glass between the eye and a point, nearest first: a one, then a bit each, 1 for a mirror.
/// From the eighth on the oldest are forgotten and the highest bit stays.
inline constexpr std::uint8_t direct_path = 1;
inline std::uint8_t extended_path(std::uint8_t path, bool mirror) {
    return static_cast<std::uint8_t>((path << 1) | (path & 128) | (mirror ? 1 : 0));
}

/// One surface in one pixel (or seen from it in a mirror or through glass) that wants light. A pixel's samples on one
/// surface share one gather point; its textures are averaged over them.
struct GatherPoint {
    SurfacePoint point;
    std::uint16_t pixel = 0;  ///< within its tile: y * tile_size + x
    std::uint8_t path = direct_path;
    glm::vec3 weight{1};  ///< share of the pixel x transmittance of mirrors, glass and layers
    /// Where shadow rays leave the same surface elsewhere in the pixel, world; the first `others` of them: shadows have
    /// edges within pixels.
    std::array<glm::vec3, most_other_places> elsewhere{};
    std::uint8_t others = 0;
    /// When its shadow rays leave: 0 in the middle of the shutter; else in strata of its time, each in the same one of
    /// 16 parts, this less one: where moving objects may shadow others.
    std::uint8_t shadow_part = 0;
    /// Further places; null: none. Only where contrast is high (refine_edges.h).
    std::shared_ptr<const std::vector<glm::vec3>> more_places{};

    bool reached_by_specular() const { return path != direct_path; }
};

/// All gather points of one 16x16 tile, by pixel in raster order.
using GatherTile = std::vector<GatherPoint>;

/// One eye sample of a fibre, or of light below a surface; its light is found by itself (hair_light.h).
struct FibreSample {
    core::SurfaceAddress address;
    core::PackedNormal outgoing;  ///< to where it is seen from
    glm::vec3 weight{1};          ///< as GatherPoint's
    std::uint16_t pixel = 0;      ///< likewise
    bool specular = false;        ///< seen in mirrors or through glass
    bool below = false;           ///< SurfacePoint's
};
/// Those of a tile, by pixel in raster order.
using FibreTile = std::vector<FibreSample>;

}  // namespace render2mpeg::renderer
