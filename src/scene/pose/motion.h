#pragma once
// Exact motion of every pixel between two instants.
#include "core/motion_field.h"
#include "core/visible.h"
#include "scene/pose/snapshot.h"

namespace render2mpeg::scene {

/// Surface points reflected by flat and edited mirrors at the pixels of class `reflected`; may be empty.
using MirrorImages = core::Plane<core::SurfaceAddress>;

/// Exact motion of every pixel of `visible` (the view of `here`) to another instant (docs/model/scene.md): surfaces by
/// their address, the sky by the camera's rotation. Pixels of class `reflected` get their carrier surface's motion, or,
/// where `imaged` names it, that of the image, and keep their class.
core::MotionField motion_between(const core::Visible& visible, const Snapshot& here, const Snapshot& reference,
                                 const MirrorImages* imaged = nullptr);

/// The same in pieces, for callers that share rows among threads: an empty field (class `none` everywhere), and its
/// rows [first_row, last_row), which depend on no other row.
core::MotionField motion_field_for(const core::Visible& visible, const Snapshot& here, const Snapshot& reference);
void motion_of_rows(const core::Visible& visible, const Snapshot& here, const Snapshot& reference, int first_row,
                    int last_row, core::MotionField& field, const MirrorImages* imaged = nullptr);

}  // namespace render2mpeg::scene
