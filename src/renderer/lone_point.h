#pragma once

#include "renderer/cut.h"

namespace render2mpeg::renderer {

/// What one point receives from every light point by itself; lane 0 of `out` is all that is written.
/// Gatherer::gather_all asks for one light from sixteen points, which are a packet only where they are near each other;
/// this asks for sixteen neighbouring lights of a tree from one point, whose rays are as alike wherever it lies.
void gather_all(const LightForest& forest, const RayTracer& tracer, const GatherPoint& point, GatheredLight& out);

}  // namespace render2mpeg::renderer
