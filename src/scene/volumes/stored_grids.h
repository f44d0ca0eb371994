#pragma once
// Grids as bytes, by which one process hands them to another.
#include "scene/model/volume.h"

namespace render2mpeg::scene {

/// Writes grids to a file from its start on. Throws std::bad_alloc where it takes no more.
void store_grids(const VolumeGrids& grids, int file);

/// Grids that store_grids() wrote. Throws core::Error of `name` where these are others.
VolumeGrids stored_grids(int file, const std::string& name);

}  // namespace render2mpeg::scene
