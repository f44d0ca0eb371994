#pragma once
// Tells which meshes of glass bound a body, and which of those are slabs.
#include "scene/model/animation.h"

namespace render2mpeg::scene {

/// Sets Object::body of every object from its material and its mesh's rest pose; notes solids whose mesh is open.
void set_bodies(Animation& animation);

/// Whether triangles close a surface: their vector areas cancel out, to 5 % of the area.
bool is_closed(const Mesh& mesh);

/// Whether 99 % of a mesh's area faces one direction or its opposite, to 2 degrees: the panes of windows.
bool is_slab(const Mesh& mesh);

}  // namespace render2mpeg::scene
