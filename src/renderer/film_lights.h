#pragma once
// The lights of a film, as they shine at the posed instant.
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "renderer/base/stopwatch.h"
#include "renderer/gather/final_gather.h"
#include "renderer/gather/near_light.h"
#include "renderer/geometry/light_change.h"
#include "renderer/lights/area_lamps.h"
#include "renderer/lights/light_points.h"
#include "renderer/lights/virtual_lights.h"
#include "renderer/settings.h"
#include "renderer/statistics.h"
#include "renderer/tree/light_trees.h"
#include "scene/pose/snapshot.h"

namespace render2mpeg::renderer {

/// Light points, area lamps and their trees: built for a chunk, updated at each instant whose light is another. Counts
/// in `statistics` and `times`, which must outlive it.
class FilmLights {
  public:
    FilmLights(PosedScene& posed_scene, const Plan& plan, const Settings& settings, Statistics& statistics,
               PassTimes& times);
    /// Lights of the same film for other instants, with what `prepared` has prepared.
    FilmLights(const FilmLights& prepared, PosedScene& posed_scene, const Plan& plan, const Settings& settings,
               Statistics& statistics, PassTimes& times);

    /// Finds what is the same in all chunks, where that was not done. The snapshot gets posed.
    void prepare(const scene::Snapshot& instant);
    /// Builds what a chunk keeps, and poses its first instant.
    void start_chunk(const scene::Snapshot& first);
    /// Lights of the posed snapshot. Whether they are others than those of the instant lit before.
    bool update(const scene::Snapshot& snapshot);

    /// Of the instant of the last update.
    LightTrees& trees() { return trees_; }
    /// All light points of the posed instant, those in no tree among them.
    std::vector<LightPoint> points() { return light_points_.at(posed_scene_); }
    /// The sky that gather rays see, and their near field.
    const SkyOfRays& sky_of_rays() const { return sky_of_rays_; }
    /// The first frame that `trees` are of.
    std::int64_t lit_frame() const { return lit_frame_; }
    /// Whether rays gather indirect light and the sky, else light points.
    bool by_rays() const { return settings_.indirect == Indirect::rays && settings_.vpls > 0; }

  private:
    bool shine(const scene::Snapshot& snapshot, const LightChange& change);
    NearField near_field_of(const scene::Snapshot& snapshot, std::span<const LightPoint> lights,
                            const LightChange& change) const;
    std::vector<LightPoint> clustered(std::vector<LightPoint> points) const;
    void build_trees(const scene::Snapshot& snapshot);

    PosedScene& posed_scene_;
    const Plan& plan_;
    const Settings& settings_;
    Statistics& statistics_;
    PassTimes& times_;
    LightPoints light_points_;
    std::uint64_t paths_ = 0;  ///< of photons, in each frame of the chunk
    AreaLamps lamps_;
    PersistentLightTrees persistent_trees_;  ///< of the chunk
    std::int64_t first_frame_ = 0;           ///< of the chunk
    std::optional<scene::Snapshot> shone_at_;
    std::vector<LightPoint> shining_;   ///< direct light points, until trees take them
    std::vector<LightPoint> indirect_;  ///< VPLs of photons, or of the near field
    SkyOfRays sky_of_rays_;
    LightTrees trees_;
    std::int64_t lit_frame_ = 0;
};

}  // namespace render2mpeg::renderer
