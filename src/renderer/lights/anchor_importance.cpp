#include "renderer/lights/anchor_importance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/numeric.h"
#include "parallel/loops.h"
#include "renderer/base/stream.h"
#include "renderer/lights/light_points.h"

namespace render2mpeg::renderer {
namespace {

/// Seen points that each place is held against. chosen: 8, since a stratum of an anchor holds some 16 places.
constexpr int looks = 8;

/// Places nearer to a seen point than this share of the usual distance count as if they were there: one pair must not
/// outweigh all others. chosen: a tenth.
constexpr double nearest_share = 0.1;

/// Geometry between a place and a seen point: both cosines, and the squared distance; 0 where something is between.
struct Look {
    float cosines = 0, distance2 = 0;
};

Look look(const LightPoint& from, const SeenPoint& to, const RayTracer& tracer) {
    const glm::vec3 way = to.position - from.position;
    const float distance2 = glm::dot(way, way);
    if (!(distance2 > 0.0f) || !std::isfinite(distance2)) return {};
    const float distance = std::sqrt(distance2);
    const glm::vec3 direction = way / distance;
    const float cosines =
        std::max(0.0f, glm::dot(direction, from.normal)) * std::max(0.0f, -glm::dot(direction, to.normal));
    if (cosines <= 0.0f || tracer.meets(from.position, direction, 0.999f * distance)) return {};
    return {cosines, distance2};
}

/// The geometric mean of the squared distances that light passes; 0: it passes none.
double usual_distance2(std::span<const Look> looked) {
    double logs = 0, passed = 0;
    for (const Look& l : looked) {
        if (l.cosines <= 0.0f) continue;
        logs += std::log(static_cast<double>(l.distance2));
        passed += 1;
    }
    return passed > 0 ? std::exp(logs / passed) : 0.0;
}

}  // namespace

std::vector<SeenPoint> seen_points(const PosedScene& posed_scene) {
    const scene::Camera& camera = posed_scene.posed().camera;
    std::vector<SeenPoint> seen;
    for (int y = 0; y < importance_format.height; ++y)
        for (int x = 0; x < importance_format.width; ++x) {
            const scene::Ray ray = camera.ray_through(camera.even_position((glm::vec2(x, y) + 0.5f) / camera.size()));
            const Hit hit =
                posed_scene.tracer().nearest(ray.origin, ray.direction, std::numeric_limits<float>::infinity());
            if (!hit.found()) continue;
            const SurfacePoint p = posed_scene.surface_at(hit.address, -ray.direction);
            seen.push_back({offset_origin(p, p.geometric_normal), p.geometric_normal});
        }
    return seen;
}

scene::Snapshot importance_instant(const scene::Animation& film, int i, int count) {
    const auto microseconds = static_cast<std::int64_t>(1e6 * film.duration * (i + 0.5) / count);
    const std::size_t shots = film.shots.size();
    const std::int64_t frame =
        shots == 0 ? 0 : film.shots[static_cast<std::size_t>(i) * shots / static_cast<std::size_t>(count)].frame;
    return with_average_light(scene::snapshot_at(film, frame, {microseconds, 1000000}, importance_format));
}

std::vector<float> EyeImportance::of(const PosedScene& posed_scene, std::span<const LightPoint> places) {
    std::vector<float> importance(places.size(), 1.0f);
    const std::vector<SeenPoint> seen = seen_points(posed_scene);
    if (seen.empty()) return importance;

    std::vector<Look> looked(places.size() * looks);
    parallel::for_ranges(places.size(), 256, [&](std::size_t first, std::size_t last) {
        const Stream numbers(Purpose::looks_of_anchors);
        for (std::size_t i = first; i < last; ++i)
            for (std::uint64_t k = 0; k < looks; ++k) {
                const float choice = numbers.uniform(i, k) * static_cast<float>(seen.size());
                const auto index = std::min(seen.size() - 1, static_cast<std::size_t>(choice));
                looked[i * looks + k] = look(places[i], seen[index], posed_scene.tracer());
            }
    });

    if (near2_ == 0) near2_ = usual_distance2(looked) * nearest_share * nearest_share;
    if (near2_ == 0) return importance;
    std::vector<double> sum(places.size(), 0);
    double mean = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
        for (std::size_t k = 0; k < looks; ++k) {
            const Look& l = looked[i * looks + k];
            sum[i] += l.cosines / (static_cast<double>(l.distance2) + near2_);
        }
        mean += sum[i] / static_cast<double>(places.size());
    }
    if (mean_ == 0) mean_ = mean;
    for (std::size_t i = 0; i < places.size(); ++i)
        importance[i] = least + (1.0f - least) * static_cast<float>(core::divide_or(sum[i], mean_, 1.0));
    return importance;
}

}  // namespace render2mpeg::renderer
