// Where light of the sky comes from that cameras see.
#include "renderer/lights/light_points.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <vector>

#include "core/numeric.h"
#include "core/plane.h"
#include "core/sampling.h"
#include "parallel/loops.h"

namespace render2mpeg::renderer {
namespace {

/// Picture format of the cameras that look: few rays serve.
constexpr scene::PictureFormat importance_format{24, 14, 1.0f};

/// Instants of the film that are looked at, and rays from each point that is seen there. chosen: 16 and 16; with 86,000
/// rays a window of a hundredth of the sky still gets hundreds.
constexpr int sky_instants = 16, rays_of_each = 16;

/// Of the rays from what is seen so many leave the scene at once under an open sky. chosen: a quarter; a room's windows
/// take a few of a hundred.
constexpr double open_share = 0.25;

/// Of all light the share that is divided evenly: what is not seen lights what is, over more bounces. chosen: a fifth,
/// as photons' (EmissionGuide).
constexpr float even_sky_share = 0.2f;

/// Light by one bounce counts so much as direct light. chosen: a half, the albedo of most things.
constexpr float of_bounce = 0.5f;

/// A place that a camera sees, off its surface.
struct SeenPoint {
    glm::vec3 position, normal;
};

/// Points seen by the camera of the posed instant: one for each of its pixels that shows a surface.
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

/// The film at one of `count` instants spread over it, its lights at their average strength, its camera one of its
/// shots'.
scene::Snapshot importance_instant(const scene::Animation& film, int i, int count) {
    const auto microseconds = static_cast<std::int64_t>(1e6 * film.duration * (i + 0.5) / count);
    const std::size_t shots = film.shots.size();
    const std::int64_t frame =
        shots == 0 ? 0 : film.shots[static_cast<std::size_t>(i) * shots / static_cast<std::size_t>(count)].frame;
    return with_average_light(scene::snapshot_at(film, frame, {microseconds, 1000000}, importance_format));
}

/// The sphere in bands of equal solid angle.
class Directions {
  public:
    void add(glm::vec3 direction, float weight) { sums_.at(column(direction), row(direction)) += weight; }

    /// Each over the mean of all, noise smoothed by its neighbours; false where none was added.
    bool finish() {
        double sum = 0;
        for (const float s : sums_.values()) sum += s;
        if (!(sum > 0)) return false;
        const auto mean = static_cast<float>(sum / (columns * rows));
        core::Plane<float> smooth(columns, rows);
        for (int y = 0; y < rows; ++y)
            for (int x = 0; x < columns; ++x) {
                float near = 0;
                for (int j = -1; j <= 1; ++j)
                    for (int i = -1; i <= 1; ++i)
                        near += sums_.at((x + i + columns) % columns, std::clamp(y + j, 0, rows - 1));
                smooth.at(x, y) = even_sky_share + (1.0f - even_sky_share) * near / (9.0f * mean);
            }
        sums_ = std::move(smooth);
        return true;
    }
    float operator()(glm::vec3 direction) const { return sums_.at(column(direction), row(direction)); }

  private:
    /// chosen: 64 and 32, cells of 5.6 degrees at the horizon: windows are larger.
    static constexpr int columns = 64, rows = 32;

    static int column(glm::vec3 d) {
        const float turn = 0.5f + std::atan2(d.x, -d.z) / (2 * std::numbers::pi_v<float>);
        return std::clamp(static_cast<int>(turn * columns), 0, columns - 1);
    }
    static int row(glm::vec3 d) { return std::clamp(static_cast<int>((0.5f - 0.5f * d.y) * rows), 0, rows - 1); }

    core::Plane<float> sums_{columns, rows, 0.0f};
};

/// Where a ray from a seen point leaves the scene, at once or after one bounce; weight 0: it does not.
struct Escape {
    glm::vec3 direction{0, 1, 0};
    float weight = 0;
};

Escape escape(const PosedScene& posed_scene, const SeenPoint& from, std::uint64_t index, std::uint64_t& rays) {
    glm::vec3 origin = from.position, normal = from.normal;
    float weight = 1;
    for (int bounce = 0; bounce < 2; ++bounce) {
        const glm::vec3 direction = core::sample_cosine_hemisphere(
            normal, {core::halton(2 * bounce, index), core::halton(2 * bounce + 1, index)});
        ++rays;
        const Hit hit = posed_scene.tracer().nearest(origin, direction, std::numeric_limits<float>::infinity());
        if (!hit.found()) return {direction, weight};
        const SurfacePoint p = posed_scene.surface_at(hit.address, -direction);
        origin = offset_origin(p, p.geometric_normal);
        normal = p.geometric_normal;
        weight *= of_bounce;
    }
    return {};
}

}  // namespace

image::SkyImportance sky_importance(PosedScene& posed_scene, std::uint64_t& rays) {
    const auto directions = std::make_shared<Directions>();
    const scene::Animation& film = posed_scene.animation();
    const int count = film.duration > 0.0 ? sky_instants : 1;
    double left = 0, asked = 0;
    for (int i = 0; i < count; ++i) {
        const scene::Snapshot instant = importance_instant(film, i, count);
        posed_scene.pose(instant);
        const std::vector<SeenPoint> seen = seen_points(posed_scene);
        std::vector<Escape> escapes(seen.size() * rays_of_each);
        std::vector<std::uint64_t> traced(escapes.size(), 0);
        parallel::for_ranges(escapes.size(), 256, [&](std::size_t first, std::size_t last) {
            for (std::size_t k = first; k < last; ++k)
                escapes[k] = escape(posed_scene, seen[k / rays_of_each],
                                    1 + k + static_cast<std::size_t>(i) * escapes.size(), traced[k]);
        });
        for (const Escape& e : escapes) {
            directions->add(e.direction, e.weight);
            left += e.weight == 1.0f ? 1 : 0;
        }
        asked += static_cast<double>(escapes.size());
        for (const std::uint64_t n : traced) rays += n;
    }
    if (left > open_share * asked || !directions->finish()) return {};
    return [directions](glm::vec3 direction) { return (*directions)(direction); };
}

}  // namespace render2mpeg::renderer
