#pragma once
// Light within a volume, known at lattices that lie in its grid.
#include <glm/glm.hpp>
#include <vector>

#include "core/sparse_grid.h"
#include "renderer/base/light_point.h"
#include "renderer/base/volume_medium.h"

namespace render2mpeg::renderer {

/// What a lamp's light meets on its way to a place: optical depth of all air, interpolated as such, so that it falls
/// off exponentially between samples, and the share that surfaces let through.
struct LampWay {
    glm::vec3 depth{0}, passes{0};

    LampWay operator+(const LampWay& o) const { return {depth + o.depth, passes + o.passes}; }
    LampWay operator*(float s) const { return {depth * s, passes * s}; }
};

/// A lamp, a point or a sun, whose light a volume scatters by its phase function.
struct VolumeLamp {
    LightPoint light;
    core::SparseGrid<LampWay> ways;
};

/// Light of the posed instant within one volume.
struct VolumeLight {
    int lamp_spacing = 1, ambient_spacing = 1;  ///< of samples, voxels
    std::vector<VolumeLamp> lamps;
    /// Mean radiance over all directions, of all but what lamps send and was not scattered yet.
    core::SparseGrid<glm::vec3> ambient;

    /// Radiance over the scattering coefficient that the medium scatters at a place along `direction` (unit, where
    /// light goes).
    glm::vec3 scattered(const VolumeMedium& medium, glm::vec3 index_place, glm::vec3 direction) const;
    /// Mean radiance over all directions of the lamps' light that similarity calls not scattered.
    glm::vec3 lamps_mean(const VolumeMedium& medium, glm::vec3 index_place) const;

    /// Empty samples, `spacing` voxels apart, wherever interpolation within the medium asks for one.
    template <class T>
    static core::SparseGrid<T> lattice(const VolumeField& field, int spacing);
};

/// Share of the extinction that remains where scattering by this mean cosine and albedo is taken as isotropic
/// (similarity relation): what goes on nearly straight counts as not scattered.
inline float similar(float anisotropy, float albedo) {
    return 1.0f - albedo * (anisotropy > 0.0f ? anisotropy : 0.0f);
}

template <class T>
core::SparseGrid<T> VolumeLight::lattice(const VolumeField& field, int spacing) {
    constexpr int side = core::SparseGrid<T>::brick_side;
    const auto below = [&](glm::ivec3 voxel) { return glm::ivec3(glm::floor(glm::vec3(voxel) / float(spacing))); };
    const glm::ivec3 low = below(side * field.low()) >> 3, high = (below(side * (field.low() + field.size())) + 1) >> 3;
    core::SparseGrid<T> grid(low, field.size() == glm::ivec3(0) ? glm::ivec3(0) : high - low + 1);
    field.each_brick([&](glm::ivec3 brick) {
        const glm::ivec3 first = below(side * brick) >> 3, last = (below(side * (brick + 1)) + 1) >> 3;
        for (int k = first.z; k <= last.z; ++k)
            for (int j = first.y; j <= last.y; ++j)
                for (int i = first.x; i <= last.x; ++i) grid.add({i, j, k});
    });
    return grid;
}

}  // namespace render2mpeg::renderer
