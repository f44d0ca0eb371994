#pragma once
// Radiance that surfaces send back along gather rays, kept in cells on the surfaces [Christensen1999].
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "renderer/gather/cell_light.h"
#include "renderer/gather/light_cells.h"

namespace render2mpeg::renderer {

/// Cells of the posed instant. A cell's radiance is the mean over some of the places where rays met it: of the light of
/// lamps, by one shadow ray for each kind and by what the next ray meets, and of the next cell that this ray asks.
/// These cells are learnt as well, until every ray has an answer; then the sums are solved as the linear equations that
/// they are, so that no bounce is cut off. Which places a cell has is decided by the order of the questions alone, for
/// any number of threads.
class SurfaceCache {
  public:
    SurfaceCache(const PosedScene& posed_scene, const Plan& plan) : light_(posed_scene, plan) {}

    /// Forgets all: light or things are others now, as posed.
    void forget(NearField near_field);

    /// Index of a cell that needs to learn no more; none: ask `learn`.
    std::uint32_t find(std::uint64_t key) const {
        const CellTable::Found cell = cells_.find(key);
        return cell.places >= most_places && (key & own_cell) == 0 ? cell.index : LightCells::none;
    }
    /// Index of any cell that was ever asked for.
    std::uint32_t index_of(std::uint64_t key) const { return cells_.find(key).index; }

    /// Makes known what these queries of cells ask for, which come in parts as tasks found them: their order is that of
    /// the parts. Own cells are known until the next call.
    void learn(std::vector<std::vector<CellQuery>> wanted);

    /// How places send on light of the posed instant.
    const CellLight& light() const { return light_; }

    /// Radiance of a cell.
    glm::vec3 radiance(std::uint32_t index) const { return cells_.at(index).radiance; }
    /// Part of it that near_light has not.
    glm::vec3 far_part(std::uint32_t index) const {
        const LightCell& cell = cells_.at(index);
        return glm::max(cell.radiance - cell.near, glm::vec3(0));
    }

    std::uint64_t rays() const { return rays_; }

    /// Cells of the posed instant.
    template <class A>
    friend void archive(A& a, SurfaceCache& cache) {
        auto& [light, cells, rays] = cache;
        a(cells);
    }

  private:
    /// Places that a cell is evaluated at, at most, if a point asks it; half as many for each bounce that lies between.
    /// chosen: 16 of 4 to 64, which err alike in Sponza.
    static constexpr std::uint32_t most_places = 16;

    struct Learning;
    struct Rows;

    void plan_wave(Learning& learning, std::uint32_t most);
    void evaluate_wave(Learning& learning, std::uint32_t known);
    void add_paths(Learning& learning);
    void follow_paths(Learning& learning, std::uint32_t most);
    Rows rows_of(ShardUpdates& shard);
    void solve(Learning& learning);

    CellLight light_;
    LightCells cells_;
    std::uint64_t rays_ = 0;
};

}  // namespace render2mpeg::renderer
