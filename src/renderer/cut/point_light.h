#pragma once
// The light of one gather point, before textures.
#include <algorithm>
#include <glm/glm.hpp>
#include <vector>

#include "core/standard_error.h"
#include "core/tolerance_map.h"
#include "renderer/cut/lighting_context.h"

namespace render2mpeg::renderer {

/// Light of one gather point, textures not yet applied.
struct PointLight {
    glm::vec3 direct{0}, indirect{0};        ///< irradiance over pi
    glm::vec3 glossy{0};                     ///< radiance
    float direct_cut = 0, indirect_cut = 0;  ///< clusters that were gathered for it; 0: for other points
    core::StandardError error{};             ///< in the pixel
    core::StandardError shared{};            ///< of the mean of its block of 8x8 pixels
    float clamped = 0;                       ///< luminance of the pixel that the clamp of near lights took
    float age = 0;        ///< frames since it was gathered; 0: in this one. A mean, where it comes from many records
    bool served = false;  ///< by records, or by an earlier frame: it may err otherwise than a cut of today
    bool capped = false;  ///< the largest cut came before the tolerance was kept

    /// Adds an error that its neighbours do not share.
    void add_alone(core::StandardError alone) {
        error += alone;
        shared += 0.125f * alone;
    }
    /// Radiance of the point in its pixel.
    glm::vec3 scattered(const GatherPoint& p) const {
        return p.weight * (p.point.bsdf.diffuse * (direct + indirect) + glossy);
    }
};

struct GatheredLight;

/// Light of a lane's point by its gathering.
PointLight point_light(const GatheredLight& gathered, int lane, const GatherPoint& point);

/// Light of all gather points of a frame, tile by tile.
using FrameLight = std::vector<std::vector<PointLight>>;

/// Tolerance of one gather point's light, in luminance of its pixel.
struct PointTolerance {
    core::Tolerance part;  ///< this point's part of its pixel's
    float base = 0;        ///< luminance of the pixel that is known already, this point's part of it

    /// Factor of it for errors that are independent of other points'. Of bounds the root of the pixel's over this part,
    /// since they add up by their squares. A price is the pixel's: a ray of any point is worth what it takes from that
    /// one's squared error, so that the factor is the pixel's over this part.
    float noise = 1;
    float root = 1;  ///< root of this point's share of its pixel

    float allows(float luminance) const { return part.allows(base + std::max(luminance, 0.0f)); }
    float allows_noise(float luminance) const { return part.allows(base + std::max(luminance, 0.0f), noise); }
    /// Likewise of light that is sampled whatever it costs.
    float allows_samples(float luminance) const { return part.allows(base + std::max(luminance, 0.0f), 1.0f / root); }
};

/// Parts the tolerances of a tile's pixels among their points by weight; what a pixel shows without gathering counts as
/// light. A point that the shutter or the lens spreads counts by all that it gives to pixels. `priced`: noise is of
/// rays, as many as they are worth. In the order of the tile.
std::vector<PointTolerance> point_tolerances(const LightingContext& context, std::size_t tile, bool priced);

}  // namespace render2mpeg::renderer
