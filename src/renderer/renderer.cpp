#include "renderer/renderer.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "core/error.h"
#include "core/numeric.h"
#include "renderer/air/airlight.h"
#include "renderer/base/lobe.h"
#include "renderer/base/stopwatch.h"
#include "renderer/cache/irradiance_cache.h"
#include "renderer/calibration/audit.h"
#include "renderer/calibration/calibration.h"
#include "renderer/caustics/caustics.h"
#include "renderer/cut/blurred_light.h"
#include "renderer/cut/shade.h"
#include "renderer/draft/draft_light.h"
#include "renderer/frame_statistics.h"
#include "renderer/gather/final_gather.h"
#include "renderer/gather/frame_rays.h"
#include "renderer/gather/near_light.h"
#include "renderer/hair/hair_light.h"
#include "renderer/judge.h"
#include "renderer/lights/anchors.h"
#include "renderer/lights/light_points.h"
#include "renderer/lights/whole_lamps.h"
#include "renderer/tree/light_trees.h"
#include "renderer/truth/true_frame.h"
#include "renderer/view/expose.h"
#include "renderer/view/look_closer.h"
#include "renderer/view/see.h"
#include "scene/preparation/traits.h"

namespace render2mpeg::renderer {
namespace {

/// Up to which share of what its surroundings would give, if they filled the receiver's view, one light point may give.
/// chosen: 25 % of 2 to 100 % (2 radii of a point's disc) for anchors and points of emissive surfaces, which lie in
/// even strata; [Render2MPEG, 6.5]'s 2 % is for VPLs at random places (docs/model/clamping.md).
constexpr GeometryClamp point_clamp{0.25f};

/// Light trees may be planned anew at every so manieth frame of a chunk. chosen: 15, half a second: what fits badly
/// does not do so for long, and representatives never change from frame to frame.
constexpr std::int64_t rebuild_interval = 15;

/// Whether light may change, of things whose boxes are known: strands are wider than their points.
bool keeps_rays(const scene::Animation& film) {
    return scene::traits_of(film).changes_light() &&
           std::none_of(film.meshes.begin(), film.meshes.end(), [](const scene::Mesh& m) { return m.has_curves(); });
}

}  // namespace

struct Renderer::Impl {
    Impl(const scene::Animation& film, const Settings& s, const Plan& p)
        : settings(s),
          plan(p),
          posed_scene(film, s.isa, p),
          light_points(posed_scene, p, (p.runs(Pass::sky_light) ? 2 : 1) * s.direct_points, s.seed),
          thrown({s.caustic_photons}),
          final_gather(posed_scene, plan, keeps_rays(film)),
          hair_light(posed_scene, plan) {
        statistics.image_notes = posed_scene.notes();
        if (by_rays()) rays_of.push_back(RaysOf::hemispheres);
        if (plan.runs(Pass::lobe_rays)) rays_of.push_back(RaysOf::lobes);
    }

    double& row(Pass pass) { return rows[static_cast<std::size_t>(pass)]; }
    void pose(const scene::Snapshot& snapshot) {
        const Stopwatch timer(row(Pass::pose));
        posed_scene.pose(snapshot);
    }

    void start_chunk(const scene::Snapshot& first) {
        first_frame = first.frame;
        {
            const Stopwatch timer(row(Pass::sky_light));
            statistics.photon_rays += light_points.look_at_sky(posed_scene);
        }
        pose(first);
        if (!anchors && plan.runs(Pass::photons) && settings.vpls > 0 && !by_rays()) {
            const Stopwatch timer(row(Pass::photons));
            anchors.emplace(posed_scene, light_points,
                            AnchorSettings{settings.vpls, settings.bounces, settings.photons});
            statistics.photon_rays += anchors->rays();
        }
        {
            const Stopwatch timer(row(Pass::emissive_lights));
            light_points.place(posed_scene, first);
        }
        {
            const Stopwatch timer(row(Pass::direct_tree));
            const auto still = anchors ? anchors->average_still() : std::vector<LightPoint>();
            const auto moving = anchors ? anchors->average_moving() : std::vector<LightPoint>();
            // Light trees take two seeds, one for direct light and the next for indirect light.
            if (plan.runs(Pass::whole_lamps)) lamps = WholeLamps(posed_scene, light_points.average());
            lasting = PersistentLightTrees({clustered(light_points.average()), still, moving},
                                           settings.seed + 2 * settings.draw);
            caches = settings.cache != CacheUse::off && (by_rays() || settings.cache == CacheUse::on ||
                                                         !scene::traits_of(posed_scene.animation()).changes_light());
        }
        shone_at.reset();
        thrown.forget();
        lit_frame.reset();
        ambient_air = {};
        cache.forget();
        calibration.forget();
        draft_light.forget();
        final_gather.start_chunk();
        started = true;
    }

