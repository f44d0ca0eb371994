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
    glm::dmat4 object_from_index{1};      ///< affine, not singular
    core::SparseGrid<float> density;      ///< >= 0, finite
    core::SparseGrid<float> temperature;  ///< of flames, >= 0, finite; empty: none
    core::SparseGrid<glm::vec3> color;    ///< of what scatters, 0..1; empty: Volume::color alone
};

/// A box in object space; low above high: none.
struct VolumeBox {
    glm::dvec3 low{1}, high{-1};

    bool any() const { return low.x <= high.x; }
    void hold(glm::dvec3 p);
    void hold(const VolumeBox& other);
    std::vector<glm::dvec3> corners() const;  ///< eight, or none
    /// About its corners there.
    VolumeBox moved(const glm::dmat4& to) const;
};

/// A volume's grids of one file, before they are read.
struct VolumeOutline {
    VolumeBox box;            ///< about the density, object space
    std::uint64_t bytes = 0;  ///< that all grids take, about

    void hold(const VolumeOutline& other);
};

/// An object that is filled with a medium: Blender's Principled Volume over grids of OpenVDB files.
struct Volume {
    std::string name;
    int node = -1;

    /// Files by frame: files[i] holds from first_frame + i on; before and after them the first and last do. One: still.
    std::vector<std::filesystem::path> files;
    /// None, or one beside each of these: grids that those lack.
    std::vector<std::filesystem::path> more_files;
    std::int64_t first_frame = 0;
    /// Empty: none, but for the density's. The temperature's is read where blackbody_intensity is above 0. Of a colour
    /// without a grid of its name, NAME_r, NAME_g and NAME_b are read, as Blender's simulations write them.
    std::string density_grid = "density", temperature_grid = "temperature", color_grid;
    /// Grids in memory, instead of files.
    std::shared_ptr<const VolumeGrids> grids;

    /// About its density, of every file or of some of a long sequence, and bytes of the largest of them; set by
    /// complete().
    VolumeOutline outline;

    float density = 1;              ///< extinction by object unit for 1 in the density grid, >= 0
    glm::vec3 color{0.5f};          ///< single-scattering albedo, 0..1, times the colour grid
    float anisotropy = 0;           ///< mean cosine of scattering [Henyey1941], -0.95..0.95
    glm::vec3 absorption_color{0};  ///< as Blender's: 0 absorbs what is not scattered
    float emission_strength = 0;    ///< radiance by object unit, times the density grid
    glm::vec3 emission_color{1};    ///< >= 0
    float blackbody_intensity = 0;  ///< 1: Stefan and Boltzmann's law, as Blender has it
    glm::vec3 blackbody_tint{1};    ///< >= 0
    float temperature = 1000;       ///< kelvin for 1 in the temperature grid

    bool reads_temperature() const { return blackbody_intensity > 0 && !temperature_grid.empty(); }
    bool emits() const { return emission_strength > 0 || blackbody_intensity > 0; }
    std::vector<std::filesystem::path> files_of(std::size_t file) const;
    /// Of `files`, at a frame. Needs one.
    std::size_t file_at(std::int64_t frame) const;
};

/// Even density 1 within a box of object space. Faces are soft by a 64th of its sides.
VolumeGrids even_grids(glm::dvec3 low, glm::dvec3 high);

/// Box about the bricks of the density, and what all grids take.
VolumeOutline outline_of(const VolumeGrids& grids);

}  // namespace render2mpeg::scene
