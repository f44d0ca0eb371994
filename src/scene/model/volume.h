#pragma once
// Smoke, clouds and fire.
#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <vector>

#include "core/sparse_grid.h"

namespace render2mpeg::scene {

/// Grids of a volume at one instant, all over one index space.
struct VolumeGrids {
    glm::dmat4 object_from_index{1};       ///< affine, not singular
    core::SparseGrid<float> density;       ///< >= 0, finite
    core::SparseGrid<float> temperature;   ///< of flames, >= 0, finite; empty: none
    core::SparseGrid<glm::vec3> color;     ///< of what scatters, 0..1; empty: Volume::color alone
    core::SparseGrid<glm::vec3> velocity;  ///< object space, units a second; empty: none
};

/// An object that is filled with a medium: Blender's Principled Volume over grids of OpenVDB files.
struct Volume {
    std::string name;
    int node = -1;

    /// Files by frame: files[i] holds from first_frame + i on; before and after them the first and last do. One: still.
    std::vector<std::filesystem::path> files;
    std::int64_t first_frame = 0;
    std::string density_grid = "density", temperature_grid = "temperature", color_grid, velocity_grid;
    /// Grids in memory, instead of files.
    std::shared_ptr<const VolumeGrids> grids;

    float density = 1;              ///< extinction by object unit for 1 in the density grid, >= 0
    glm::vec3 color{0.5f};          ///< single-scattering albedo, 0..1, times the colour grid
    float anisotropy = 0;           ///< mean cosine of scattering [Henyey1941], -0.95..0.95
    glm::vec3 absorption_color{0};  ///< as Blender's: 0 absorbs what is not scattered
    float emission_strength = 0;    ///< radiance by object unit, times the density grid
    glm::vec3 emission_color{1};    ///< >= 0
    float blackbody_intensity = 0;  ///< 1: Stefan and Boltzmann's law, as Blender has it
    glm::vec3 blackbody_tint{1};    ///< 0..1
    float temperature = 1000;       ///< kelvin for 1 in the temperature grid
};

}  // namespace render2mpeg::scene
