#pragma once
// Gathers one point from every light point: the reference.
#include "renderer/cut/gathered_light.h"
#include "renderer/geometry/ray_tracer.h"
#include "renderer/surface/gather_point.h"
#include "renderer/tree/light_trees.h"

namespace render2mpeg::renderer {

/// Light of one point from every light point by itself; writes lane 0 of `out` alone. Asks for sixteen neighbouring
/// lights of a tree from one point, whose rays are as alike wherever it lies; Gatherer::gather_all asks for one light
/// from sixteen points, which are a packet only where they are near each other.
void gather_all(const LightTrees& light_trees, const RayTracer& tracer, const GatherPoint& point, GatheredLight& out);

}  // namespace render2mpeg::renderer
