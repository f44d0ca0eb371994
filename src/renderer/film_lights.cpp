#include "renderer/film_lights.h"

#include <algorithm>
#include <utility>

#include "core/color.h"
#include "renderer/base/lobe.h"

namespace render2mpeg::renderer {
namespace {

/// Up to which share of what its surroundings would give, if they filled the receiver's view, one light point may give.
/// chosen: 25 % of 2 to 100 % (2 radii of a point's disc): discs follow the local density of light, unlike the bound of
/// [Render2MPEG, 6.5] (docs/model/clamping.md).
constexpr GeometryClamp point_clamp{0.25f};

/// Light trees are rebuilt at most every 15 frames of a chunk. chosen: half a second, for which what fits badly may
/// last; representatives never change from frame to frame.
constexpr std::int64_t rebuild_interval = 15;

}  // namespace

FilmLights::FilmLights(PosedScene& posed_scene, const Plan& plan, const Settings& settings, Statistics& statistics,
                       PassTimes& times)
    : posed_scene_(posed_scene),
      plan_(plan),
      settings_(settings),
      statistics_(statistics),
      times_(times),
      light_points_(posed_scene, plan, settings.direct_points, settings.seed) {}

FilmLights::FilmLights(const FilmLights& prepared, PosedScene& posed_scene, const Plan& plan, const Settings& settings,
                       Statistics& statistics, PassTimes& times)
    : posed_scene_(posed_scene),
      plan_(plan),
      settings_(settings),
      statistics_(statistics),
      times_(times),
      light_points_(prepared.light_points_) {}

void FilmLights::prepare(const scene::Snapshot& instant) {
    {
        const Stopwatch timer(times_[Pass::sky_light]);
        statistics_.photon_rays += light_points_.look_at_sky(posed_scene_);
    }
    {
        const Stopwatch timer(times_[Pass::pose]);
        posed_scene_.pose(instant);
    }
}

void FilmLights::start_chunk(const scene::Snapshot& first) {
    first_frame_ = first.frame;
    prepare(first);
    {
        const Stopwatch timer(times_[Pass::emissive_lights]);
        light_points_.place(posed_scene_, first);
    }
    if (plan_.runs(Pass::photons) && settings_.vpls > 0 && !by_rays()) {
        const Stopwatch timer(times_[Pass::photons]);
        paths_ = virtual_light_paths(posed_scene_, light_points_.average(), settings_.vpls, settings_.bounces);
    }
    const Stopwatch timer(times_[Pass::direct_tree]);
    if (plan_.runs(Pass::area_lamps)) lamps_ = AreaLamps(posed_scene_, light_points_.average());
    // Light trees take two seeds, one for direct light and the next for indirect light.
    persistent_trees_ = PersistentLightTrees(clustered(light_points_.average()), settings_.seed + 2 * settings_.draw);
    shone_at_.reset();
}

bool FilmLights::update(const scene::Snapshot& snapshot) {
    if (!shine(snapshot, shone_at_ ? change_between(*shone_at_, snapshot) : LightChange{true, true})) return false;
    build_trees(snapshot);
    return true;
}

/// Lets the lights of the posed snapshot shine, and what light bounces off with them. Nothing is done, and false
/// returned, where nothing that light touches has changed since the last time, nor a cut the near field of the view.
bool FilmLights::shine(const scene::Snapshot& snapshot, const LightChange& change) {
    const bool is_same = change.none();
    if (is_same && !(by_rays() && snapshot.cut_before)) return false;
    std::vector<LightPoint> points;
    {
        const Stopwatch timer(times_[Pass::emissive_lights]);
        points = light_points_.at(posed_scene_);
    }
    const NearField near_field = by_rays() ? near_field_of(snapshot, points, change) : NearField();
    if (is_same && near_field == sky_of_rays_.near_field) return false;
    shining_ = std::move(points);
    shone_at_ = snapshot;
    const Stopwatch timer(times_[by_rays() ? Pass::indirect_tree : Pass::photons]);
    sky_of_rays_ = {brightest_of_rays(posed_scene_.sky()),
                    light_points_.sky_part() * lobe::inverse_pi / lobe::lobe_rays_disc2,
                    light_points_.sky_importance()};
    if (plan_.runs(Pass::lobe_rays)) {
        sky_of_rays_.shining.assign(posed_scene_.animation().objects.size(), 0.0f);
        for (const LightPoint& p : lamps_.without(shining_))
            if (p.is_of_surface()) sky_of_rays_.shining[p.object] = core::luminance(p.intensity) * lobe::inverse_pi;
    }
    if (by_rays()) {
        sky_of_rays_.near_field = near_field;
        indirect_ = near_light(posed_scene_, shining_, light_points_.average(), near_field, statistics_.photon_rays);
    }
    if (paths_ == 0) return true;
    PhotonResult photons =
        virtual_lights(posed_scene_, {shining_, light_points_.average()}, {settings_.vpls, settings_.bounces, paths_});
    statistics_.photon_rays += photons.rays;
    statistics_.photon_energy += photons.landed;
    statistics_.photon_energy_lost += photons.lost;
    indirect_ = std::move(photons.vpls);
    return true;
}

/// Near field of the view, kept while view and sources stay.
NearField FilmLights::near_field_of(const scene::Snapshot& snapshot, std::span<const LightPoint> lights,
                                    const LightChange& change) const {
    if (!snapshot.cut_before && !change.sources) return sky_of_rays_.near_field;
    return NearField(lights, sample_view(posed_scene_, plan_, snapshot.camera));
}

/// Light points that trees hold: all but those of area lamps, and of the sky that gather rays see.
std::vector<LightPoint> FilmLights::clustered(std::vector<LightPoint> points) const {
    points = lamps_.without(std::move(points));
    return by_rays() ? beyond_rays(std::move(points), brightest_of_rays(posed_scene_.sky())) : points;
}

void FilmLights::build_trees(const scene::Snapshot& snapshot) {
    statistics_.direct_points = shining_.size();
    statistics_.indirect_points = indirect_.size();
    {
        const Stopwatch timer(times_[Pass::direct_tree]);
        trees_ = {};  // before the next ones grow: many light points take as much memory
        trees_ = persistent_trees_.at(clustered(std::exchange(shining_, {})),
                                      (snapshot.frame - first_frame_) % rebuild_interval == 0);
        trees_.lamps = lamps_.at(posed_scene_);
    }
    {
        const Stopwatch timer(times_[by_rays() ? Pass::indirect_tree : Pass::photons]);
        const auto of_movers = std::stable_partition(indirect_.begin(), indirect_.end(), [&](const LightPoint& p) {
            return by_rays() || posed_scene_.animation().objects[p.object].mobility == scene::Mobility::still;
        });
        const std::uint64_t seed = settings_.seed + 2 * settings_.draw + 1;
        trees_.trees[LightTrees::static_tree] =
            build_light_tree(LightType::oriented, {indirect_.begin(), of_movers}, seed);
        trees_.trees[LightTrees::dynamic_tree] =
            build_light_tree(LightType::oriented, {of_movers, indirect_.end()}, seed);
    }
    trees_.point_clamp = settings_.clamp == Clamp::bounded ? point_clamp : GeometryClamp::none();
    trees_.lobe_rays = plan_.runs(Pass::lobe_rays);
    trees_.bodies = plan_.runs(Pass::caustics) ? Bodies::block : Bodies::pass;
    trees_.air = posed_scene_.air();
    trees_.translucent = plan_.runs(Pass::alpha) || plan_.runs(Pass::glass) || trees_.air != nullptr;
    lit_frame_ = snapshot.frame;
}

}  // namespace render2mpeg::renderer
