#pragma once
// Chooses the places of anchor lights.
#include <cstdint>
#include <vector>

#include "core/surface_address.h"
#include "renderer/lights/point_tree.h"

namespace render2mpeg::renderer {

/// A place that light was seen to reach, or that lies there by area alone. Groups are surfaces that keep their shape
/// among each other: all that is still (group 0, in world space), or one object that moves (in its mesh's space).
struct AnchorCandidate {
    core::SurfaceAddress address;
    bool front = true;   ///< which side of the triangle it lies on
    OrientedPoint rest;  ///< in the space of its group
    std::uint32_t group = 0;
    bool even = false;     ///< one of points spread evenly over surfaces, whether light was seen there or not
    float flux = 0;        ///< luminance of the light that leaves it, >= 0
    float importance = 1;  ///< to what is seen, > 0: anchors lie in proportion to it
    float area_scale = 1;  ///< world area over area in the group's space
    float extent2 = 0;     ///< squared size of the whole group: what an anchor that is alone stands for
};

/// An anchor's place.
struct AnchorPlace {
    core::SurfaceAddress address;
    bool front = true;
    OrientedPoint rest;
    std::uint32_t group = 0;
    float disc2 = 0;  ///< in the space of its group: see LightPoint::disc2
};

/// Chooses about `count` of the candidates, stratified over their surfaces: half of the anchors by area, half by flux,
/// but a sixteenth evenly over all surfaces, where there are candidates for that (docs/model/lights.md).
/// Every group other than 0 gets one at least, and one for each of six ways that its lit places face. A function of the
/// arguments alone.
std::vector<AnchorPlace> choose_places(const std::vector<AnchorCandidate>& candidates, int count);

/// The area that each of these points stands for, from its nearest neighbours that face alike; `alone` where there is
/// no other point.
std::vector<float> cell_areas(const std::vector<OrientedPoint>& points, float alone);

}  // namespace render2mpeg::renderer
