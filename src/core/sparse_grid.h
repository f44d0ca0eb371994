#pragma once
// Three-dimensional grids, most of which are empty.
#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "core/error.h"

namespace render2mpeg::core {

/// Voxels in bricks of 8 x 8 x 8; bricks that are absent are 0 throughout. Voxel (x, y, z) is a sample at that place of
/// index space; between samples the grid is meant to be interpolated trilinearly.
template <class T>
class SparseGrid {
  public:
    static constexpr int brick_side = 8, brick_voxels = brick_side * brick_side * brick_side;
    using Brick = std::array<T, brick_voxels>;  ///< x fastest, then y
    static constexpr std::uint32_t absent = 0xffffffffu;

    SparseGrid() = default;
    /// For bricks from `low` (in bricks, may be negative) on, `size` of them each way.
    SparseGrid(glm::ivec3 low, glm::ivec3 size) : low_(low), size_(size) {
        EXPECTS(size.x >= 0 && size.y >= 0 && size.z >= 0);
        table_.assign(std::size_t(size.x) * std::size_t(size.y) * std::size_t(size.z), absent);
    }

    bool empty() const { return bricks_.empty(); }
    glm::ivec3 low() const { return low_; }    ///< in bricks
    glm::ivec3 size() const { return size_; }  ///< in bricks
    std::size_t bytes() const { return bricks_.size() * sizeof(Brick) + table_.size() * sizeof(table_[0]); }
    std::size_t count() const { return bricks_.size(); }

    /// The brick at a place (in bricks), added where it is absent. The place is within the grid.
    Brick& add(glm::ivec3 place) {
        std::uint32_t& entry = table_[slot(place)];
        if (entry == absent) {
            entry = static_cast<std::uint32_t>(bricks_.size());
            bricks_.push_back({});
        }
        return bricks_[entry];
    }

    /// Sets a voxel of a brick that is there. Others may be set at the same time.
    void set(glm::ivec3 voxel, const T& value) { bricks_[table_[slot(voxel >> 3)]][place_in_brick(voxel)] = value; }

    void reserve(std::size_t bricks) { bricks_.reserve(bricks); }

    /// Null: absent, or beyond the grid.
    const Brick* find(glm::ivec3 place) const {
        const glm::ivec3 at = place - low_;
        if (at.x < 0 || at.y < 0 || at.z < 0 || at.x >= size_.x || at.y >= size_.y || at.z >= size_.z) return nullptr;
        const std::uint32_t entry = table_[slot(place)];
        return entry == absent ? nullptr : &bricks_[entry];
    }

    T at(glm::ivec3 voxel) const {
        const Brick* brick = find(voxel >> 3);
        return brick ? (*brick)[place_in_brick(voxel)] : T{};
    }

    /// Calls visit(place, brick) for all bricks, x fastest, then y.
    template <class Visit>
    void each(Visit visit) const {
        for (int z = 0; z < size_.z; ++z)
            for (int y = 0; y < size_.y; ++y)
                for (int x = 0; x < size_.x; ++x)
                    if (const Brick* brick = find(low_ + glm::ivec3(x, y, z)))
                        visit(low_ + glm::ivec3(x, y, z), *brick);
    }

    /// Voxel `k` of the brick at a place.
    static glm::ivec3 voxel(glm::ivec3 place, int k) {
        return brick_side * place + glm::ivec3(k & 7, k >> 3 & 7, k >> 6);
    }
    static std::size_t place_in_brick(glm::ivec3 voxel) {
        return std::size_t(voxel.x & 7) + 8 * std::size_t(voxel.y & 7) + 64 * std::size_t(voxel.z & 7);
    }

  private:
    std::size_t slot(glm::ivec3 place) const {
        const glm::ivec3 at = place - low_;
        EXPECTS_DEBUG(at.x >= 0 && at.y >= 0 && at.z >= 0 && at.x < size_.x && at.y < size_.y && at.z < size_.z);
        return std::size_t(at.x) +
               std::size_t(size_.x) * (std::size_t(at.y) + std::size_t(size_.y) * std::size_t(at.z));
    }

    glm::ivec3 low_{0}, size_{0};
    std::vector<std::uint32_t> table_;
    std::vector<Brick> bricks_;
};

}  // namespace render2mpeg::core
