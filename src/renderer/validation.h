#pragma once
// Holds pixels of a lit frame against the truth.
#include <optional>
#include <span>
#include <vector>

#include "core/radiance.h"
#include "renderer/calibration/audit.h"
#include "renderer/calibration/audited_pixel.h"
#include "renderer/cut/lighting_context.h"
#include "renderer/gather/final_gather.h"
#include "renderer/gather/frame_rays.h"
#include "renderer/surface/posed_scene.h"
#include "renderer/truth/error_split.h"
#include "renderer/truth/pixel_truth.h"
#include "renderer/view/see.h"

namespace render2mpeg::renderer {

/// A lit frame to be validated.
struct AuditedFrame {
    const PosedScene& posed_scene;
    LightingContext context;        ///< that it was lit by
    FinalGather* rays;              ///< of `rays_of`; null: of none
    std::optional<RaysOf> rays_of;  ///< that see the sky and indirect light, which light trees hold else
    const core::Radiance& radiance;
};

/// Radiance of pixels whose light is gathered from every light point by itself, and by as many rays as there can be.
/// >= 0 and finite.
std::vector<glm::vec3> exact_pixels(const AuditedFrame& frame, const std::vector<LitPixel>& pixels);

/// Light of a pixel that neither light trees nor paths find.
glm::vec3 light_of_bodies_and_air(const UngatheredLight& ungathered, int x, int y);

/// Audited pixels of the frame beside their truth, by paths (pixel_truth.h). The same for any number of threads.
std::vector<ValidatedPixel> validate_pixels(const AuditedFrame& frame, const SeeSettings& see, const Plan& plan,
                                            std::span<const AuditedPixel> audited, const TruthSettings& finely);

}  // namespace render2mpeg::renderer
