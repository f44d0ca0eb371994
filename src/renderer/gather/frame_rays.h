#pragma once
// Gathers by rays for all points of a frame, and for single pixels of it.
#include <optional>
#include <span>
#include <vector>

#include "core/tolerance_map.h"
#include "renderer/cut/point_light.h"
#include "renderer/gather/final_gather.h"
#include "renderer/surface/frame.h"
#include "scene/model/camera.h"

namespace render2mpeg::renderer {

/// Rays that see light which light trees lack: all light `by_rays`, else that of narrow lobes, if any are seen.
inline std::optional<RaysOf> missing_light(bool by_rays, bool narrow_lobes) {
    if (by_rays) return RaysOf::all;
    return narrow_lobes ? std::optional(RaysOf::lobes) : std::nullopt;
}

/// Whether a surface reflects any light of such rays.
bool wants_rays(const Bsdf& bsdf, RaysOf which);

/// Adds the sky and indirect light that such rays see to what light trees sent to the points of a
/// frame. Points of one group share what they know of their rays (GatherRequest::pool). With the reference's tolerance
/// each takes as many rays as there can be.
void add_rays(FinalGather& gather, const scene::Camera& camera, const LightingContext& context, RaysOf which,
              FrameLight& light);

/// Contribution of such rays to some pixels: sums over points that lie in one pixel each. As many rays as there can be,
/// other ones than those of frames. `points`: copies, where they were lit; `of_pixel`: to which of `pixels` each
/// belongs.
std::vector<glm::vec3> exact_rays(FinalGather& gather, const scene::Camera& camera, std::span<const GatherPoint> points,
                                  std::span<const std::size_t> of_pixel, std::size_t pixels, RaysOf which);

}  // namespace render2mpeg::renderer
