#pragma once
// Holds pixels of a lit frame against the truth.
#include <span>
#include <vector>

#include "core/radiance.h"
#include "core/tolerance_map.h"
#include "renderer/calibration/audited_pixel.h"
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
    const Seen& seen;
    const core::ToleranceMap& tolerance;
    const core::Radiance& radiance;
    const MovedPoints& moved;  ///< points that were lit elsewhere; empty: none
};

/// Audited pixels of the frame beside their truth, by paths (pixel_truth.h). The same for any number of threads.
std::vector<JudgedPixel> judge_pixels(const LitFrame& frame, const SeeSettings& see, const Plan& plan,
                                      std::span<const AuditedPixel> audited, const TruthSettings& finely);

}  // namespace render2mpeg::renderer
