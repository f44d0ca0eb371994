#include "renderer/renderer.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "core/error.h"
#include "core/numeric.h"
#include "parallel/lanes.h"
#include "renderer/air/airlight.h"
#include "renderer/air/fog_lighting.h"
#include "renderer/air/volume_lighting.h"
#include "renderer/calibration/audit.h"
#include "renderer/chunk_memory.h"
#include "renderer/cut/blurred_light.h"
#include "renderer/draft/rough_light.h"
#include "renderer/film_lights.h"
#include "renderer/gather/final_gather.h"
#include "renderer/gather/frame_rays.h"
#include "renderer/hair/hair_light.h"
#include "renderer/truth/true_frame.h"
#include "renderer/validation.h"
#include "renderer/view/expose.h"
#include "renderer/view/refine_edges.h"
#include "renderer/view/see.h"
#include "scene/preparation/traits.h"

namespace render2mpeg::renderer {

struct Renderer::Impl {
    Impl(const scene::Animation& film, const Settings& s, const Plan& p, TextureStore* store)
        : settings(s),
          plan(p),
          posed_scene(film, s.isa, p, store),
          lights(posed_scene, plan, settings, statistics, times),
          memory{.caustics = Caustics({s.caustic_photons, plan.rays_see_sky_in_panes()})},
          final_gather(posed_scene, plan),
          hair_light(posed_scene, plan, final_gather.cache()) {}
    /// Beside `prepared`.
    explicit Impl(const Impl& prepared)
        : settings(prepared.settings),
          plan(prepared.plan),
          posed_scene(prepared.posed_scene),
          lights(prepared.lights, posed_scene, plan, settings, statistics, times),
          memory{.caustics = Caustics({settings.caustic_photons, plan.rays_see_sky_in_panes()})},
          final_gather(posed_scene, plan),
          hair_light(posed_scene, plan, final_gather.cache()) {}

    void pose(const scene::Snapshot& snapshot) {
        if (!started) start_chunk(snapshot);
        const Stopwatch timer(times[Pass::pose]);
        posed_scene.pose(snapshot);
        statistics.image_notes = posed_scene.notes();
    }
    void start_chunk(const scene::Snapshot& first) {
        started = true;
        lights.start_chunk(first);
        caches = settings.cache != CacheUse::off && (lights.by_rays() || settings.cache == CacheUse::on ||
                                                     !scene::traits_of(posed_scene.animation()).changes_light());
        forget(memory);
        air_lit_at = -1;
    }

    SeeSettings see_settings() const {
        return {settings.format,         settings.samples, settings.edge_samples,
                settings.specular_depth, settings.mattes,  settings.transparent};
    }

    /// Of the posed snapshot. Where they are others, gathered light is told.
    void update_lights(const scene::Snapshot& snapshot) {
        if (lights.update(snapshot)) {
            memory.records.light_changes();
            if (rays_of || plan.runs(Pass::hair) || plan.runs(Pass::subsurface)) forget_cells();
        }
        light_air();
    }

    void forget_cells() { final_gather.forget(lights.sky_of_rays()); }
    /// Parts the time of gathering among the rows of the plan that it serves, by clusters.
    void share_time(double seconds, const ShadeCounts& counts) {
        const double all = final_gather.counts().seconds, gathering = all - std::exchange(shared_seconds, all);
        const auto direct = static_cast<double>(counts.direct_clusters);
        const double clusters = direct + static_cast<double>(counts.indirect_clusters);
        const double direct_seconds = core::divide_or(direct, clusters, 1.0) * (seconds - gathering);
        times[plan.runs(Pass::direct_tree) ? Pass::direct_tree : Pass::punctual_lights] += direct_seconds;
        times[Pass::indirect_tree] += seconds - direct_seconds;
    }

    template <class A>
    void keep(A& a) {
        a(memory, final_gather.cache());
    }

