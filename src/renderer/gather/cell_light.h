#pragma once
// Light that places of surfaces send on: of lamps by next events, the rest by one ray each, whose end a cell knows.
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include "renderer/base/plan.h"
#include "renderer/gather/cell_updates.h"
#include "renderer/gather/gather_ray.h"
#include "renderer/gather/near_light.h"
#include "renderer/paths/light_sources.h"
#include "renderer/paths/scatterer.h"

namespace render2mpeg::renderer {

/// Results of the updates of one task.
struct TaskLight {
    std::vector<CellLink> links;  ///< of its updates
    AskedPlaces asked;            ///< by rays whose cell has to learn
    AskedPlaces among;            ///< likewise, of cells among strands
    ShardUpdates::TaskPaths paths;
    std::vector<CellLink> path_links;  ///< of updates of paths: one each, or none
    std::uint64_t rays = 0;
};

/// Places from which on a cell among strands answers paths. White hair keeps a thousandth of its light to itself: two
/// cells of one place that light each other would shine two hundred times too bright. Light of these places rests on
/// no other cell, so that none amplifies what it sends by more than its places over these. chosen: 4 of 2 to 8.
inline constexpr std::uint32_t answering_places = 4;

/// Evaluates places of the posed instant.
class CellLight {
  public:
    CellLight(const PosedScene& posed_scene, const Plan& plan);

    /// Lights and things are others now.
    void pose(NearField near_field);

    /// Light of lamps, shining surfaces and the image of a sky that a place scatters, by next-event estimation: a
    /// shadow ray for each kind, in one of so many directions. `wide`: scatters light that rays
    /// cannot meet; null: `at` does.
    glm::vec3 lamps(const Scatterer& at, const Stream& numbers, LightChoices choices, std::uint64_t& rays,
                    const Scatterer* wide = nullptr) const;
    /// Those worth choosing among where scattering peaks, as fibres' does.
    LightChoices light_choices() const;
    /// Lights of the posed instant.
    const LightSources& sources() const { return *sources_; }

    /// Evaluates updates of the last wave of a shard. Cells of fewer places than `known` are asked for. 1: rays whose
    /// cells are not there are followed as paths instead, until they meet one that is. Cells among strands are asked
    /// for where they do not answer.
    TaskLight evaluate(const ShardUpdates& shard, std::span<CellUpdate> updates, std::uint32_t known,
                       const LightCells& cells) const;
    /// Follows paths until they meet a cell that answers.
    void follow_paths(std::vector<PathStart> starts, const LightCells& cells, TaskLight& out) const;

  private:
    struct Bounce;
    struct Found;

    glm::vec3 choose_side(const Stream& numbers, SurfacePoint& p) const;
    void light_place(const CellQuery& place, const Stream& numbers, CellUpdate& update, Found& out) const;
    void follow_bounces(Found& out) const;

    const PosedScene& posed_scene_;
    GatherRays gather_rays_;
    const Plan& plan_;
    std::optional<LightSources> sources_;
    NearField near_field_;
};

}  // namespace render2mpeg::renderer
