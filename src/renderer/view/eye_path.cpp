#include "renderer/view/eye_path.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/color.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "renderer/base/light_point.h"
#include "renderer/base/lobe.h"
#include "renderer/view/edited_mirror.h"

namespace render2mpeg::renderer {
namespace {

/// A mirror ray that would bring less than this share of its sample gathers nothing.
/// chosen: a smooth dielectric's 4 % is traced once, its reflection in another one not; tried 0.001 (twice the gather
/// points between two polished surfaces, no visible difference) to 0.05 (polished floors lose their reflection).
constexpr float least_mirror_share = 0.02f;

/// Behind layers that let less than this through nothing is looked for. chosen: one code value of 8 bits in the
/// brightest picture is 1 / 219; tried 0.001..0.01.
constexpr float least_passing_share = 0.004f;

/// Of the mirrored and the bent path at a boundary of solid glass the lesser one is followed by the rule for mirrors,
/// the greater one as far as layers are: a ball's inner reflections end soon, the view through it never. Together they
/// are at most so many of one sample; light beyond is lost. chosen: 64, which a cut gem of 12 facets reaches.
constexpr int most_lesser_paths = 64;

/// Boundaries of bodies on one path beyond its mirrors. chosen: 8, as two wine glasses with wine take.
constexpr int more_boundaries = 8;

/// A path of a mirror or through solid glass below its bound is followed for emission alone, lamps and sky, as far as
/// it brings this share: lamps are so much brighter than other things that a ball's inner reflections of them are seen,
/// and those in a clear coat, which mirrors 1 %. It costs rays, but no gather points. chosen: 0.005, which takes a
/// twentieth more rays; a ball before a lamp lacks 0.4 % of its light, without such paths 1.9 %; 0.0005 takes a third
/// more rays for as much (tests/reference).
constexpr float least_shining_share = 0.005f;

/// Holes of cut-out surfaces cost a ray each but hide nothing; so many in a row end a ray of the eye.
/// chosen: dense foliage has some 20 cards along a ray; tried 16..256.
constexpr int most_steps = 96;

/// Whether a surface shows its reflection rather than itself.
bool shows_reflection(const SurfacePoint& point) {
    const float own = core::luminance(point.bsdf.diffuse + point.bsdf.f0 + point.emission);
    return core::luminance(point.bsdf.mirror) > own;
}

}  // namespace

SurfaceFootprint EyeRay::footprint_at(float distance, glm::vec3 normal) const {
    return {transferred(origin_change.dx, direction_change.dx, distance, direction, normal),
            transferred(origin_change.dy, direction_change.dy, distance, direction, normal)};
}

EyeRay eye_ray(const scene::Camera& camera, glm::vec2 position, float spacing, float& far, glm::vec2 lens) {
    const auto through = [&](glm::vec2 p) {
        return lens == glm::vec2{0.0f} ? camera.ray_through(p) : camera.ray_through(p, lens);
    };
    const scene::Ray middle = through(position);
    const scene::Ray right = through(position + glm::vec2{spacing, 0.0f});
    const scene::Ray below = through(position + glm::vec2{0.0f, spacing});
    EyeRay ray;
    ray.origin = middle.origin;
    ray.direction = middle.direction;
    ray.origin_change = {right.origin - middle.origin, below.origin - middle.origin};
    ray.direction_change = {right.direction - middle.direction, below.direction - middle.direction};

    // Begin at the near plane and end at the far one.
    const glm::vec3 deeper = camera.depth_axis(ray.direction);
    const float cosine = glm::dot(ray.direction, deeper);
    const float near = core::divide_or(std::max(camera.lens().near, 0.0f), cosine, 0.0f);
    far = camera.lens().far > 0.0f ? core::divide_or(camera.lens().far, cosine, 0.0f) - near
                                   : std::numeric_limits<float>::infinity();
    if (near > 0.0f) {
        ray.origin_change = ray.footprint_at(near, deeper);
        ray.origin += near * ray.direction;
    }
    return ray;
}

/// State of one path.
struct EyePaths::PathState {
    EyeRay ray;
    float far;
    glm::vec3 weight{1};
    int mirrors = 0;     ///< so far
    int layers = 0;      ///< of coverage, that it passed straight
    int covers = 0;      ///< of them those that the animation limits, holes included
    int boundaries = 0;  ///< of bodies of glass
    bool bent = false;
    bool dim = false;       ///< followed for emission alone
    bool is_image = false;  ///< comes from the flat mirror that is the sample's main surface
    std::uint8_t path = direct_path;
    float passed = 0;    ///< length of the straight segments so far
    glm::vec3 clear{1};  ///< transmittance of air for it
    bool specular() const { return path != direct_path; }
    bool straight() const { return mirrors == 0 && !bent; }
    bool turned() const { return mirrors + boundaries > 0; }  ///< off a mirror or through a body's boundary
};

EyePaths::EyePaths(const PosedScene& posed_scene, const SeeSettings& settings, const Plan& plan)
    : posed_scene_(posed_scene),
      sky_(plan.runs(Pass::sky_background) && posed_scene.sky() != nullptr),
      mirrors_(plan.runs(Pass::mirrors)),
      bodies_(posed_scene.has_bodies()),
      discs_(std::any_of(posed_scene.animation().lights.begin(), posed_scene.animation().lights.end(),
                         [](const scene::Light& light) { return light.disc > 0.0f; })),
      edits_(plan.runs(Pass::edited_reflections)),
      mattes_(settings.mattes),
      transparent_(settings.transparent),
      specular_depth_(settings.specular_depth),
      air_(posed_scene.air()) {}

void EyePaths::look(const EyeRay& ray, float far, const Hit& first, EyeSample& sample, SeeCounts& counts) const {
    sample.fragments.clear();
    sample.air.clear();
    sample.air_beyond.clear();
    sample.mattes.clear();
    sample.emitted = sample.emitted_specular = glm::vec3{0.0f};
    sample.main = {};
    sample.lesser_paths = sample.dim_paths = 0;
    PathState path;
    path.ray = ray;
    path.far = far;
    follow(path, first, sample, counts);
}

void EyePaths::see_sky(const PathState& path, EyeSample& sample) const {
    if (path.straight() && core::luminance(path.weight) > sample.main.share)
        sample.main = {core::luminance(path.weight), core::PixelClass::sky, {}, {}};
    if (transparent_) cover(path, {}, core::luminance(path.weight), sample);
    if (!sky_ || (transparent_ && !path.specular())) return;
    const SurfaceFootprint& spread = path.ray.direction_change;
    const glm::vec3 light = path.weight * sky_clock_.time([&] {
        return posed_scene_.sky()->radiance(path.ray.direction, glm::length(glm::cross(spread.dx, spread.dy)));
    });
    emit(path, light, sample);
}

void EyePaths::emit(const PathState& path, glm::vec3 light, EyeSample& sample) {
    sample.emitted += light;
    if (path.specular()) sample.emitted_specular += light;
}

/// Shows lamps without a surface on a segment of this length: discs that face where it begins, and let pass all light.
void EyePaths::see_discs(const PathState& path, float length, EyeSample& sample) const {
    for (const scene::LightState& lamp : posed_scene_.posed().lights) {
        if (!(lamp.disc > 0.0f) || !(path.turned() || (lamp.seen && !transparent_))) continue;
        const bool far = lamp.is_distant();
        if (far && !std::isinf(length)) continue;
        const glm::vec3 way = far ? -lamp.direction : lamp.position - path.ray.origin;
        const float along = glm::dot(way, path.ray.direction), distance = glm::length(way);
        const float apart = glm::length(glm::cross(way, path.ray.direction));
        // As wide where the ray passes the disc's plane.
        if (!(along > 0.0f) || !(apart * distance <= lamp.disc * along) || !(distance < length)) continue;
        const float share = far ? 1.0f : spot_of(lamp).falloff(glm::dot(-path.ray.direction, lamp.direction));
        const glm::vec3 clear = air_ == nullptr || !path.ray.media.empty()
                                    ? glm::vec3(1)
                                    : air_->left_of_light(path.ray.origin, path.ray.direction, far ? length : distance);
        const float radiance = share * lobe::inverse_pi / (lamp.disc * lamp.disc);
        emit(path, path.weight * lamp.intensity * (clear * radiance), sample);
    }
}

/// Whether a surface cuts a hole into the picture.
bool EyePaths::is_hole(const PathState& path, const SurfacePoint& point) const {
    return !path.specular() && posed_scene_.animation().materials[point.material].holdout;
}

/// Notes the matte of a surface that covers this share of the sample, where it is seen directly.
void EyePaths::cover(const PathState& path, const SurfacePoint& point, float share, EyeSample& sample) const {
    if (!mattes_ || path.specular() || !(share > 0.0f)) return;
    const bool nothing = !point.address.is_surface() || is_hole(path, point);
    sample.mattes.push_back(
        {nothing ? core::no_id : point.address.object, nothing ? core::no_id : point.material, share});
}

/// At the first glass that splits colours, follows each by itself; whether it did.
bool EyePaths::split_colors(const PathState& path, const Hit& hit, EyeSample& sample, SeeCounts& counts) const {
    const Medium* medium = posed_scene_.medium_within(hit.address.object);
    if (path.ray.band != Band::all || medium == nullptr || !(medium->dispersion > 0.0f)) return false;
    constexpr Band bands[] = {Band::red, Band::green, Band::blue};
    for (int c = 0; c < 3; ++c) {
        PathState part = path;
        part.ray.band = bands[c];
        part.weight = glm::vec3{0.0f};
        part.weight[c] = path.weight[c];
        follow(part, hit, sample, counts);
    }
    return true;
}

/// Shows a surface behind more layers than the animation allows: of its light what it emits.
void EyePaths::end_in_black(const PathState& path, const SurfacePoint& point, EyeSample& sample) const {
    const float share = core::luminance(path.weight);
    cover(path, point, share, sample);
    if (path.straight() && share > sample.main.share) sample.main = {share, core::PixelClass::surface, point, {}};
    emit(path, path.weight * point.alpha * point.emission, sample);
}

/// `hit`: the first surface of the path.
void EyePaths::follow(PathState path, Hit hit, EyeSample& sample, SeeCounts& counts) const {
    for (int step = 0; step < most_steps; ++step) {
        ++(path.straight() ? counts.primary_rays : counts.specular_rays);
        if (step > 0) hit = path.ray.meet(posed_scene_, path.far);
        if (discs_) see_discs(path, hit.found() ? hit.distance : std::numeric_limits<float>::infinity(), sample);
        if (!hit.found()) {
            if (air_ != nullptr) pass_air(path, path.far, sample);
            see_sky(path, sample);
            return;
        }
        if (bodies_) {
            if (split_colors(path, hit, sample, counts)) return;
            path.weight *= path.ray.left_by_bodies(posed_scene_, hit);
        }
        if (air_ != nullptr) pass_air(path, hit.distance, sample);
        const glm::vec3 plane = core::normalize_or(hit.geometric_normal, -path.ray.direction);
        const SurfaceFootprint footprint = path.ray.footprint_at(hit.distance, plane);
        Fragment fragment;
        SurfacePoint& point = fragment.point;
        point = path.ray.surface_at(posed_scene_, hit, footprint, Holes::bare);
        const bool unseen = !path.specular() && !posed_scene_.animation().materials[point.material].seen;
        const LayerLimit& limit = posed_scene_.tracer().limit();
        if (!unseen && limit.ends(path.covers)) {
            end_in_black(path, point, sample);
            return;
        }
        if (unseen) point.alpha = 0.0f;
        if (edits_) aim_reflection(posed_scene_, path.ray.time, point);
        if (point.alpha == 0.0f && path.turned() && posed_scene_.animation().materials[point.material].mirrored)
            emit(path, path.weight * point.emission, sample);
        const glm::vec3 passing = point.alpha > 0.0f ? show(path, fragment, footprint, sample, counts) : path.weight;
        if (point.bounds_body && point.alpha == 1.0f) {
            if (!bend(path, fragment, footprint, passing, sample)) return;
            continue;
        }
        if (!(core::luminance(passing) > (path.dim ? least_shining_share : least_passing_share))) return;

        // Go on behind it.
        path.weight = passing;
        path.covers += !unseen && limit.counts(hit.address.object) ? 1 : 0;
        path.far -= hit.distance;
        path.ray.pass(posed_scene_, point);
        path.ray.origin_change = footprint;
    }
}

/// Splits subsurface light from light that leaves where it enters.
void EyePaths::spread(Fragment& fragment, EyeSample& sample) const {
    const float weight = posed_scene_.animation().materials[fragment.point.material].subsurface->weight;
    Fragment& below = sample.fragments.emplace_back(fragment);
    below.point.below = true;
    below.point.bsdf = {};
    below.point.bsdf.diffuse = weight * fragment.point.bsdf.diffuse;
    below.point.emission = glm::vec3(0);
    fragment.point.bsdf.diffuse *= 1.0f - weight;
}

/// Goes so far through air, which dims light and adds its own.
void EyePaths::pass_air(PathState& path, float distance, EyeSample& sample) const {
    const glm::vec3 through = air_->transmittance(path.ray.origin, path.ray.direction, distance);
    if (!path.ray.media.empty()) {
        // The weight of air beyond is dimmed by the air that the glass replaces.
        path.passed += distance;
        path.clear *= through;
        return;
    }
    if (!path.straight()) {
        sample.air_beyond.push_back({0, path.path, path.ray.origin, path.ray.direction, distance, path.weight});
    } else {
        // Light of air from the eye to the span's end, less that to its beginning.
        const glm::vec3 share(core::divide_or(1.0f, path.clear.x, 0.0f) * path.weight.x,
                              core::divide_or(1.0f, path.clear.y, 0.0f) * path.weight.y,
                              core::divide_or(1.0f, path.clear.z, 0.0f) * path.weight.z);
        if (path.passed > 0.0f) sample.air.push_back({0, path.passed, -share});
        sample.air.push_back({0, path.passed + distance, share});
        path.passed += distance;
        path.clear *= through;
    }
    path.weight *= through;
}

/// Takes the light of a layer and of its reflection; returns the weight behind it.
glm::vec3 EyePaths::show(PathState& path, Fragment& fragment, const SurfaceFootprint& footprint, EyeSample& sample,
                         SeeCounts& counts) const {
    const SurfacePoint& point = fragment.point;
    const bool last = !point.bounds_body && ++path.layers == RayTracer::max_layers;
    const float alpha = last ? 1.0f : point.alpha;
    fragment.weight = alpha * path.weight;
    fragment.extent = std::min(glm::length(footprint.dx), glm::length(footprint.dy));
    fragment.path = path.path;
    fragment.turn = point.bsdf.has_narrow_lobe() ? posed_scene_.normal_change(point.address, footprint, path.ray.time)
                                                 : SurfaceFootprint{};
    if (is_hole(path, point)) {
        cover(path, point, core::luminance(fragment.weight), sample);
        if (path.straight() && core::luminance(fragment.weight) > sample.main.share)
            sample.main = {core::luminance(fragment.weight), core::PixelClass::surface, point, {}};
        return (1.0f - alpha) * path.weight;
    }
    const glm::vec3 through = last ? glm::vec3{0.0f} : fragment.weight * point.bsdf.transmission;
    const glm::vec3 passing = (1.0f - alpha) * path.weight + through;

    // Mattes count glass as opaque.
    const bool is_glass = core::luminance(through) > 0.0f;
    cover(path, point, core::luminance(is_glass ? path.weight : fragment.weight), sample);
    emit(path, fragment.weight * point.emission, sample);
    if (path.is_image && alpha == 1.0f && !point.bounds_body && !shows_reflection(point))
        sample.main.imaged = point.address;
    path.is_image = false;
    const bool turns = is_turned(point);
    const float share = core::luminance(turns ? path.weight : path.weight - passing);
    if (path.straight() && share > sample.main.share) {
        const auto kind = turns || shows_reflection(point) ? core::PixelClass::reflected : core::PixelClass::surface;
        sample.main = {share, kind, point, {}};
    }
    const bool gathers = !path.dim;
    if (gathers && point.spreads) spread(fragment, sample);
    if (gathers && (point.bsdf.has_diffuse() || point.bsdf.has_glossy() || point.fibre))
        sample.fragments.push_back(fragment);
    if (gathers && point.bsdf.has_diffuse_transmission()) {
        sample.fragments.push_back(fragment);
        sample.fragments.back().point = posed_scene_.other_side(point, footprint, path.ray.time);
    }
    mirror(path, fragment, footprint, sample, counts);
    if (is_glass) path.path = extended_path(path.path, false);
    return passing;
}

/// Whether a point bends the view behind it.
bool EyePaths::is_turned(const SurfacePoint& point) const {
    return bends_light(posed_scene_, point) && point.bsdf.ior != 1.0f;
}

/// Normal of a glass boundary for this sample: rough ones have facets, chosen by the density of visible ones.
glm::vec3 EyePaths::facet(const PathState& path, const SurfacePoint& point) const {
    // [Roberts2018]'s sequence over the samples, shifted from pixel to pixel and from boundary to boundary.
    const auto k = static_cast<float>((path.ray.number & 0xffffu) + 1);
    const auto shift = static_cast<float>((path.ray.number >> 16) + 16 * static_cast<std::uint32_t>(path.boundaries));
    return facet_of(point,
                    glm::fract(glm::vec2(0.7548777f, 0.5698403f) * k + glm::vec2(0.618034f, 0.4142136f) * shift));
}

/// How a direction's neighbours turn with the normal; rough glass spreads them further.
SurfaceFootprint EyePaths::normal_change(const SurfacePoint& point, const SurfaceFootprint& footprint,
                                         float time) const {
    SurfaceFootprint change = posed_scene_.normal_change(point.address, footprint, time);
    if (point.back_side) change = {-change.dx, -change.dy};
    if (!point.bounds_body) return change;
    glm::vec3 right, up;
    core::make_frame(point.shading_normal, right, up);
    const float spread = widening_of(point);
    return {change.dx + spread * right, change.dy + spread * up};
}

/// Turns a path into or out of a body, or between two; false: nothing is left of it.
bool EyePaths::bend(PathState& path, const Fragment& fragment, const SurfaceFootprint& footprint, glm::vec3 weight,
                    EyeSample& sample) const {
    const SurfacePoint& point = fragment.point;
    const bool less = core::luminance(weight) < core::luminance(fragment.weight * point.bsdf.mirror);
    path.dim = path.dim || core::luminance(weight) < (less ? least_mirror_share : least_passing_share);
    if (!(core::luminance(weight) > (path.dim ? least_shining_share : 0.0f)) || !may_go_on(path, less, sample))
        return false;
    const glm::vec3 from = path.ray.direction;
    const glm::vec3 n = facet(path, point);
    if (!path.ray.refract(posed_scene_, point, n)) return false;
    const SurfaceFootprint turn = normal_change(point, footprint, path.ray.time);
    const SurfaceFootprint& spread = path.ray.direction_change;
    path.ray.direction_change = {refracted_change(from, spread.dx, n, turn.dx, point.bsdf.ior),
                                 refracted_change(from, spread.dy, n, turn.dy, point.bsdf.ior)};
    path.ray.origin_change = footprint;
    path.far = std::numeric_limits<float>::infinity();
    path.weight = weight;
    path.bent = path.bent || is_turned(point);
    ++path.boundaries;
    return true;
}

/// Whether one more path may leave a boundary of glass.
bool EyePaths::may_go_on(const PathState& path, bool lesser, EyeSample& sample) const {
    if (path.boundaries >= specular_depth_ + more_boundaries) return false;
    return !lesser || ++(path.dim ? sample.dim_paths : sample.lesser_paths) <= most_lesser_paths;
}

void EyePaths::mirror(const PathState& path, const Fragment& fragment, const SurfaceFootprint& footprint,
                      EyeSample& sample, SeeCounts& counts) const {
    const SurfacePoint& point = fragment.point;
    PathState next;
    next.weight = fragment.weight * point.bsdf.mirror;
    const float share = core::luminance(next.weight);
    const bool lesser = !(point.bounds_body && share > core::luminance(fragment.weight * point.bsdf.transmission));
    next.dim = path.dim || share < (lesser ? least_mirror_share : least_passing_share);
    if (!mirrors_ || !(share >= (next.dim ? least_shining_share : 0.0f))) return;
    next.boundaries = path.boundaries;
    if (point.bounds_body ? !may_go_on(next, lesser, sample) : path.mirrors >= specular_depth_) return;
    next.mirrors = path.mirrors + (point.bounds_body ? 0 : 1);
    next.boundaries += point.bounds_body ? 1 : 0;
    next.bent = path.bent || point.bounds_body;
    next.path = extended_path(path.path, true);
    next.far = std::numeric_limits<float>::infinity();
    const glm::vec3 n = facet(path, point);
    next.ray = path.ray;
    next.ray.reflect(point, n);
    next.ray.origin_change = footprint;

    // Neighbours are mirrored by the normal they meet.
    const SurfaceFootprint turn = normal_change(point, footprint, path.ray.time);
    const SurfaceFootprint& spread = path.ray.direction_change;
    next.ray.direction_change = {mirrored_change(path.ray.direction, spread.dx, n, turn.dx),
                                 mirrored_change(path.ray.direction, spread.dy, n, turn.dy)};
    const bool edited = edits_ && has_aimed_reflection(posed_scene_, point);
    if (edited)
        next.ray.direction_change =
            aimed_change(posed_scene_, {path.ray.direction, spread, footprint, turn, path.ray.time}, point);
    const glm::vec3 none{0.0f};
    const bool flat = turn.dx == none && turn.dy == none && point.shading_normal == point.geometric_normal;
    next.is_image = (flat || edited) && path.straight() && sample.main.kind == core::PixelClass::reflected &&
                    sample.main.point.address == point.address;
    follow(next, next.ray.meet(posed_scene_), sample, counts);
}

}  // namespace render2mpeg::renderer
