#pragma once
// Differences of light between two instants.
#include "scene/pose/snapshot.h"

namespace render2mpeg::renderer {

/// Causes of changed light between two instants.
struct LightChange {
    bool things = false;   ///< something moved, came, went, or changed its colour
    bool sources = false;  ///< some source shines from elsewhere, or otherwise than before

    /// Whether light is the same: everything but the camera.
    bool none() const { return !things && !sources; }
};

/// From one instant of a film to another.
LightChange change_between(const scene::Snapshot& before, const scene::Snapshot& now);

}  // namespace render2mpeg::renderer
