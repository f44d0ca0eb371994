#include "renderer/judge.h"

#include <algorithm>

#include "core/color.h"
#include "renderer/air/airlight.h"
#include "renderer/calibration/audit.h"
#include "renderer/caustics/caustics.h"

namespace render2mpeg::renderer {

std::vector<JudgedPixel> judge_pixels(const LitFrame& frame, const SeeSettings& see, const Plan& plan,
                                      std::span<const AuditedPixel> audited, const TruthSettings& finely) {
    const Seen& seen = frame.seen;
    std::vector<JudgedPixel> judged;
    std::vector<TruthRequest> requests;
    for (const AuditedPixel& a : audited) {
        const LitPixel pixel = pixel_at(seen, {a.x, a.y});
        JudgedPixel& p = judged.emplace_back();
        p.shown = frame.radiance.combined.at(a.x, a.y), p.where_lit = p.at_points = a.radiance;
        if (!frame.tolerance.is_reference()) p.least = frame.tolerance.pixels.at(a.x, a.y).absolute;
        if (any_moved(frame.moved, pixel))
            p.at_points = gather_exactly(frame.light_trees, frame.posed_scene.tracer(), seen, {pixel}).front();
        const std::span<const GatherPoint> points(seen.tiles[pixel.tile]);
        requests.push_back({{a.x, a.y},
                            points.subspan(pixel.first, pixel.last - pixel.first),
                            std::max(core::luminance(p.at_points), p.least),
                            seen.samples.empty() ? see.samples : seen.samples.at(a.x, a.y),
                            caustic_light_at(seen, {a.x, a.y}) + airlight_at(seen, {a.x, a.y})});
    }
    std::size_t k = 0;
    for (const PixelTruth& t : pixel_truth(frame.posed_scene, see, plan, requests, finely)) judged[k++].truth = t;
    return judged;
}

}  // namespace render2mpeg::renderer