    std::uint64_t gathered_rays() const { return final_gather.counts().rays + final_gather.counts().cell_rays; }
    CutLimits cut_limits() const { return {settings.min_cut, settings.max_cut, 1.0f}; }
    LightingContext context_of(const scene::Snapshot& snapshot, const Frame& frame, const UngatheredLight& ungathered,
                               const core::ToleranceMap& tolerance) {
        return {lights.trees(), posed_scene.tracer(), frame, ungathered, snapshot.camera.position(), tolerance};
    }

    AirInstant air_instant() {
        FinalGather* gather = lights.by_rays() ? &final_gather : nullptr;
        return {posed_scene, lights.points(),    lights.trees(),
                gather,      lights.lit_frame(), plan.runs(Pass::indirect_tree)};
    }

    /// Adds a frame to the statistics.
    void count(const ShadeCounts& counts, const core::Visible& visible) {
        add(counts, visible, statistics);
        statistics.gather_rays += gathered_rays() - counted_rays;
        counted_rays = gathered_rays();
    }

    Frame refined(const scene::Snapshot& snapshot, Frame frame, const core::ToleranceMap& tolerance);
    Frame exposed(Frame frame, const ExposureSamples& samples);
    void add_effects(const scene::Snapshot& snapshot, const core::ToleranceMap* tolerance, PlacedFrame& placed);
    void light_air();
    FrameLight gather_film(const scene::Snapshot& snapshot, const LightingContext& context, bool learns,
                           CutLimits& limits, ShadeCounts& counts);
    FrameLight gather_all(const scene::Snapshot& snapshot, const LightingContext& context, const CutLimits& limits,
                          ShadeCounts& counts);
    core::Radiance gather_sparse(const scene::Snapshot& snapshot, const LightingContext& context, ShadeCounts& counts);
    FrameLight gather_draft(const scene::Snapshot& snapshot, const LightingContext& context,
                            const core::MotionField* to_before, ShadeCounts& counts);
    void learn(const scene::Snapshot& snapshot, const LightingContext& context, float error_scale,
               const FrameLight& light, const core::Radiance& radiance, std::uint64_t rays);
    core::Radiance trace(const UngatheredLight& ungathered, const TruthSettings& finely);
    template <class Use>
    auto audited(const scene::Snapshot& snapshot, const Lit& lit, const core::ToleranceMap& wanted, Use use);

