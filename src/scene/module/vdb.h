#pragma once
// Interface of the module that reads OpenVDB's files.
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "scene/model/volume.h"

namespace render2mpeg::scene {

/// Bytes of all bricks and tables that a file may hold. chosen: 2 GiB are 2^29 voxels of density, 800^3 with nothing
/// empty; a film holds two files at once.
inline constexpr std::uintmax_t most_grid_bytes = std::uintmax_t{1} << 31;
/// Places for bricks in a grid's box. chosen: 2^24, a box of 2048^3 voxels, whose table takes 64 MiB.
inline constexpr std::uintmax_t most_brick_places = std::uintmax_t{1} << 24;

/// Has room made for so many bytes.
using MakeRoom = std::function<void(std::uintmax_t bytes)>;

class VdbReader {
  public:
    virtual ~VdbReader() = default;

    /// Reads a volume's grids of one file, or of the first of several that has one of its name, into the index space of
    /// its density: others are sampled trilinearly at its voxels. Tells in `notes`
    /// about values that no medium has, which become 0 or the nearest. Calls `room` before it takes bytes that
    /// follow from what the file says, not from its size: even parts. Throws core::Error. The library trusts its
    /// input: probe strangers' files first.
    virtual VolumeGrids read(std::span<const std::filesystem::path> files, const Volume& volume,
                             std::vector<std::string>& notes, const MakeRoom& room) const = 0;

    /// The same grids' box and bytes, as these files' heads say. Throws core::Error where read() would refuse a grid's
    /// name, kind or transform.
    virtual VolumeOutline outline(std::span<const std::filesystem::path> files, const Volume& volume) const = 0;
};

}  // namespace render2mpeg::scene
