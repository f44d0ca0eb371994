#include "renderer/truth/pixel_truth.h"

#include <algorithm>
#include <cmath>

#include "core/color.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "parallel/loops.h"
#include "renderer/base/flush_denormals.h"
#include "renderer/paths/light_paths.h"
#include "renderer/view/eye_path.h"

namespace render2mpeg::renderer {
namespace {

/// Independent parts of an estimate, whose spread tells its error. chosen: 16, by which it is known to a fifth.
constexpr std::uint64_t batches = 16;

/// Paths of a pilot, and the fewest of a batch: rare light that the pilot missed must not pass for none.
constexpr std::uint64_t pilot_paths = 256, least_paths = 32;

/// How far apart eye samples count as lying, in pixels: textures are filtered over so much.
constexpr float sample_spacing = 1.0f / 8;

double luminance_of(glm::dvec3 rgb) {
    return glm::dot(glm::dvec3(core::luminance_weights), rgb);
}

/// About what part of its weight a surface scatters: chances follow it.
float brightness(const SurfacePoint& p, glm::vec3 weight) {
    const float cosine = glm::dot(p.shading_normal, p.outgoing);
    return core::luminance(weight * (diffuse_albedo(p.bsdf, cosine) + glossy_albedo(p.bsdf, cosine)));
}

/// Where one of a point's shadow rays starts.
glm::vec3 origin_of(const Fragment& f, PathNumbers&) {
    return shadow_origin(f.point);
}
glm::vec3 origin_of(const GatherPoint& g, PathNumbers& numbers) {
    const std::size_t some = 1u + g.others, all = some + (g.more_places ? g.more_places->size() : 0);
    const auto place =
        std::min(static_cast<std::size_t>(numbers.first(FirstNumber::pixel_u) * static_cast<float>(all)), all - 1);
    if (place >= some) return (*g.more_places)[place - some];
    return place == 0 ? shadow_origin(g.point) : g.elsewhere[place - 1];
}

/// Radiance of one surface out of several, over the chance of its choice.
template <class Surfaces>
glm::vec3 one_of(const Surfaces& surfaces, const LightPaths& paths, PathNumbers& numbers) {
    float sum = 0;
    for (const auto& s : surfaces) sum += brightness(s.point, s.weight);
    float left = numbers.first(FirstNumber::fragment) * sum;
    for (const auto& s : surfaces) {
        const float own = brightness(s.point, s.weight);
        left -= own;
        if (own > 0.0f && (left < 0.0f || &s == &surfaces.back()))
            return s.weight * (sum / own) * paths.scattered(s.point, origin_of(s, numbers), numbers);
    }
    return glm::vec3(0);
}

/// Sums over the paths of a batch.
struct PathSums {
    glm::dvec3 at_points{0}, whole{0};
    double squares = 0, difference_squares = 0;  ///< of luminances of `whole`, and of it less `at_points`
};

/// What all pixels share.
class Estimator {
  public:
    Estimator(const PosedScene& posed_scene, const SeeSettings& see, const Plan& plan)
        : posed_scene_(posed_scene), eye_(posed_scene, see, plan), paths_(posed_scene, plan) {}

    /// What the pixel's own eye samples show without gathering, but for lobe rays.
    glm::vec3 shown_by_pattern(const TruthRequest& request) const {
        const std::vector<glm::vec2> pattern = sample_pattern(request.samples);
        glm::vec3 sum(0);
        const float spacing = 1.0f / std::sqrt(static_cast<float>(pattern.size()));
        EyeSample sample;
        for (const glm::vec2 offset : pattern) {
            look(glm::vec2(request.place) + offset, spacing, sample);
            sum += sample.emitted;
        }
        return sum / static_cast<float>(pattern.size()) + request.known;
    }

    PathSums follow(const TruthRequest& request, std::uint64_t batch, std::uint64_t count) const {
        const FlushDenormals flushed;
        PathSums sums;
        EyeSample sample;
        for (std::uint64_t i = 0; i < count; ++i) {
            PathNumbers for_points(batch, i), for_pixel(batch, i);
            const glm::dvec3 at_points(one_of(request.points, paths_, for_points));
            look(glm::vec2(request.place) + for_pixel.first(FirstNumber::pixel_u, FirstNumber::pixel_v), sample_spacing,
                 sample);
            glm::vec3 light = request.known + sample.emitted + one_of(sample.fragments, paths_, for_pixel);
            if (!core::is_finite(light)) light = glm::vec3(0);
            const glm::dvec3 whole(light);
            sums.at_points += at_points;
            sums.whole += whole;
            const double y = luminance_of(whole), difference = y - luminance_of(at_points);
            sums.squares += y * y;
            sums.difference_squares += difference * difference;
        }
        return sums;
    }

