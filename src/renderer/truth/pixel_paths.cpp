#include "renderer/truth/pixel_paths.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/color.h"
#include "renderer/base/flush_denormals.h"

namespace render2mpeg::renderer {
namespace {

/// How far apart eye samples count as lying, in pixels: textures are filtered over so much.
constexpr float sample_spacing = 1.0f / 8;

double luminance_of(glm::dvec3 rgb) {
    return glm::dot(glm::dvec3(core::luminance_weights), rgb);
}

/// Share of its weight that a surface scatters, about: chances follow it.
float brightness(const SurfacePoint& p, glm::vec3 weight) {
    const float cosine = glm::dot(p.shading_normal, p.outgoing);
    if (p.fibre) return core::luminance(weight);
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

}  // namespace

glm::vec3 PixelPaths::shown_by_pattern(const TruthRequest& request) const {
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

PathSums PixelPaths::follow(const TruthRequest& request, const Stream& batch, std::uint64_t count) const {
    const FlushDenormals flushed;
    PathSums sums;
    EyeSample sample;
    for (std::uint64_t i = 0; i < count; ++i) {
        PathNumbers for_points(batch, i), for_pixel(batch, i);
        look(glm::vec2(request.place) + for_pixel.first(FirstNumber::pixel_u, FirstNumber::pixel_v), sample_spacing,
             sample);
        glm::vec3 light = request.known + sample.emitted + one_of(sample.fragments, paths_, for_pixel);
        if (!core::is_finite(light)) light = glm::vec3(0);
        const glm::dvec3 whole(light);
        sums.at_points += glm::dvec3(one_of(request.points, paths_, for_points));
        sums.whole += whole;
        const double y = luminance_of(whole);
        sums.squares += y * y;
    }
    return sums;
}

void PixelPaths::look(glm::vec2 position, float spacing, EyeSample& sample) const {
    float far = 0;
    const EyeRay ray = eye_ray(posed_scene_.posed().camera, position, spacing, far);
    SeeCounts uncounted;
    eye_.look(ray, far, ray.meet(posed_scene_, far), sample, uncounted);
}

double Estimate::luminance_of(std::size_t half) const {
    return renderer::luminance_of(halves[half]);
}

Estimate estimate_of(const std::array<glm::dvec3, truth_batches>& means, glm::dvec3 added) {
    Estimate e;
    double sum = 0, squares = 0;
    for (std::size_t b = 0; b < truth_batches; ++b) {
        e.halves[b % 2] += means[b] * (2.0 / truth_batches);
        const double y = luminance_of(means[b]);
        sum += y;
        squares += y * y;
    }
    constexpr double n = truth_batches;
    e.variance = std::max(squares / n - sum / n * (sum / n), 0.0) / (n - 1);
    for (glm::dvec3& half : e.halves) half += added;
    return e;
}

}  // namespace render2mpeg::renderer
