#include "renderer/validation.h"

#include <algorithm>

#include "core/color.h"
#include "core/numeric.h"

namespace render2mpeg::renderer {

glm::vec3 light_of_bodies_and_air(const UngatheredLight& ungathered, int x, int y) {
    return value_or_zero(ungathered.caustics().all, x, y) + value_or_zero(ungathered.air().all, x, y);
}

std::vector<glm::vec3> exact_pixels(const AuditedFrame& frame, const std::vector<LitPixel>& pixels) {
    std::vector<glm::vec3> light = gather_exactly(frame.context, pixels);
    if (frame.rays == nullptr) return light;
    std::vector<GatherPoint> points;
    std::vector<std::size_t> of_pixel;
    for (std::size_t k = 0; k < pixels.size(); ++k)
        for (std::uint32_t i = pixels[k].first; i < pixels[k].last; ++i) {
            points.push_back(frame.context.seen.tiles[pixels[k].tile][i]);
            of_pixel.push_back(k);
        }
    const std::vector<glm::vec3> more =
        exact_rays(*frame.rays, frame.posed_scene.posed().camera, points, of_pixel, pixels.size(), *frame.rays_of);
    for (std::size_t k = 0; k < light.size(); ++k)
        if (core::is_finite(more[k])) light[k] += more[k];
    return light;
}

std::vector<ValidatedPixel> validate_pixels(const AuditedFrame& frame, const SeeSettings& see, const Plan& plan,
                                            std::span<const AuditedPixel> audited, const TruthSettings& finely) {
    const Frame& seen = frame.context.seen;
    const core::ToleranceMap& tolerance = frame.context.tolerance;
    std::vector<ValidatedPixel> validated;
    std::vector<TruthRequest> requests;
    for (const AuditedPixel& a : audited) {
        const LitPixel pixel = pixel_at(seen, {a.x, a.y});
        ValidatedPixel& p = validated.emplace_back();
        p.place = {a.x, a.y};
        p.shown = frame.radiance.combined.at(a.x, a.y), p.at_points = a.radiance;
        if (!tolerance.is_reference()) p.least = tolerance.pixels.at(a.x, a.y).absolute;
        const std::span<const GatherPoint> points(seen.tiles[pixel.tile]);
        requests.push_back({{a.x, a.y},
                            points.subspan(pixel.first, pixel.last - pixel.first),
                            std::max(core::luminance(p.at_points), p.least),
                            seen.samples.empty() ? see.samples : seen.samples.at(a.x, a.y),
                            light_of_bodies_and_air(frame.context.ungathered, a.x, a.y)});
    }
    std::size_t k = 0;
    for (const PixelTruth& t : pixel_truth(frame.posed_scene, see, plan, requests, finely)) validated[k++].truth = t;
    return validated;
}

}  // namespace render2mpeg::renderer