  private:
    void look(glm::vec2 position, float spacing, EyeSample& sample) const {
        float far = 0;
        const EyeRay ray = eye_ray(posed_scene_.posed().camera, position, spacing, far);
        SeeCounts uncounted;
        eye_.look(ray, far, posed_scene_.tracer().nearest(ray.origin, ray.direction, far), sample, uncounted);
    }

    const PosedScene& posed_scene_;
    EyePaths eye_;
    LightPaths paths_;
};

std::uint64_t seed_of(const TruthRequest& r, const TruthSettings& settings, std::int64_t frame, std::uint64_t batch) {
    const std::uint64_t pixel =
        std::uint64_t{static_cast<std::uint32_t>(r.place.y)} << 32 | static_cast<std::uint32_t>(r.place.x);
    return core::mix(core::mix(core::mix(settings.seed) ^ static_cast<std::uint64_t>(frame)) ^ pixel) +
           core::mix(batch);
}

/// Paths of each batch that the pilot's spread asks for.
std::uint64_t paths_of_batch(const PathSums& pilot, const TruthRequest& r, const TruthSettings& settings) {
    const auto n = static_cast<double>(pilot_paths);
    const double mean = luminance_of(pilot.whole) / n;
    double variance = std::max(pilot.squares / n - mean * mean, 0.0) * n / (n - 1);
    // Much less than expected: some light is so rare that the pilot missed it.
    const double missing = static_cast<double>(r.luminance) - mean;
    if (2 * missing > static_cast<double>(r.luminance)) variance = std::max(variance, n * missing * missing);
    const double error = static_cast<double>(settings.relative_error) * static_cast<double>(r.luminance);
    const auto least = static_cast<double>(least_paths),
               most = std::max(least, static_cast<double>(settings.most_paths / batches));
    const double wanted =
        variance > 0.0 ? core::divide_or(variance, error * error * static_cast<double>(batches), most) : least;
    return static_cast<std::uint64_t>(std::clamp(std::ceil(wanted), least, most));
}

Estimate estimate_of(const std::array<glm::dvec3, batches>& means, glm::dvec3 shown) {
    Estimate e;
    double sum = 0, squares = 0;
    for (std::size_t b = 0; b < batches; ++b) {
        e.halves[b % 2] += means[b] * (2.0 / batches);
        const double y = luminance_of(means[b]);
        sum += y;
        squares += y * y;
    }
    constexpr double n = batches;
    e.variance = std::max(squares / n - sum / n * (sum / n), 0.0) / (n - 1);
    for (glm::dvec3& half : e.halves) half += shown;
    return e;
}

}  // namespace

double Estimate::luminance_of(std::size_t half) const {
    return renderer::luminance_of(halves[half]);
}

std::vector<PixelTruth> pixel_truth(const PosedScene& posed_scene, const SeeSettings& see, const Plan& plan,
                                    std::span<const TruthRequest> requests, const TruthSettings& settings) {
    const Estimator estimator(posed_scene, see, plan);
    const std::int64_t frame = posed_scene.posed().frame;
    std::vector<std::uint64_t> paths(requests.size());
    std::vector<glm::dvec3> shown(requests.size());
    parallel::for_each(requests.size(), [&](std::size_t i) {
        const PathSums pilot =
            estimator.follow(requests[i], seed_of(requests[i], settings, frame, batches), pilot_paths);
        paths[i] = paths_of_batch(pilot, requests[i], settings);
        const glm::vec3 sum = estimator.shown_by_pattern(requests[i]);
        shown[i] = core::is_finite(sum) ? glm::dvec3(sum) : glm::dvec3(0);
    });
    using Means = std::array<glm::dvec3, batches>;
    std::vector<Means> at_points(requests.size()), whole(requests.size());
    parallel::for_each(requests.size() * batches, [&](std::size_t k) {
        const std::size_t i = k / batches, b = k % batches;
        const PathSums sums = estimator.follow(requests[i], seed_of(requests[i], settings, frame, b), paths[i]);
        at_points[i][b] = sums.at_points / static_cast<double>(paths[i]);
        whole[i][b] = sums.whole / static_cast<double>(paths[i]);
    });
    std::vector<PixelTruth> truth;
    for (std::size_t i = 0; i < requests.size(); ++i)
        truth.push_back(
            {estimate_of(at_points[i], shown[i]), estimate_of(whole[i], glm::dvec3(0)), batches * paths[i]});
    return truth;
}

}  // namespace render2mpeg::renderer
