#include "scene/model/volume.h"

#include <algorithm>

#include "core/error.h"

namespace render2mpeg::scene {

void VolumeBox::hold(glm::dvec3 p) {
    low = any() ? glm::min(low, p) : p;
    high = any() ? glm::max(high, p) : p;
}

void VolumeBox::hold(const VolumeBox& other) {
    if (!other.any()) return;
    hold(other.low);
    hold(other.high);
}

void VolumeOutline::hold(const VolumeOutline& other) {
    box.hold(other.box);
    bytes = std::max(bytes, other.bytes);
}

std::vector<glm::dvec3> VolumeBox::corners() const {
    std::vector<glm::dvec3> all;
    for (int corner = 0; any() && corner < 8; ++corner)
        all.emplace_back(corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y, corner & 4 ? high.z : low.z);
    return all;
}

VolumeBox VolumeBox::moved(const glm::dmat4& to) const {
    VolumeBox box;
    for (const glm::dvec3& corner : corners()) box.hold(glm::dvec3(to * glm::dvec4(corner, 1)));
    return box;
}

std::vector<std::filesystem::path> Volume::files_of(std::size_t file) const {
    std::vector<std::filesystem::path> all{files.at(file)};
    if (!more_files.empty()) all.push_back(more_files.at(file));
    return all;
}

std::size_t Volume::file_at(std::int64_t frame) const {
    EXPECTS(!files.empty());
    return static_cast<std::size_t>(
        std::clamp<std::int64_t>(frame - first_frame, 0, static_cast<std::int64_t>(files.size()) - 1));
}

VolumeGrids even_grids(glm::dvec3 low, glm::dvec3 high) {
    // chosen: 64 voxels a side, 1 MiB: the faces' softness is seldom seen.
    constexpr int bricks = 8, voxels = bricks * core::SparseGrid<float>::brick_side;
    VolumeGrids grids;
    grids.density = core::SparseGrid<float>(glm::ivec3(0), glm::ivec3(bricks));
    for (int z = 0; z < bricks; ++z)
        for (int y = 0; y < bricks; ++y)
            for (int x = 0; x < bricks; ++x) grids.density.add({x, y, z}).fill(1);

    // Density falls from 1 to 0 between the outermost samples and those beyond: half of it lies on the faces.
    const glm::dvec3 side = (high - low) / static_cast<double>(voxels);
    for (int k = 0; k < 3; ++k) {
        grids.object_from_index[k][k] = side[k];
        grids.object_from_index[3][k] = low[k] + 0.5 * side[k];
    }
    return grids;
}

VolumeOutline outline_of(const VolumeGrids& grids) {
    const std::uint64_t bytes = grids.density.bytes() + grids.temperature.bytes() + grids.color.bytes();
    if (grids.density.empty()) return {{}, bytes};
    constexpr int side = core::SparseGrid<float>::brick_side;
    const VolumeBox voxels{glm::dvec3(side * grids.density.low()) - 0.5,
                           glm::dvec3(side * (grids.density.low() + grids.density.size())) - 0.5};
    return {voxels.moved(grids.object_from_index), bytes};
}

}  // namespace render2mpeg::scene
