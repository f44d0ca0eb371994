#include "renderer/gather/near_light.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include "core/box.h"
#include "core/color.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "parallel/loops.h"
#include "renderer/base/flush_denormals.h"
#include "renderer/base/lobe.h"
#include "renderer/base/stream.h"
#include "renderer/gather/gather_ray.h"
#include "renderer/gather/surface_cache.h"
#include "renderer/lights/photon_source.h"
#include "renderer/lights/photons.h"
#include "renderer/lights/virtual_lights.h"

namespace render2mpeg::renderer {
namespace {

/// Photons of an instant. chosen: 65536 of 4096 to 131072; of a quarter of them means of 8x8 pixels err twice as much
/// in a furnished room.
constexpr std::uint64_t photon_paths = 65536;
/// Light points that they leave, about, at most. chosen: 8192; cuts of 1000 err where there are many times as many.
constexpr std::uint32_t most_near_points = 8192;

/// A source is hidden that would light half of what is seen so many times as much as it is lit. chosen: 64; in a box
/// the lamp comes to 8.
constexpr double hidden_over_near = 64.0;
/// How far a near field reaches at most, over the distance of half of what is seen. chosen: 0.5; not tuned.
constexpr double most_reach = 0.5;
/// Of more sources those that reach farthest have a near field: each place asks all of them. chosen: 512.
constexpr std::size_t most_spheres = 512;

/// Rays that look about.
constexpr std::uint64_t eye_rays = 256, eye_rays_at_once = 16;

/// Plans at least half of the photons for lights that have a near field.
void favour_near(std::span<const LightPoint> shining, const NearField& near_field, const core::Box& box,
                 std::vector<LightPoint>& planned) {
    const PhotonSource source(planned, box);
    std::vector<bool> is_near;
    double near = 0, others = 0;
    for (std::size_t i = 0; i < planned.size(); ++i) {
        is_near.push_back(!planned[i].is_far() && near_field.share(shining[i].position) > 0.0f);
        (is_near[i] ? near : others) +=
            source.relative_power(i) * static_cast<double>(core::luminance(planned[i].intensity));
    }
    const auto fewer = static_cast<float>(std::min(core::divide_or(near, others, 1.0), 1.0));
    for (std::size_t i = 0; i < planned.size(); ++i)
        if (!is_near[i]) planned[i].intensity *= fewer;
}

/// Keeps points that are weaker than this with a chance, and makes them as strong.
void thin_out(double strength, std::vector<LightPoint>& points) {
    std::uint32_t id = 0;
    std::erase_if(points, [&](LightPoint& p) {
        const double own = static_cast<double>(core::luminance(p.intensity));
        const float chance =
            Stream(Purpose::near_points, {.index = std::bit_cast<std::uint32_t>(p.position.x)})
                .uniform(std::bit_cast<std::uint32_t>(p.position.y), std::bit_cast<std::uint32_t>(p.position.z));
        if (!(own > strength * static_cast<double>(chance))) return true;
        const auto stronger = static_cast<float>(std::max(strength / own, 1.0));
        p.intensity *= stronger;
        p.disc2 *= stronger;
        p.id = id++;
        return false;
    });
}

}  // namespace

NearField::NearField(std::span<const LightPoint> lights, const ViewSample& view) {
    const double begins = std::numbers::pi * static_cast<double>(view.luminance);
    if (!(begins > 0.0) || !std::isfinite(begins)) return;
    struct Source {
        glm::dvec3 place{0};
        double power = 0, square = 0;  ///< square: of distances from the origin, by power
    };
    const auto add = [&](const Source& source) {
        const glm::dvec3 centre = source.place / source.power;
        const double spread2 = source.square / source.power - glm::dot(centre, centre);
        double inverse2 = begins / source.power;
        if (!view.places.empty()) {
            std::vector<double> distances2;
            for (const glm::vec3& place : view.places) {
                const glm::dvec3 d = glm::dvec3(place) - centre;
                distances2.push_back(glm::dot(d, d));
            }
            const auto middle = distances2.begin() + static_cast<std::ptrdiff_t>(distances2.size() / 2);
            std::nth_element(distances2.begin(), middle, distances2.end());
            if (*middle * inverse2 * hidden_over_near < 1.0) return;
            inverse2 = std::max(inverse2, core::divide_or(1.0, most_reach * most_reach * *middle, 0.0));
        }
        if (inverse2 > 1e-30 && inverse2 < 1e30 && spread2 * inverse2 < 1.0 && source.power < 1e30)
            spheres_.push_back({glm::vec3(centre), static_cast<float>(inverse2), static_cast<float>(source.power)});
    };
    std::map<std::uint32_t, Source> objects;
    for (const LightPoint& p : lights) {
        const double power = core::luminance(p.intensity);
        if (p.is_far() || !is_finite(p) || !(power > 0.0)) continue;
        const glm::dvec3 place(p.position);
        const Source one{power * place, power, power * glm::dot(place, place)};
        if (!p.is_of_surface()) {
            add(one);
            continue;
        }
        Source& sum = objects[p.object];
        sum = {sum.place + one.place, sum.power + one.power, sum.square + one.square};
    }
    for (const auto& [object, source] : objects) add(source);
    if (spheres_.size() <= most_spheres) return;
    std::stable_sort(spheres_.begin(), spheres_.end(),
                     [](const Sphere& a, const Sphere& b) { return a.inverse2 < b.inverse2; });
    spheres_.resize(most_spheres);
}

std::uint32_t NearField::key() const {
    std::uint64_t key = spheres_.size();
    for (const Sphere& s : spheres_)
        for (const float value : {s.centre.x, s.centre.y, s.centre.z, s.inverse2, s.intensity})
            key = core::mix(key ^ std::bit_cast<std::uint32_t>(value));
    return static_cast<std::uint32_t>(key >> 32);
}

NearField::Part NearField::at(glm::vec3 place) const {
    float least = 1.0f, intensity = 0.0f;
    float inverse2 = 1.0f;
    for (const Sphere& s : spheres_) {
        const glm::vec3 d = place - s.centre;
        const float part = glm::dot(d, d) * s.inverse2;
        if (!(part < least)) continue;
        least = part;
        intensity = s.intensity;
        inverse2 = s.inverse2;
    }
    least = std::max(least, 0x1p-20f);
    return {1.0f - least, intensity * inverse2 / least};
}

ViewSample sample_view(const PosedScene& posed_scene, const Plan& plan, const scene::Camera& camera) {
    const FlushDenormals flushed;
    const GatherRays rays(posed_scene, plan);
    SurfaceCache cache(posed_scene, plan);
    cache.forget({});
    // Places and terms that the rays of one task met.
    struct TaskView {
        std::vector<glm::vec3> places;
        std::vector<RayTerm> terms;
    };
    std::vector<TaskView> of_task(eye_rays / eye_rays_at_once);
    parallel::for_each(of_task.size(), [&](std::size_t task) {
        const FlushDenormals flushed;
        std::uint64_t traced = 0;
        for (std::uint64_t i = task * eye_rays_at_once; i < (task + 1) * eye_rays_at_once; ++i) {
            const scene::Ray eye =
                camera.ray_through(camera.even_position({core::halton(0, i + 1), core::halton(1, i + 1)}));
            const RayQuery ray{eye.origin, eye.direction, std::numeric_limits<float>::infinity()};
            const Hit hit = posed_scene.tracer().nearest(ray.origin, ray.direction, ray.far);
            if (hit.found()) of_task[task].places.push_back(ray.origin + hit.distance * ray.direction);
            rays.follow(ray, hit, {}, Stream(Purpose::rays_of_view, {.index = i}), static_cast<std::uint32_t>(i),
                        of_task[task].terms, traced);
        }
    });
    std::vector<glm::vec3> places;
    std::vector<RayTerm> terms;
    for (const TaskView& part : of_task) {
        places.insert(places.end(), part.places.begin(), part.places.end());
        terms.insert(terms.end(), part.terms.begin(), part.terms.end());
    }
    std::vector<CellQuery> wanted;
    for (const RayTerm& term : terms) wanted.push_back(term.place);
    cache.learn({std::move(wanted)});
    std::vector<float> seen;
    for (const RayTerm& term : terms) {
        const float luminance = core::luminance(term.weight * cache.radiance(cache.index_of(term.place.key)));
        if (std::isfinite(luminance)) seen.push_back(luminance);
    }
    std::sort(seen.begin(), seen.end());
    return {std::move(places), seen.empty() ? 0.0f : seen[seen.size() / 2]};
}

std::vector<LightPoint> near_light(const PosedScene& posed_scene, std::span<const LightPoint> lights,
                                   std::span<const LightPoint> average, const NearField& near_field,
                                   std::uint64_t& rays) {
    if (near_field.empty()) return {};
    PlannedLights all(lights, average);
    favour_near(all.shining, near_field, world_box(posed_scene.posed()), all.planned);

    PhotonSettings settings;
    settings.paths = photon_paths;
    settings.planned = all.planned;
    PhotonResult photons = trace_photons(posed_scene, all.shining, settings);
    rays += photons.rays;
    std::vector<NearField::Part> parts(photons.vpls.size());
    parallel::for_each(parts.size(), [&](std::size_t i) { parts[i] = near_field.at(photons.vpls[i].position); });
    double power = 0;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        LightPoint& p = photons.vpls[i];
        // The surface that so much flux spreads over.
        p.disc2 = core::divide_or(core::luminance(p.intensity), parts[i].irradiance, 0.0f);
        p.intensity *= parts[i].share;
        power += static_cast<double>(core::luminance(p.intensity));
    }
    thin_out(power / most_near_points, photons.vpls);
    return photons.vpls;
}

}  // namespace render2mpeg::renderer
