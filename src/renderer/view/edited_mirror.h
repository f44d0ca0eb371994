#pragma once
// Mirrors that are told what to show, as rays of the eye meet them (scene/pose/bent_reflections.h).
#include "renderer/surface/posed_scene.h"

namespace render2mpeg::renderer {

/// Whether a point's reflection is edited. Bodies of glass are as they are.
bool has_aimed_reflection(const PosedScene& posed_scene, const SurfacePoint& point);

/// Has a point mirror what its edits say: it is seen from where that is mirrored from, so that mirror and lobe both
/// turn. Changes `outgoing` alone; what the surface reflects in all stays what it is for the eye.
void aim_reflection(const PosedScene& posed_scene, float time, SurfacePoint& point);

/// A ray that meets a mirror, and how its neighbours differ.
struct MirroredRay {
    glm::vec3 direction;                       ///< unit, before the mirror
    SurfaceFootprint spread, footprint, turn;  ///< differences of directions, places and normals
    float time;                                ///< of the shutter
};

/// How the aimed directions of its neighbours differ from its own; `point`: aimed.
SurfaceFootprint aimed_change(const PosedScene& posed_scene, const MirroredRay& ray, const SurfacePoint& point);

}  // namespace render2mpeg::renderer