    /// Lets the lights of the posed snapshot shine, and what light bounces off with them; nothing is done where nothing
    /// that light touches has changed since the last time, nor a cut the near field of what is seen.
    void shine(const scene::Snapshot& snapshot) {
        change = shone_at ? change_between(*shone_at, snapshot) : LightChange::everything();
        const bool is_same = change.none();
        if (is_same && !(by_rays() && snapshot.cut_before)) return;
        std::vector<LightPoint> points;
        {
            const Stopwatch timer(row(Pass::emissive_lights));
            points = light_points.at(posed_scene);
        }
        const NearField near_field = by_rays() ? near_field_of(snapshot, points) : NearField();
        if (is_same && near_field == rays_see.near_field) return;
        shining = std::move(points);
        shone_at = snapshot;
        has_trees = false;
        const Stopwatch timer(row(by_rays() ? Pass::indirect_tree : Pass::photons));
        rays_see = {brightest_of_rays(posed_scene.sky()),
                    light_points.sky_part() * lobe::inverse_pi / lobe::lobe_rays_disc2, light_points.sky_importance()};
        if (by_rays()) {
            rays_see.near_field = near_field;
            lit_anchors.still =
                near_light(posed_scene, shining, light_points.average(), rays_see.near_field, statistics.photon_rays);
        }
        if (!anchors) return;
        lit_anchors = anchors->at(posed_scene, shining);
        statistics.photon_rays += lit_anchors.rays;
        statistics.photon_energy += lit_anchors.landed;
        statistics.photon_energy_lost += lit_anchors.lost;
    }

    /// It stays where sources do, as long as the view does.
    NearField near_field_of(const scene::Snapshot& snapshot, std::span<const LightPoint> lights) const {
        if (!snapshot.cut_before && !change.changes_sources(posed_scene.animation())) return rays_see.near_field;
        return NearField(
            lights, look_about(posed_scene, plan, snapshot.camera, {settings.format.width, settings.format.height}));
    }

    bool by_rays() const { return settings.indirect == Indirect::rays && settings.vpls > 0; }
    /// Light points that trees hold: all but lamps that are lit by as a whole, and but for what gather rays see of the
    /// sky.
    std::vector<LightPoint> clustered(std::vector<LightPoint> points) const {
        points = lamps.without(std::move(points));
        return by_rays() ? beyond_rays(std::move(points), brightest_of_rays(posed_scene.sky())) : points;
    }

    SeeSettings see_settings() const {
        return {settings.format,         settings.samples, settings.edge_samples,
                settings.specular_depth, settings.mattes,  settings.transparent};
    }

    /// Light trees of the posed snapshot.
    void update_light(const scene::Snapshot& snapshot) {
        shine(snapshot);
        if (has_trees) return;
        statistics.direct_points = shining.size();
        statistics.indirect_points = lit_anchors.still.size() + lit_anchors.moving.size();
        {
            const Stopwatch timer(row(Pass::direct_tree));
            light_trees = {};  // before the next one grows: many light points take as much memory
            light_trees = lasting.at({clustered(std::exchange(shining, {})), lit_anchors.still, lit_anchors.moving},
                                     (snapshot.frame - first_frame) % rebuild_interval == 0);
            light_trees.lamps = lamps.at(posed_scene);
            if (by_rays())
                light_trees.trees[LightTrees::static_tree] =
                    build_light_tree(LightType::oriented, lit_anchors.still, settings.seed + 2 * settings.draw + 1);
        }
        light_trees.point_clamp = settings.clamp == Clamp::bounded ? point_clamp : GeometryClamp::none();
        light_trees.lobe_rays = plan.runs(Pass::lobe_rays);
        light_trees.bodies = plan.runs(Pass::caustics) ? Bodies::block : Bodies::pass;
        light_trees.air = posed_scene.air();
        light_trees.translucent = plan.runs(Pass::alpha) || plan.runs(Pass::glass) || light_trees.air != nullptr;
        carry_light();
        lit_frame = snapshot.frame;
        has_trees = true;
    }

