#pragma once

#include "core/motion_field.h"
#include "core/visible.h"
#include "scene/snapshot.h"

namespace render2mpeg::scene {

/// Exact motion of every pixel of `visible` (what `here` shows) to another instant (SPEC 3): surfaces by their address, the sky by
/// the camera's rotation. Pixels of class `reflected` get their carrier surface's motion and keep their class.
core::MotionField motion_between(const core::Visible& visible, const Snapshot& here, const Snapshot& reference);

}  // namespace render2mpeg::scene
