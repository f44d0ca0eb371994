#pragma once
// Holds pixels of a lit frame against the truth.
#include <span>
#include <vector>

#include "core/radiance.h"
#include "core/tolerance_map.h"
#include "renderer/calibration/audit.h"
#include "renderer/calibration/audited_pixel.h"
#include "renderer/gather/final_gather.h"
#include "renderer/gather/frame_rays.h"
#include "renderer/surface/posed_scene.h"
#include "renderer/tree/light_trees.h"
#include "renderer/truth/error_split.h"
#include "renderer/truth/pixel_truth.h"
#include "renderer/view/see.h"

namespace render2mpeg::renderer {

/// A frame that was lit.
struct LitFrame {
    const PosedScene& posed_scene;
    const LightTrees& light_trees;
    FinalGather* rays;            ///< of `rays_of`; null: of none
    std::vector<RaysOf> rays_of;  ///< that see the sky and indirect light, which light trees hold else
    const Seen& seen;
    const core::ToleranceMap& tolerance;
    const core::Radiance& radiance;
    const MovedPoints& moved;  ///< points that were lit elsewhere; empty: none
};

/// What the pixels send when their light is gathered from every light point by itself, and by as many rays as there can
/// be, where it was when the frame was lit: some points were `moved` (empty: none). Radiance, >= 0 and finite.
std::vector<glm::vec3> exact_pixels(const LitFrame& frame, const std::vector<LitPixel>& pixels,
                                    const MovedPoints& moved = {});

/// Radiance of pixels that light trees and rays do not gather.
core::Plane<glm::vec3> light_of_bodies_and_air(const Seen& seen);

/// Audited pixels of the frame beside their truth, by paths (pixel_truth.h). The same for any number of threads.
std::vector<JudgedPixel> judge_pixels(const LitFrame& frame, const SeeSettings& see, const Plan& plan,
                                      std::span<const AuditedPixel> audited, const TruthSettings& finely);

}  // namespace render2mpeg::renderer