    Settings settings;  ///< constant but for their format
    const Plan plan;
    Statistics statistics;
    PassTimes times;
    PosedScene posed_scene;
    FilmLights lights;
    /// That see light missing in light trees.
    std::optional<RaysOf> rays_of = missing_light(lights.by_rays(), plan.runs(Pass::lobe_rays));
    bool started = false;
    bool caches = false;  ///< light is cached in this chunk
    ChunkMemory memory;
    std::int64_t air_lit_at = -1;  ///< FilmLights::lit_frame
    FinalGather final_gather;
    HairLight hair_light;
    double shared_seconds = 0;         ///< of gathering by rays, that rows have already
    std::uint64_t counted_rays = 0;    ///< of all, that statistics have, or that count nowhere
    double earlier_layer_seconds = 0;  ///< before statistics began
};

/// Finer edges, where the tolerance shows them.
Frame Renderer::Impl::refined(const scene::Snapshot& snapshot, Frame frame, const core::ToleranceMap& tolerance) {
    if (settings.most_samples <= 0) return frame;
    Strands strands;
    const SeeSettings seeing = see_settings();
    if (plan.runs(Pass::hair) && !tolerance.is_reference() &&
        settings.most_samples > std::max(seeing.samples, seeing.edge_samples)) {
        update_lights(snapshot);
        const Stopwatch timer(times[Pass::hair]);
        HairCounts counts;
        strands = hair_light.look_at_strands(frame, seeing.samples, counts);
        statistics.hair.rays += counts.rays;
    }
    const Stopwatch timer(times[Pass::see]);
    SeeCounts counts;
    frame =
        refine_edges(posed_scene, seeing, plan, tolerance, strands, settings.most_samples, std::move(frame), counts);
    add(counts, statistics);
    return frame;
}

Frame Renderer::Impl::exposed(Frame frame, const ExposureSamples& samples) {
    if (!plan.runs(Pass::shutter) && !plan.runs(Pass::lens)) return frame;
    const Stopwatch timer(times[plan.runs(Pass::lens) ? Pass::lens : Pass::shutter]);
    ExposureCounts counts;
    frame = expose(posed_scene, see_settings(), plan, samples, std::move(frame), counts);
    statistics.exposure_rays += counts.rays;
    statistics.exposed_pixels += counts.pixels;
    return frame;
}

/// Each effect finds its light by itself, and adds it up. `tolerance`: null for a rough look.
void Renderer::Impl::add_effects(const scene::Snapshot& snapshot, const core::ToleranceMap* tolerance,
                                 PlacedFrame& placed) {
    auto& [frame, sum] = placed;
    if (plan.runs(Pass::caustics)) {
        const Stopwatch timer(times[Pass::caustics]);
        CausticCounts counts;
        memory.caustics.add(posed_scene, lights.points(), tolerance, frame, sum, counts);
        if (tolerance != nullptr) add(counts, statistics);
    }
    if (!frame.fibres.empty()) {
        update_lights(snapshot);
        const Stopwatch timer(times[plan.runs(Pass::hair) ? Pass::hair : Pass::subsurface]);
        hair_light.add(frame, tolerance, sum, statistics.hair);
    }
    if (posed_scene.air() == nullptr) return;
    update_lights(snapshot);
    const Stopwatch timer(times[plan.runs(Pass::air) ? Pass::air : Pass::volumes]);
    statistics.air_rays += add_airlight(air_instant(), tolerance, frame, sum);
}

/// Light within air, where it is not known yet, from the instant alone: what was gathered before is forgotten.
void Renderer::Impl::light_air() {
    const Air* air = posed_scene.air();
    if (air == nullptr || (air_lit_at == lights.lit_frame() && air->is_lit())) return;
    const AirInstant instant = air_instant();
    air_lit_at = -1;
    posed_scene.darken_air();
    forget_cells();
    if (!air->volumes().empty()) {
        const Stopwatch timer(times[Pass::volumes]);
        posed_scene.light_volumes(light_within_volumes(instant, statistics.air_rays));
    }
    forget_cells();
    if (air->fog() != nullptr) {
        const Stopwatch timer(times[Pass::air]);
        light_fog(instant, posed_scene, statistics.air_rays);
    }
    forget_cells();
    air_lit_at = instant.lit_frame;
}

/// Light of all points of a frame, by light trees and rays; no cache.
FrameLight Renderer::Impl::gather_all(const scene::Snapshot& snapshot, const LightingContext& context,
                                      const CutLimits& limits, ShadeCounts& counts) {
    FrameLight light = gather_light(context, limits, counts);
    if (!rays_of) return light;
    if (!caches) forget_cells();
    add_rays(final_gather, snapshot.camera, context, *rays_of, light);
    return light;
}

/// Light of a film's frame. `learns`: how far cuts err, for `limits`, first.
FrameLight Renderer::Impl::gather_film(const scene::Snapshot& snapshot, const LightingContext& context, bool learns,
                                       CutLimits& limits, ShadeCounts& counts) {
    const bool is_reference = context.tolerance.is_reference();
    if (learns && settings.calibrate && !is_reference) {
        const Stopwatch timer(statistics.calibration_seconds);
        statistics.calibrated_pixels += memory.calibration.before(snapshot, lights.lit_frame(), context, limits);
        limits.error_scale = memory.calibration.value();
        add_error_scale(limits.error_scale, statistics);
    }
    if (!caches || is_reference) return gather_all(snapshot, context, limits, counts);
    FrameLight light = memory.records.light(context, snapshot, limits, lights.by_rays() ? &final_gather : nullptr,
                                            counts, statistics.cache);
    if (rays_of == RaysOf::lobes) add_rays(final_gather, snapshot.camera, context, RaysOf::lobes, light);
    return light;
}

/// The error scale learns from a frame, if it has light of trees alone.
void Renderer::Impl::learn(const scene::Snapshot& snapshot, const LightingContext& context, float error_scale,
                           const FrameLight& light, const core::Radiance& radiance, std::uint64_t rays) {
    if (!settings.calibrate || context.tolerance.is_reference() || lights.by_rays()) return;
    const Stopwatch timer(statistics.calibration_seconds);
    statistics.calibrated_pixels +=
        memory.calibration.after(snapshot, lights.lit_frame(), context, error_scale, light, radiance, rays);
}

core::Radiance Renderer::Impl::gather_sparse(const scene::Snapshot& snapshot, const LightingContext& context,
                                             ShadeCounts& counts) {
    const Frame thin = every_fourth_pixel(context.seen);
    const LightingContext few = context_of(snapshot, thin, context.ungathered, context.tolerance);
    core::Radiance radiance =
        shade(few, gather_all(snapshot, few, cut_limits(), counts), plan.runs(Pass::layers), counts);
    interpolate_light(context.seen, context.ungathered, radiance);
    return radiance;
}

FrameLight Renderer::Impl::gather_draft(const scene::Snapshot& snapshot, const LightingContext& context,
                                        const core::MotionField* to_before, ShadeCounts& counts) {
    if (snapshot.cut_before) memory.drafts = {};
    FrameLight light =
        memory.drafts[snapshot.camera.eye_number()].light({context, lights.trees(), to_before}, cut_limits(), counts);
    if (plan.runs(Pass::lobe_rays)) add_rays(final_gather, snapshot.camera, context, RaysOf::lobes, light);
    return light;
}

core::Radiance Renderer::Impl::trace(const UngatheredLight& ungathered, const TruthSettings& finely) {
    core::Plane<glm::vec3> known(settings.format.width, settings.format.height);
    for (int y = 0; y < known.height(); ++y)
        for (int x = 0; x < known.width(); ++x) known.at(x, y) = light_of_bodies_and_air(ungathered, x, y);
    TrueFrame truth = true_frame(posed_scene, see_settings(), plan, known, finely);
    statistics.true_paths += truth.paths;
    statistics.true_pixels += truth.radiance.combined.size();
    statistics.capped_pixels += truth.capped;
    return std::move(truth.radiance);
}

Renderer::Renderer(const scene::Animation& animation, const Settings& settings, const Plan& plan, TextureStore* store,
                   std::optional<KnownLight> known)
    : impl_(std::make_unique<Impl>(animation, settings, plan, store)) {
    if (known) impl_->memory.records.library().know(stored_records(*known));
}
Renderer::Renderer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;

std::unique_ptr<Renderer> Renderer::beside(const scene::Snapshot& instant) {
    impl_->lights.prepare(instant);
    return std::unique_ptr<Renderer>(new Renderer(std::make_unique<Impl>(*impl_)));
}

void Renderer::start_chunk(const scene::Snapshot& first) {
    impl_->start_chunk(first);
}

void Renderer::prepare(const scene::Snapshot& snapshot) {
    impl_->pose(snapshot);
    impl_->update_lights(snapshot);
}

void Renderer::resize(const scene::PictureFormat& format) {
    EXPECTS(format.width > 0 && format.height > 0);
    impl_->settings.format = format;
    impl_->memory.drafts = {};
}

bool Renderer::is_sound(KnownLight light) {
    if (light.size() % sizeof(StoredRecord) != 0) return false;
    return std::ranges::all_of(stored_records(light), renderer::is_sound);
}

std::vector<std::byte> Renderer::found_light() const {
    const std::vector<StoredRecord> found = impl_->memory.records.found();
    const auto bytes = std::as_bytes(std::span(found));
    return {bytes.begin(), bytes.end()};
}

Frame Renderer::look(const scene::Snapshot& snapshot) {
    impl_->pose(snapshot);
    const Stopwatch timer(impl_->times[Pass::see]);
    SeeCounts counts;
    Frame frame = see(impl_->posed_scene, impl_->see_settings(), impl_->plan, counts);
    add(counts, impl_->statistics);
    return frame;
}

Frame Renderer::look_at_middles(const scene::Snapshot& snapshot) {
    impl_->pose(snapshot);
    const Stopwatch timer(impl_->times[Pass::see]);
    SeeSettings middles = impl_->see_settings();
    middles.spaced_as = middles.samples;
    middles.samples = middles.edge_samples = 1;  // the middle is the first of all
    middles.mattes = false;
    SeeCounts counts;
    Frame seen = see(impl_->posed_scene, middles, impl_->plan, counts);
    Frame frame;
    frame.visible = std::move(seen.visible);
    frame.imaged = std::move(seen.imaged);
    return frame;
}

void Renderer::save(core::ArchiveWriter& archive) {
    impl_->keep(archive);
}

void Renderer::restore(core::ArchiveReader& archive) {
    impl_->light_air();  // follows from the instant, and finds cells that the state replaces
    impl_->keep(archive);
    const scene::Animation& film = impl_->posed_scene.animation();
    if (!impl_->memory.records.is_sound(film)) throw core::Error("records of light are damaged");
}

Lit Renderer::light(const scene::Snapshot& snapshot, Frame frame, const LightOrder& order) {
    return gather(snapshot, place(snapshot, std::move(frame), order), order);
}

PlacedFrame Renderer::place(const scene::Snapshot& snapshot, Frame frame, const LightOrder& order) {
    impl_->pose(snapshot);
    if (!order.is_rough()) {
        frame = impl_->refined(snapshot, std::move(frame), order.tolerance);
        if (order.exposure && order.mode == LightingMode::film)
            frame = impl_->exposed(std::move(frame), *order.exposure);
    }
    PlacedFrame placed{std::move(frame), {}};
    placed.ungathered = UngatheredLight(placed.frame);
    impl_->add_effects(snapshot, order.is_rough() ? nullptr : &order.tolerance, placed);
    return placed;
}

Lit Renderer::gather(const scene::Snapshot& snapshot, PlacedFrame placed, const LightOrder& order) {
    EXPECTS(placed.frame.visible.frame == snapshot.frame);
    Impl& i = *impl_;
    i.pose(snapshot);
    if (order.mode != LightingMode::truth) i.update_lights(snapshot);
    i.counted_rays = i.gathered_rays();
    i.shared_seconds = i.final_gather.counts().seconds;
    const double start = parallel::lane_seconds();
    Lit lit{std::move(placed), {}};
    const core::ToleranceMap tolerance = tolerance_of_points(lit.frame, order.tolerance);
    const LightingContext context = i.context_of(snapshot, lit.frame, lit.ungathered, tolerance);
    const bool layers = i.plan.runs(Pass::layers);
    CutLimits limits = i.cut_limits();
    ShadeCounts counts;
    FrameLight light;
    const bool keeps = i.caches && i.lights.by_rays();
    const LightingMode mode = order.mode == LightingMode::ahead && !keeps ? LightingMode::sparse : order.mode;
    switch (mode) {
        case LightingMode::film:
        case LightingMode::ahead:
            light = i.gather_film(snapshot, context, mode == LightingMode::film, limits, counts);
            break;
        case LightingMode::rough:
            light = i.gather_all(snapshot, context, limits, counts);
            break;
        case LightingMode::draft:
            light = i.gather_draft(snapshot, context, order.to_before, counts);
            break;
        case LightingMode::sparse:
            lit.radiance = i.gather_sparse(snapshot, context, counts);
            break;
        case LightingMode::truth:
            lit.radiance = i.trace(lit.ungathered, order.truth);
            break;
    }
    const bool has_points = mode != LightingMode::sparse && mode != LightingMode::truth;
    if (has_points) lit.radiance = shade(context, light, layers, counts);
    if (mode == LightingMode::film) {
        if (layers && i.caches)
            lit.radiance.record_density = i.memory.records.density(snapshot.camera, i.settings.format);
        i.learn(snapshot, context, limits.error_scale, light, lit.radiance, counts.shadow_rays);
    }
    if (has_points && mode != LightingMode::rough) i.count(counts, lit.frame.visible);
    if (lit.frame.exposure && has_points) {
        lit.middle = lit.radiance;
        ShadeCounts blurred;
        spread_light(lit.frame, lit.ungathered, light, layers, lit.radiance, blurred);
        if (!order.is_rough()) i.count(blurred, lit.frame.visible);
    }
    i.share_time(parallel::lane_seconds() - start, counts);
    i.statistics.layer_seconds = i.posed_scene.layer_seconds() - i.earlier_layer_seconds;
    return lit;
}

/// Calls `use` with a lit frame and its lights. Nothing counts, and no frame learns from it.
template <class Use>
auto Renderer::Impl::audited(const scene::Snapshot& snapshot, const Lit& lit, const core::ToleranceMap& wanted,
                             Use use) {
    EXPECTS(lit.frame.visible.frame == snapshot.frame && lit.radiance.frame == snapshot.frame);
    const core::ToleranceMap tolerance = tolerance_of_points(lit.frame, wanted);
    pose(snapshot);
    const Statistics before = statistics;
    update_lights(snapshot);
    statistics = before;
    const auto rays = rays_of ? std::make_unique<FinalGather>(posed_scene, plan) : nullptr;
    if (rays) rays->forget(lights.sky_of_rays());
    return use(AuditedFrame{posed_scene, context_of(snapshot, lit.frame, lit.ungathered, tolerance), rays.get(),
                            rays_of, lit.middle.combined.empty() ? lit.radiance : lit.middle});
}

std::vector<AuditedPixel> Renderer::audit(const scene::Snapshot& snapshot, const Lit& lit,
                                          const core::ToleranceMap& tolerance, int count) {
    if (count <= 0) return {};
    std::vector<glm::ivec2> places;
    for (const LitPixel& p : drawn_with_blocks(lit_pixels(lit.frame), static_cast<std::size_t>(count), lit.frame))
        places.push_back(place_of(lit.frame, p));
    return audit(snapshot, lit, tolerance, places);
}

std::vector<AuditedPixel> Renderer::audit(const scene::Snapshot& snapshot, const Lit& lit,
                                          const core::ToleranceMap& tolerance, std::span<const glm::ivec2> places) {
    return impl_->audited(snapshot, lit, tolerance, [&](const AuditedFrame& frame) {
        std::vector<LitPixel> pixels;
        for (const glm::ivec2 place : places)
            if (const LitPixel p = pixel_at(lit.frame, place); p.first < p.last) pixels.push_back(p);
        return compare(lit.frame, pixels, exact_pixels(frame, pixels), frame.context.tolerance, frame.radiance);
    });
}

std::vector<ValidatedPixel> Renderer::validate(const scene::Snapshot& snapshot, const Lit& lit,
                                               const core::ToleranceMap& tolerance,
                                               std::span<const AuditedPixel> audited, const TruthSettings& finely) {
    return impl_->audited(snapshot, lit, tolerance, [&](const AuditedFrame& frame) {
        return validate_pixels(frame, impl_->see_settings(), impl_->plan, audited, finely);
    });
}

const RayTracer& Renderer::tracer() const {
    return impl_->posed_scene.tracer();
}

const Statistics& Renderer::statistics() const {
    return impl_->statistics;
}

void Renderer::count_anew() {
    // Lights that stay what they are have their points still.
    const std::size_t direct = impl_->statistics.direct_points, indirect = impl_->statistics.indirect_points;
    impl_->statistics = {};
    impl_->statistics.direct_points = direct;
    impl_->statistics.indirect_points = indirect;
    impl_->times = {};
    impl_->earlier_layer_seconds = impl_->posed_scene.layer_seconds();
}

double Renderer::seconds(Pass pass) const {
    return impl_->times[pass];
}

}  // namespace render2mpeg::renderer
