#include "renderer/lights/even_points.h"

#include <algorithm>
#include <cmath>

#include "core/sampling.h"
#include "parallel/loops.h"
#include "renderer/base/stream.h"

namespace render2mpeg::renderer {
namespace {

double area_of(const scene::Snapshot& now, std::uint32_t object, std::uint32_t primitive) {
    const scene::Triangle t = scene::triangle_of(now, object, primitive);
    const float area = 0.5f * glm::length(glm::cross(t.b - t.a, t.c - t.a));
    return std::isfinite(area) ? area : 0.0;
}

std::uint32_t triangles_of(const scene::Animation& film, std::uint32_t object) {
    return static_cast<std::uint32_t>(
        film.meshes[static_cast<std::size_t>(film.objects[object].mesh)].triangles.size());
}

bool has_two_sides(const scene::Animation& film, std::uint32_t object) {
    return film.materials[static_cast<std::size_t>(film.objects[object].material)].double_sided;
}

/// World area of each still object; 0 for all others.
std::vector<double> still_areas(const scene::Snapshot& now) {
    const scene::Animation& film = *now.animation;
    std::vector<double> areas(film.objects.size(), 0.0);
    parallel::for_each(areas.size(), [&](std::size_t i) {
        const auto object = static_cast<std::uint32_t>(i);
        if (film.objects[i].mobility != scene::Mobility::still || !now.objects[i].present) return;
        if (film.materials[static_cast<std::size_t>(film.objects[i].material)].unlit) return;
        for (std::uint32_t t = 0; t < triangles_of(film, object); ++t) areas[i] += area_of(now, object, t);
    });
    return areas;
}

/// Whether a place is open: light that comes to its neighbours comes to it as well. What lies under a carpet, or within
/// a wall, faces as they do and would take their light where nobody sees it. chosen: 2 of 8 rays must get farther than
/// an anchor looks over its surface; in a corner 3 or 4 do, in a gap of a tenth of that way one of a hundred.
bool is_open(const PosedScene& posed_scene, const SurfacePoint& p, std::uint64_t index, float farther) {
    constexpr int rays = 8, least = 2;
    const glm::vec3 from = offset_origin(p, p.geometric_normal);
    const Stream numbers(Purpose::open_directions, {.index = index});
    int free = 0;
    for (std::uint64_t k = 0; k < rays && free < least; ++k) {
        const glm::vec3 way =
            core::sample_cosine_hemisphere(p.geometric_normal, {numbers.uniform(2 * k), numbers.uniform(2 * k + 1)});
        free += posed_scene.tracer().meets_static(from, way, farther) ? 0 : 1;
    }
    return free >= least;
}

}  // namespace

std::vector<SurfacePoint> even_points(const PosedScene& posed_scene, std::size_t count) {
    const scene::Snapshot& now = posed_scene.posed();
    const std::vector<double> areas = still_areas(now);
    double all = 0;
    for (const double a : areas) all += a;
    std::vector<SurfacePoint> points;
    if (!(all > 0.0) || !std::isfinite(all) || count == 0) return points;

    // Walk over all surface once and take a point at each `step` of area.
    const double step = all / static_cast<double>(count);
    const auto farther = static_cast<float>(2.0 * std::sqrt(step));
    double passed = 0, next = 0.5 * step;
    std::uint64_t index = 0;
    for (std::uint32_t object = 0; object < areas.size(); ++object) {
        const double end = passed + areas[object];
        double within = passed;
        for (std::uint32_t t = 0; next < end && t < triangles_of(*now.animation, object); ++t) {
            within += area_of(now, object, t);
            for (; next < within; next += step, ++index) {
                const float root = std::sqrt(core::halton(0, index)), v = core::halton(1, index);
                const glm::vec3 front = posed_scene.front_normal(object, t);
                const bool is_front =
                    !has_two_sides(*now.animation, object) || Stream(Purpose::sides_of_faces).uniform(index) < 0.5f;
                const SurfacePoint p =
                    posed_scene.surface_at({object, t, 1.0f - root, root * v}, is_front ? front : -front);
                if (p.alpha > 0.0f && !p.unlit && (p.bsdf.has_diffuse() || p.bsdf.has_glossy()) &&
                    is_open(posed_scene, p, index, farther))
                    points.push_back(p);
            }
        }
        passed = end;
    }
    return points;
}

}  // namespace render2mpeg::renderer
