#include "renderer/view/eye_path.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/color.h"
#include "core/numeric.h"

namespace render2mpeg::renderer {
namespace {

/// A mirror ray that would bring less than this share of its sample is not shot; what it would have brought is lost.
/// chosen: a smooth dielectric's 4 % is traced once, its reflection in another one not; tried 0.001 (twice the gather
/// points between two polished surfaces, no visible difference) to 0.05 (polished floors lose their reflection).
constexpr float least_mirror_share = 0.02f;

/// Behind layers that let less than this through nothing is looked for. chosen: one code value of 8 bits in the
/// brightest picture is 1 / 219; tried 0.001..0.01.
constexpr float least_passing_share = 0.004f;

/// Holes of cut-out surfaces cost a ray each but hide nothing; so many in a row end a ray of the eye.
/// chosen: dense foliage has some 20 cards along a ray; tried 16..256.
constexpr int most_steps = 96;

glm::vec3 moved_in_plane(glm::vec3 change, glm::vec3 direction, glm::vec3 normal) {
    // [Igehy1999, "Transfer"]: slide along the ray until back in the plane. Rays in the plane have no footprint of use.
    const float cosine = glm::dot(direction, normal);
    const glm::vec3 moved = change - core::divide_or(glm::dot(change, normal), cosine, 0.0f) * direction;
    return core::is_finite(moved) ? moved : glm::vec3{0.0f};
}

/// The mirrored direction, kept above the surface where a bent normal would send it below.
glm::vec3 mirrored(glm::vec3 direction, const SurfacePoint& point) {
    constexpr float least_cosine = 1e-3f;  // chosen: above the rounding of the reflection; tried 1e-5..1e-2
    const glm::vec3 r = direction - 2.0f * glm::dot(direction, point.shading_normal) * point.shading_normal;
    const float cosine = glm::dot(r, point.geometric_normal);
    const glm::vec3 lifted = cosine < least_cosine ? r + (least_cosine - cosine) * point.geometric_normal : r;
    return core::normalize_or(lifted, point.geometric_normal);
}

/// Whether what is seen on a surface is its reflection rather than the surface.
bool shows_reflection(const SurfacePoint& point) {
    const float own = core::luminance(point.bsdf.diffuse + point.bsdf.f0 + point.emission);
    return core::luminance(point.bsdf.mirror) > own;
}

}  // namespace

SurfaceFootprint EyeRay::footprint_at(float distance, glm::vec3 normal) const {
    return {moved_in_plane(origin_change.dx + distance * direction_change.dx, direction, normal),
            moved_in_plane(origin_change.dy + distance * direction_change.dy, direction, normal)};
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
    const glm::vec3 forward = camera.forward();
    const float cosine = glm::dot(ray.direction, forward);
    const float near = core::divide_or(std::max(camera.lens().near, 0.0f), cosine, 0.0f);
    far = camera.lens().far > 0.0f ? core::divide_or(camera.lens().far, cosine, 0.0f) - near
                                   : std::numeric_limits<float>::infinity();
    if (near > 0.0f) {
        ray.origin_change = ray.footprint_at(near, forward);
        ray.origin += near * ray.direction;
    }
    return ray;
}

/// One ray on its way.
struct EyePaths::PathState {
    EyeRay ray;
    float far;
    glm::vec3 weight{1};
    int mirrors = 0;  ///< so far
    std::uint8_t way = straight_way;
    bool specular() const { return way != straight_way; }
};

EyePaths::EyePaths(const PosedScene& posed_scene, const SeeSettings& settings, const Plan& plan)
    : posed_scene_(posed_scene),
      sky_(plan.runs(Pass::sky_background) && posed_scene.sky() != nullptr),
      mirrors_(plan.runs(Pass::mirrors)),
      specular_depth_(settings.specular_depth) {}

void EyePaths::look(const EyeRay& ray, float far, const Hit& first, EyeSample& sample, SeeCounts& counts) const {
    sample.fragments.clear();
    sample.emitted = sample.emitted_specular = glm::vec3{0.0f};
    sample.main = {};
    PathState path;
    path.ray = ray;
    path.far = far;
    follow(path, first, sample, counts);
}

Hit EyePaths::meet(const PathState& path) const {
    return posed_scene_.tracer().nearest(path.ray.origin, path.ray.direction, path.far, path.ray.time);
}

void EyePaths::see_sky(const PathState& path, EyeSample& sample) const {
    if (path.mirrors == 0 && core::luminance(path.weight) > sample.main.share)
        sample.main = {core::luminance(path.weight), core::PixelClass::sky, {}};
    if (!sky_) return;
    const SurfaceFootprint& spread = path.ray.direction_change;
    const glm::vec3 light = path.weight * sky_clock_.time([&] {
        return posed_scene_.sky()->radiance(path.ray.direction, glm::length(glm::cross(spread.dx, spread.dy)));
    });
    sample.emitted += light;
    if (path.specular()) sample.emitted_specular += light;
}

/// `hit`: what the path meets first.
void EyePaths::follow(PathState path, Hit hit, EyeSample& sample, SeeCounts& counts) const {
    int layers = 0;
    for (int step = 0; step < most_steps; ++step) {
        ++(path.mirrors > 0 ? counts.specular_rays : counts.primary_rays);
        if (step > 0) hit = meet(path);
        if (!hit.found()) {
            see_sky(path, sample);
            return;
        }
        const glm::vec3 plane = core::normalize_or(hit.geometric_normal, -path.ray.direction);
        const SurfaceFootprint footprint = path.ray.footprint_at(hit.distance, plane);
        Fragment fragment;
        SurfacePoint& point = fragment.point;
        point = posed_scene_.surface_at(hit.address, -path.ray.direction, footprint, path.ray.time);

        // Take what the layer shows.
        glm::vec3 passing = path.weight;
        if (point.alpha > 0.0f) {
            const bool last = ++layers == RayTracer::max_layers;
            const float alpha = last ? 1.0f : point.alpha;
            fragment.weight = alpha * path.weight;
            fragment.extent = std::min(glm::length(footprint.dx), glm::length(footprint.dy));
            fragment.way = path.way;
            const glm::vec3 through = last ? glm::vec3{0.0f} : fragment.weight * point.bsdf.transmission;
            passing = (1.0f - alpha) * path.weight + through;

            sample.emitted += fragment.weight * point.emission;
            if (path.specular()) sample.emitted_specular += fragment.weight * point.emission;
            const float share = core::luminance(path.weight - passing);
            if (path.mirrors == 0 && share > sample.main.share) {
                const auto kind = shows_reflection(point) ? core::PixelClass::reflected : core::PixelClass::surface;
                sample.main = {share, kind, point};
            }
            if (point.bsdf.has_diffuse() || point.bsdf.has_glossy()) sample.fragments.push_back(fragment);
            if (point.bsdf.has_diffuse_transmission()) {
                sample.fragments.push_back(fragment);
                sample.fragments.back().point = posed_scene_.other_side(point, footprint);
            }
            mirror(path, fragment, footprint, sample, counts);
            if (core::luminance(through) > 0.0f) path.way = longer_way(path.way, false);
        }
        if (!(core::luminance(passing) > least_passing_share)) return;

        // Go on behind it.
        path.weight = passing;
        path.far -= hit.distance;
        path.ray.origin = offset_origin(point, path.ray.direction);
        path.ray.origin_change = footprint;
    }
}

void EyePaths::mirror(const PathState& path, const Fragment& fragment, const SurfaceFootprint& footprint,
                      EyeSample& sample, SeeCounts& counts) const {
    const SurfacePoint& point = fragment.point;
    PathState next;
    next.weight = fragment.weight * point.bsdf.mirror;
    if (!mirrors_ || path.mirrors >= specular_depth_ || !(core::luminance(next.weight) >= least_mirror_share)) return;
    next.mirrors = path.mirrors + 1;
    next.way = longer_way(path.way, true);
    next.far = std::numeric_limits<float>::infinity();
    next.ray.direction = mirrored(path.ray.direction, point);
    next.ray.origin = offset_origin(point, next.ray.direction);
    next.ray.origin_change = footprint;
    next.ray.time = path.ray.time;

    // [Igehy1999, "Reflection"]: neighbours are mirrored by the normal they meet.
    const glm::vec3 n = point.shading_normal, d = path.ray.direction;
    const SurfaceFootprint bend = posed_scene_.normal_change(point.address, footprint, path.ray.time);
    const float side = point.back_side ? -1.0f : 1.0f;
    const auto turned = [&](glm::vec3 change, glm::vec3 normal_change) {
        const glm::vec3 dn = side * normal_change;
        return change - 2.0f * (glm::dot(d, n) * dn + (glm::dot(change, n) + glm::dot(d, dn)) * n);
    };
    next.ray.direction_change = {turned(path.ray.direction_change.dx, bend.dx),
                                 turned(path.ray.direction_change.dy, bend.dy)};
    follow(next, meet(next), sample, counts);
}

}  // namespace render2mpeg::renderer
