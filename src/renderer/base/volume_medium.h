#pragma once
// A medium in a sparse grid: what it takes, scatters and sends at a place, and the bricks along a ray.
#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include "scene/model/volume.h"

namespace render2mpeg::renderer {

/// A part of a medium that shines, as one point.
struct Flame {
    glm::vec3 place{0};      ///< index space
    glm::vec3 intensity{0};  ///< radiant intensity, for emission by object unit and volumes by voxel
    float radius = 0;        ///< root mean square distance of the emission from it, voxels
};

/// Grids of one file with what is known of their bricks; the same wherever they lie. Interpolation at a place of
/// brick b reads voxels 8 b to 8 b + 8, so bricks are counted from one below the grid's first.
class VolumeField {
  public:
    struct Range {
        float least = 0, most = 0;  ///< of the density
        bool any = false;           ///< neither density nor temperature is 0 throughout
    };

    VolumeField(const scene::Volume& volume, std::shared_ptr<const scene::VolumeGrids> grids);

    const scene::VolumeGrids& grids() const { return *grids_; }
    glm::ivec3 low() const { return low_; }    ///< in bricks
    glm::ivec3 size() const { return size_; }  ///< in bricks
    const Range& range(glm::ivec3 brick) const;
    /// Calls visit(brick) for all bricks that are not 0 throughout, x fastest, then y.
    template <class Visit>
    void each_brick(Visit visit) const {
        for (int z = 0; z < size_.z; ++z)
            for (int y = 0; y < size_.y; ++y)
                for (int x = 0; x < size_.x; ++x)
                    if (const glm::ivec3 brick = low_ + glm::ivec3(x, y, z); range(brick).any) visit(brick);
    }
    /// Radiance by object unit at a place in index space.
    glm::vec3 emission(glm::vec3 place) const;
    float density(glm::vec3 place) const;
    float most() const { return most_; }  ///< of the density
    /// Whether a voxel is dense, or hot.
    bool holds(glm::ivec3 voxel) const;
    bool shines() const { return shines_; }
    /// At most `most_flames`, neighbours in a row; the k-th is about the same part whatever burns.
    const std::vector<Flame>& flames() const { return flames_; }
    static constexpr std::size_t most_flames = 64;

  private:
    void find_flames();
    glm::vec3 emission_of(float density, float temperature) const;

    scene::Volume volume_;  ///< without its grids and files
    std::shared_ptr<const scene::VolumeGrids> grids_;
    glm::ivec3 low_{0}, size_{0};
    std::vector<Range> ranges_;
    float most_ = 0;
    bool shines_ = false;
    std::vector<Flame> flames_;
};

/// Coefficients at a place, by world unit.
struct MediumPoint {
    glm::vec3 extinction{0}, scattering{0}, emission{0};
};

/// A volume as it lies in the world.
class VolumeMedium {
  public:
    /// `world_from_object`: affine. A singular one holds nothing.
    VolumeMedium(const scene::Volume& volume, std::shared_ptr<const VolumeField> field,
                 const glm::dmat4& world_from_object);

    bool scatters() const { return density_ > 0.0f && color_ != glm::vec3(0); }
    bool empty() const { return !(scale_ > 0.0f); }
    const VolumeField& field() const { return *field_; }
    glm::vec3 to_index(glm::vec3 place) const { return glm::vec3(index_from_world_ * glm::vec4(place, 1)); }
    glm::vec3 vector_to_index(glm::vec3 v) const { return glm::mat3(index_from_world_) * v; }
    glm::vec3 to_world(glm::vec3 place) const { return glm::vec3(world_from_index_ * glm::vec4(place, 1)); }
    float voxel() const { return voxel_; }  ///< cube root of a voxel's volume, world
    float anisotropy() const { return anisotropy_; }

    /// At a place in index space.
    MediumPoint at(glm::vec3 place) const;
    glm::vec3 extinction(glm::vec3 place) const;
    /// Share of what is taken that is scattered, wherever there is some medium.
    glm::vec3 albedo(glm::vec3 place) const;
    /// Extinction of a density, luminance.
    float largest_extinction(const VolumeField::Range& range) const { return range.most * largest_; }
    /// Radiant intensity of a flame.
    glm::vec3 intensity(const Flame& flame) const { return flame.intensity * (scale_ * voxel_ * voxel_ * voxel_); }

  private:
    glm::vec3 color_at(glm::vec3 place) const;

    std::shared_ptr<const VolumeField> field_;
    glm::mat4 index_from_world_{1}, world_from_index_{1};
    float voxel_ = 1, anisotropy_ = 0;
    float scale_ = 0;  ///< object units by world unit
    float density_ = 0, largest_ = 0;
    glm::vec3 color_{0}, unabsorbed_{0};
};

/// Pieces of a ray within one brick each, or before, between and behind them.
class BrickWalk {
  public:
    /// Distances are in units of `direction`, which is unit.
    BrickWalk(const VolumeMedium& medium, glm::vec3 origin, glm::vec3 direction);

    bool misses() const { return !meets_; }
    bool is_inside() const { return inside_ != nullptr && inside_->any; }
    float end() const { return end_; }
    void advance();
    glm::vec3 place(float distance) const { return origin_ + distance * direction_; }  ///< index space
    /// Length of a step in this piece that keeps errors small, world. `coarse`: of secondary rays.
    float step(bool coarse) const;

  private:
    const VolumeMedium* medium_;
    glm::vec3 origin_, direction_, next_{0};
    glm::ivec3 brick_{0}, turn_{0};
    const VolumeField::Range* inside_ = nullptr;
    float in_ = 0, out_ = 0, end_ = 0, voxels_ = 1;
    bool meets_ = false, began_ = false;
};

/// Trilinear interpolation of samples at whole places.
template <class T>
T interpolated(const core::SparseGrid<T>& grid, glm::vec3 place) {
    const glm::vec3 low = glm::floor(place), t = place - low;
    const glm::ivec3 v(low);
    T corner[8];
    const glm::ivec3 in = v & 7;
    if (in.x < 7 && in.y < 7 && in.z < 7) {
        const auto* brick = grid.find(v >> 3);
        if (brick == nullptr) return T{};
        const T* first = brick->data() + core::SparseGrid<T>::place_in_brick(v);
        constexpr int offsets[8] = {0, 1, 8, 9, 64, 65, 72, 73};
        for (int c = 0; c < 8; ++c) corner[c] = first[offsets[c]];
    } else {
        for (int c = 0; c < 8; ++c) corner[c] = grid.at(v + glm::ivec3(c & 1, c >> 1 & 1, c >> 2));
    }
    const auto mix = [](const T& a, const T& b, float s) { return a * (1.0f - s) + b * s; };
    return mix(mix(mix(corner[0], corner[1], t.x), mix(corner[2], corner[3], t.x), t.y),
               mix(mix(corner[4], corner[5], t.x), mix(corner[6], corner[7], t.x), t.y), t.z);
}

}  // namespace render2mpeg::renderer
