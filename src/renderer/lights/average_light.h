#pragma once

#include "scene/pose/snapshot.h"

namespace render2mpeg::renderer {

/// The snapshot with every lamp and emissive surface at its average strength over the film, but at least a
/// tenth of its largest, so that what shines for a moment, or later, is reckoned with. What only serves to plan light
/// is planned by this.
scene::Snapshot with_average_light(const scene::Snapshot& snapshot);

}  // namespace render2mpeg::renderer