    /// Takes light that was gathered over to the posed instant, as far as it still holds.
    void carry_light() {
        if (lit_frame && caches && by_rays()) {
            cache.renew(change, light_trees, posed_scene.tracer(), shade_settings().limits, rays_see, final_gather);
        } else {
            if (lit_frame) cache.invalidate();
            if (!rays_of.empty()) final_gather.forget(rays_see);
        }
    }

    /// Parts the time of gathering among the rows of the plan that it serves, by clusters.
    void share_time(double seconds, const ShadeCounts& counts) {
        const double all = final_gather.counts().seconds, gathering = all - std::exchange(shared_seconds, all);
        const auto direct = static_cast<double>(counts.direct_clusters);
        const double clusters = direct + static_cast<double>(counts.indirect_clusters);
        const double direct_seconds = core::divide_or(direct, clusters, 1.0) * (seconds - gathering);
        row(plan.runs(Pass::direct_tree) ? Pass::direct_tree : Pass::punctual_lights) += direct_seconds;
        row(Pass::indirect_tree) += seconds - direct_seconds;
    }

    /// Poses and lights the snapshot; returns when gathering starts.
    double prepare(const scene::Snapshot& snapshot, const Seen& seen) {
        EXPECTS(seen.visible.frame == snapshot.frame);
        if (!started) start_chunk(snapshot);
        pose(snapshot);
        update_light(snapshot);
        counted_rays = gathered_rays();
        shared_seconds = final_gather.counts().seconds;
        return cpu_seconds();
    }

    std::uint64_t gathered_rays() const { return final_gather.counts().rays + final_gather.counts().cell_rays; }

    /// Gathers by rays for measurements, which teach the frames' own gathering nothing.
    std::unique_ptr<FinalGather> audit_rays() const {
        auto rays = !rays_of.empty() ? std::make_unique<FinalGather>(posed_scene, plan, false) : nullptr;
        if (rays) rays->forget(rays_see);
        return rays;
    }

    /// Poses and lights the snapshot for measurements, which count nowhere.
    void light_unseen(const scene::Snapshot& snapshot) {
        pose(snapshot);
        const Statistics before = statistics;
        update_light(snapshot);
        statistics = before;
    }

    /// Light of all points of a frame, by light trees and rays.
    core::Radiance gather(const scene::Snapshot& snapshot, const Seen& seen, const core::ToleranceMap& tolerance,
                          const ShadeSettings& s, ShadeCounts& counts, FrameLight& light) {
        const glm::vec3 eye = snapshot.camera.position();
        const RayTracer& tracer = posed_scene.tracer();
        core::Radiance radiance =
            renderer::shade(light_trees, tracer, seen, eye, tolerance, s, counts, nullptr, &light);
        if (rays_of.empty()) return radiance;
        if (!caches) final_gather.forget(rays_see);
        for (const RaysOf which : rays_of) add_rays(final_gather, snapshot.camera, seen, tolerance, which, light);
        ShadeCounts again;
        return renderer::shade(light_trees, tracer, seen, eye, tolerance, s, again, &light);
    }

    ShadeSettings shade_settings() const {
        return {{settings.min_cut, settings.max_cut, 1.0f}, plan.runs(Pass::layers)};
    }

    /// What the middle of a frame shows, whose pixels are the sum of their own points: another picture than `shown`
    /// where it is exposed.
    const core::Radiance& middle_of(const Seen& seen, const core::Radiance& shown) const {
        return seen.exposure && sharp.frame == seen.visible.frame && !sharp.combined.empty() ? sharp : shown;
    }

