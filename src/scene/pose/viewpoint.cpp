#include "scene/pose/viewpoint.h"

#include "scene/pose/bent_reflections.h"
#include "scene/pose/pose.h"
#include "scene/pose/posing.h"

namespace render2mpeg::scene {

void see_from(const Viewpoint& viewpoint, PictureFormat format, Snapshot& snapshot) {
    const Animation& animation = *snapshot.animation;
    const float aspect = static_cast<float>(format.width) * format.pixel_aspect / static_cast<float>(format.height);
    CameraLens lens = viewpoint.lens;
    lens.aperture_radius = 0;
    snapshot.camera = Camera(lens, rigid(viewpoint.to_world, animation.origin), format.width, format.height, aspect);
    snapshot.sweep.reset();
    // Edited reflections are true for one eye.
    if (snapshot.bends)
        snapshot.bends = bend_reflections(snapshot, pose_at(animation, snapshot.time.value()), 0, ShutterInterval());
}

}  // namespace render2mpeg::scene
