#pragma once
// How much of a glossy lobe an area lamp covers.
#include "renderer/base/area_lamp.h"
#include "renderer/tree/gather_lanes.h"

namespace render2mpeg::renderer {

/// Share of the directions along each lane's lobe, chosen in proportion to the facets that are seen [Heitz2018], that
/// meet the lamp, nothing in the way: the integral of their density over the part of the lamp above the horizon, 0..1,
/// within some 1e-4. Facets are seen through a disc, evenly, once they are stretched to a hemisphere: so it is the area
/// that the lamp's outline encloses there, over that of all facets. For glossy lanes; unset for others.
void lobe_coverage(const AreaLamp& lamp, const GatherLanes& lanes, Lanes& share);

}  // namespace render2mpeg::renderer