    /// Adds a frame to the statistics.
    void count(const ShadeCounts& counts, const core::Visible& visible) {
        add(counts, visible, statistics);
        statistics.gather_rays += gathered_rays() - counted_rays;
        counted_rays = gathered_rays();
    }

    Settings settings;
    Plan plan;
    PosedScene posed_scene;
    LightPoints light_points;
    std::optional<Anchors> anchors;  ///< of the film
    WholeLamps lamps;                ///< of the film
    PersistentLightTrees lasting;    ///< of the chunk
    LightTrees light_trees;
    bool caches = false;          ///< light is cached
    std::vector<RaysOf> rays_of;  ///< that see what light trees do not hold
    SkyOfRays rays_see;
    std::optional<scene::Snapshot> shone_at;  ///< the instant that the following are of
    std::vector<LightPoint> shining;          ///< direct light points, until trees take them
    Anchors::Lit lit_anchors;                 ///< or light of the near field
    Caustics thrown;                          ///< how many photons a frame of the chunk has
    bool has_trees = false;                   ///< `light_trees` are of that instant, too
    std::optional<std::int64_t> lit_frame;    ///< the first frame that `light_trees` are of
    LightChange change;                       ///< since the instant that was lit before
    bool started = false;
    std::int64_t first_frame = 0;  ///< of the chunk
    FilmCalibration calibration;
    IrradianceCache cache;
    DraftLight draft_light;
    FrameLight light;  ///< of the points of the frame shaded last
    AmbientAir ambient_air;
    FinalGather final_gather;
    HairLight hair_light;
    double shared_seconds = 0;       ///< of gathering by rays, that rows have already
    std::uint64_t counted_rays = 0;  ///< of all, that statistics have, or that count nowhere
    core::Radiance sharp;  ///< of the last frame that was exposed: its middle, whose points and pixels are audited
    Statistics statistics;
    std::array<double, static_cast<std::size_t>(Pass::count)> rows{};
};

Renderer::Renderer(const scene::Animation& animation, const Settings& settings, const Plan& plan)
    : impl_(std::make_unique<Impl>(animation, settings, plan)) {}
Renderer::~Renderer() = default;

void Renderer::start_chunk(const scene::Snapshot& first) {
    impl_->start_chunk(first);
}

Seen Renderer::see(const scene::Snapshot& snapshot) {
    impl_->pose(snapshot);
    const Stopwatch timer(impl_->row(Pass::see));
    SeeCounts counts;
    Seen seen = renderer::see(impl_->posed_scene, impl_->see_settings(), impl_->plan, counts);
    add(counts, impl_->statistics);
    return seen;
}

Seen Renderer::complete(const scene::Snapshot& snapshot, Seen seen, const core::ToleranceMap* tolerance,
                        const ExposureSamples* samples) {
    Impl& i = *impl_;
    if (!i.started) i.start_chunk(snapshot);
    i.pose(snapshot);
    Statistics& all = i.statistics;
    if (tolerance != nullptr && i.settings.most_samples > 0) {
        const Stopwatch timer(i.row(Pass::see));
        SeeCounts counts;
        look_closer(i.posed_scene, i.see_settings(), i.plan, *tolerance, i.settings.most_samples, seen, counts);
        add(counts, all);
    }
    if (samples != nullptr && (i.plan.runs(Pass::shutter) || i.plan.runs(Pass::lens))) {
        const Stopwatch timer(i.row(i.plan.runs(Pass::lens) ? Pass::lens : Pass::shutter));
        ExposureCounts counts;
        expose(i.posed_scene, i.see_settings(), i.plan, *samples, seen, counts);
        all.exposure_rays += counts.rays;
        all.exposed_pixels += counts.pixels;
    }
    if (i.plan.runs(Pass::caustics)) {
        const Stopwatch timer(i.row(Pass::caustics));
        CausticCounts counts;
        i.thrown.add(i.posed_scene, i.light_points.at(i.posed_scene), tolerance, seen, counts);
        if (tolerance != nullptr) add(counts, all);
    }
    if (!seen.fibres.empty()) {
        const Stopwatch timer(i.row(i.plan.runs(Pass::hair) ? Pass::hair : Pass::subsurface));
        i.hair_light.add_to(seen, tolerance, all.hair);
    }
    if (i.plan.runs(Pass::air)) {
        i.prepare(snapshot, seen);
        const Stopwatch timer(i.row(Pass::air));
        all.air_rays += add_airlight({i.posed_scene, i.light_points.at(i.posed_scene), i.light_trees,
                                      i.by_rays() ? &i.final_gather : nullptr, *i.lit_frame},
                                     i.ambient_air, tolerance, seen);
    }
    return seen;
}

core::Radiance Renderer::shade(const scene::Snapshot& snapshot, const Seen& seen, const core::ToleranceMap& wanted) {
    Impl& i = *impl_;
    // Update the lights,
    const double start = i.prepare(snapshot, seen);
    const core::ToleranceMap tolerance = tolerance_of_points(seen, wanted);
    ShadeSettings settings = i.shade_settings();
    // learn how far cuts err,
    const bool learns = i.settings.calibrate && !tolerance.is_reference();
    if (learns) {
        const Stopwatch timer(i.statistics.calibration_seconds);
        i.statistics.calibrated_pixels += i.calibration.before(snapshot, *i.lit_frame, i.light_trees,
                                                               i.posed_scene.tracer(), seen, tolerance, settings);
    }
    settings.limits.error_scale = learns ? i.calibration.value() : 1.0f;
    // ask the cache, which gathers what it does not know,
    ShadeCounts counts;
    std::optional<FrameLight> cached;
    if (i.caches && !tolerance.is_reference())
        cached = i.cache.light({i.light_trees, i.posed_scene.tracer(), seen, snapshot.camera.position(), tolerance},
                               snapshot, settings.limits, i.by_rays() ? &i.final_gather : nullptr, counts,
                               i.statistics.cache);
    if (cached && i.plan.runs(Pass::lobe_rays))
        add_rays(i.final_gather, snapshot.camera, seen, tolerance, RaysOf::lobes, *cached);
    const FrameLight* known = cached ? &*cached : nullptr;
    // else gather all; sum up in pixels,
    core::Radiance radiance =
        known != nullptr ? renderer::shade(i.light_trees, i.posed_scene.tracer(), seen, snapshot.camera.position(),
                                           tolerance, settings, counts, known, &i.light)
                         : i.gather(snapshot, seen, tolerance, settings, counts, i.light);
    if (cached && settings.layers) radiance.record_density = i.cache.density(snapshot.camera, i.settings.format);
    // and learn from the frame, if it has light of trees alone.
    i.count(counts, seen.visible);
    if (learns) add_error_scale(settings.limits.error_scale, i.statistics);
    if (learns && !i.by_rays()) {
        const Stopwatch timer(i.statistics.calibration_seconds);
        i.statistics.calibrated_pixels +=
            i.calibration.after(snapshot, *i.lit_frame, i.light_trees, i.posed_scene.tracer(), seen, tolerance,
                                settings, radiance, counts.shadow_rays, known);
    }
    if (seen.exposure) {
        ShadeCounts blurred;
        i.sharp = radiance;
        spread_light(seen, i.light, settings.layers, radiance, blurred);
        i.count(blurred, seen.visible);
    }
    i.share_time(cpu_seconds() - start, counts);
    i.statistics.layer_seconds = i.posed_scene.layer_seconds();
    return radiance;
}

core::Radiance Renderer::trace(const scene::Snapshot& snapshot, const Seen& seen, const TruthSettings& finely) {
    Impl& i = *impl_;
    if (!i.started) i.start_chunk(snapshot);
    i.pose(snapshot);
    const double start = cpu_seconds();
    TrueFrame truth = true_frame(i.posed_scene, i.see_settings(), i.plan, light_of_bodies_and_air(seen), finely);
    i.statistics.true_paths += truth.paths;
    i.statistics.true_pixels += truth.radiance.combined.size();
    i.statistics.capped_pixels += truth.capped;
    i.share_time(cpu_seconds() - start, {});
    return std::move(truth.radiance);
}

core::Radiance Renderer::sketch(const scene::Snapshot& snapshot, const Seen& seen,
                                const core::ToleranceMap& tolerance) {
    Impl& i = *impl_;
    const double start = i.prepare(snapshot, seen);
    ShadeCounts counts;
    FrameLight light;
    const ShadeSettings settings = i.shade_settings();
    core::Radiance radiance = i.gather(snapshot, seen, tolerance_of_points(seen, tolerance), settings, counts, light);
    if (seen.exposure) spread_light(seen, light, settings.layers, radiance, counts);
    i.share_time(cpu_seconds() - start, counts);
    return radiance;
}

core::Radiance Renderer::draft(const scene::Snapshot& snapshot, const Seen& seen, const core::ToleranceMap& tolerance,
                               const core::MotionField* motion) {
    Impl& i = *impl_;
    const double start = i.prepare(snapshot, seen);
    if (snapshot.cut_before) i.draft_light.forget();
    ShadeCounts counts;
    const glm::vec3 eye = snapshot.camera.position();
    const ShadeSettings settings = i.shade_settings();
    FrameLight light = i.draft_light.light({i.light_trees, i.posed_scene.tracer(), seen, eye, tolerance, motion},
                                           settings.limits, counts);
    if (i.plan.runs(Pass::lobe_rays)) add_rays(i.final_gather, snapshot.camera, seen, tolerance, RaysOf::lobes, light);
    core::Radiance radiance =
        renderer::shade(i.light_trees, i.posed_scene.tracer(), seen, eye, tolerance, settings, counts, &light);
    i.count(counts, seen.visible);
    i.share_time(cpu_seconds() - start, counts);
    return radiance;
}

std::vector<AuditedPixel> Renderer::audit(const scene::Snapshot& snapshot, const Seen& seen,
                                          const core::ToleranceMap& wanted, const core::Radiance& shown, int count) {
    EXPECTS(seen.visible.frame == snapshot.frame && shown.frame == snapshot.frame);
    if (count <= 0) return {};
    Impl& i = *impl_;
    const core::ToleranceMap tolerance = tolerance_of_points(seen, wanted);
    const core::Radiance& radiance = i.middle_of(seen, shown);
    i.light_unseen(snapshot);
    const std::vector<LitPixel> pixels = drawn(lit_pixels(seen), static_cast<std::size_t>(count), seen.visible.frame);
    const MovedPoints moved = i.cache.moved_points(snapshot.frame, tolerance);
    const auto rays = i.audit_rays();
    const LitFrame frame{i.posed_scene, i.light_trees, rays.get(), i.rays_of, seen, tolerance, radiance, moved};
    return compare(seen, pixels, exact_pixels(frame, pixels, moved), tolerance, radiance);
}

std::vector<JudgedPixel> Renderer::judge(const scene::Snapshot& snapshot, const Seen& seen,
                                         const core::ToleranceMap& wanted, const core::Radiance& shown,
                                         std::span<const AuditedPixel> audited, const TruthSettings& finely) {
    EXPECTS(seen.visible.frame == snapshot.frame && shown.frame == snapshot.frame);
    Impl& i = *impl_;
    const core::ToleranceMap tolerance = tolerance_of_points(seen, wanted);
    const core::Radiance& radiance = i.middle_of(seen, shown);
    i.light_unseen(snapshot);
    const MovedPoints moved = i.cache.moved_points(snapshot.frame, tolerance);
    const auto rays = i.audit_rays();
    const LitFrame frame{i.posed_scene, i.light_trees, rays.get(), i.rays_of, seen, tolerance, radiance, moved};
    return judge_pixels(frame, i.see_settings(), i.plan, audited, finely);
}

const RayTracer& Renderer::tracer() const {
    return impl_->posed_scene.tracer();
}

const Statistics& Renderer::statistics() const {
    return impl_->statistics;
}

double Renderer::seconds(Pass pass) const {
    return impl_->row(pass);
}

}  // namespace render2mpeg::renderer
