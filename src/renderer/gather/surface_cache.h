#pragma once
// Radiance that surfaces send back along gather rays, kept in cells on the surfaces [Christensen1999].
#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "renderer/base/plan.h"
#include "renderer/gather/gather_ray.h"
#include "renderer/gather/near_light.h"
#include "renderer/paths/light_sources.h"
#include "renderer/paths/scatterer.h"

namespace render2mpeg::renderer {

/// A table from keys to indices.
class CellTable {
  public:
    static constexpr std::uint32_t none = 0xffffffffu;

    void clear();
    std::uint32_t find(std::uint64_t key) const;
    /// The key is not there yet.
    void insert(std::uint64_t key, std::uint32_t index);
    std::size_t bytes() const { return slots_.capacity() * sizeof(Slot); }

  private:
    struct Slot {
        std::uint64_t key = 0;
        std::uint32_t index = none;
    };
    std::size_t place_of(std::uint64_t key) const;

    std::vector<Slot> slots_;
    std::size_t used_ = 0;
};

/// Cells of the posed instant. A cell's radiance is the mean over some of the places where rays met it: of the light of
/// lamps, by one shadow ray for each kind and by what the next ray meets, and of the next cell that this ray asks.
/// These cells are learnt as well, until every ray has an answer; then the sums are solved as the linear equations that
/// they are, so that no bounce is cut off. Which places a cell has is decided by the order of the questions alone, for
/// any number of threads.
class SurfaceCache {
  public:
    SurfaceCache(const PosedScene& posed_scene, const Plan& plan);

    /// Forgets all: light or things are others now, as posed.
    void forget(NearField near_field);

    /// Index of a cell that needs to learn no more; CellTable::none: ask `learn`.
    std::uint32_t find(std::uint64_t key) const;
    /// Index of any cell that was ever asked for.
    std::uint32_t index_of(std::uint64_t key) const;

    /// Makes known what these sightings ask for; sorts them. Own cells are known until the next call.
    void learn(std::vector<Sighting>& wanted);

    /// Light of lamps, shining surfaces and the image of a sky that a place scatters, by next-event estimation.
    glm::vec3 lamps(const Scatterer& at, std::uint64_t number, std::uint64_t& rays) const;
    /// Lights of the posed instant.
    const LightSources& sources() const { return *sources_; }

    /// Radiance of a cell.
    glm::vec3 radiance(std::uint32_t index) const { return cell(index).radiance; }
    /// Part of it that near_light has.
    glm::vec3 near_part(std::uint32_t index) const { return cell(index).near; }
    /// The other part.
    glm::vec3 far_part(std::uint32_t index) const { return glm::max(radiance(index) - near_part(index), glm::vec3(0)); }

    std::size_t bytes() const {
        return (cells_.capacity() + own_cells_.capacity()) * sizeof(Cell) + table_.bytes() + own_table_.bytes();
    }
    std::uint64_t rays() const { return rays_; }

  private:
    static constexpr std::uint32_t none = CellTable::none;
    struct Cell {
        glm::vec3 radiance{0}, near{0};
        std::uint32_t places = 0;     ///< that it is the mean of, those that are being evaluated among them
        std::uint32_t lesson = none;  ///< that teaches it, the last one
    };
    /// Light that one cell takes over from another: weight times its radiance.
    struct Link {
        std::uint64_t key = 0;
        glm::vec3 weight{0};
        float near = 0;  ///< share of it that near_light has
        std::uint32_t cell = none;
    };
    /// A cell that is being learnt.
    struct Lesson {
        std::uint32_t cell = 0;
        std::uint32_t first = 0, places = 0;          ///< of the places that are evaluated
        std::uint32_t number = 0;                     ///< of the first, among all that the cell ever had
        std::uint32_t earlier = none;                 ///< lesson of the same cell
        std::uint32_t first_link = 0, last_link = 0;  ///< once they are
        glm::vec3 known{0}, near{0};                  ///< sums over places
        glm::vec3 albedo{0}, drawn{0};                ///< likewise, of surfaces and of weights of the rays they send
        bool fibres = false;                          ///< places are of hair
    };
    struct Bounce;
    struct Evaluated;

    /// Indices with this bit are of own cells.
    static constexpr std::uint32_t own_index = 1u << 31;
    const Cell& cell(std::uint32_t index) const {
        return (index & own_index) != 0 ? own_cells_[index & ~own_index] : cells_[index];
    }
    Cell& cell(std::uint32_t index) { return const_cast<Cell&>(std::as_const(*this).cell(index)); }
    std::uint32_t make_cell(std::uint64_t key);
    void plan_lessons(std::vector<Sighting>& wanted, std::uint32_t most, std::vector<Sighting>& places,
                      std::vector<Lesson>& lessons);
    glm::vec3 choose_side(std::uint64_t number, SurfacePoint& p) const;
    void light_place(const Sighting& place, std::uint64_t number, std::uint32_t index, Lesson& lesson,
                     Evaluated& out) const;
    void follow_bounces(std::span<Lesson> lessons, Evaluated& out) const;
    void evaluate_lessons(std::span<Lesson> lessons, const std::vector<Sighting>& places, std::vector<Link>& links,
                          std::uint32_t most, std::vector<Sighting>& wanted);
    void solve(std::span<Lesson> lessons, std::vector<Link>& links);

    const PosedScene& posed_scene_;
    GatherRays gather_rays_;
    const Plan& plan_;
    std::optional<LightSources> sources_;  ///< of the posed instant
    CellTable table_, own_table_;
    std::vector<Cell> cells_, own_cells_;
    NearField near_field_;
    std::uint64_t rays_ = 0;
};

}  // namespace render2mpeg::renderer
