#pragma once
// A view of a film from elsewhere than its own cameras.
#include <glm/glm.hpp>

#include "scene/model/camera.h"
#include "scene/pose/snapshot.h"

namespace render2mpeg::scene {

/// Place and lens of an eye beside the film's cameras. Of the lens all but its focus counts: everything is sharp.
struct Viewpoint {
    CameraLens lens;
    glm::dmat4 to_world{1.0};  ///< in the file's own space; looks along -z, y up
};

/// Lets a snapshot be seen from there, as an instant.
void see_from(const Viewpoint& viewpoint, PictureFormat format, Snapshot& snapshot);

}  // namespace render2mpeg::scene
