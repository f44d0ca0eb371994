#include "app/estimate/first_pass.h"

#include <algorithm>
#include <cmath>

#include "app/loop/pipeline.h"
#include "app/loop/sample.h"
#include "app/system/progress.h"
#include "encoder/codec.h"

namespace render2mpeg::app {
namespace {

/// Sides of the first pass's pictures are a fourth of the film's.
/// chosen: 1/4; half the sides cost three times the light and find the same shares within a few per cent.
constexpr double shrink = 0.25;

/// Bits of the film's pictures over those of the first pass at the same quantiser: more pixels, but each told more by
/// its neighbours. Only the first pictures of a chunk depend on it; then their own sizes are known.
/// fit: docs/measurements.md#rates
constexpr double size_ratio = 7;

/// The ratio for passes that are less than 4x4 smaller.
double size_ratio_of(const RenderJob& film, const RenderJob& pass) {
    return std::pow(size_ratio,
                    std::log(area_of(film.size()) / area_of(pass.size())) / std::log(1 / (shrink * shrink)));
}

RenderJob small(const RenderJob& film) {
    RenderJob pass = resized(film, shrink);
    pass.rendering.samples = 1;
    pass.rendering.edge_samples = pass.rendering.most_samples = 0;
    pass.rendering.calibrate = false;  // nothing is promised of its light
    // chosen: textures, edges and motion make most of the bits, not the last light points.
    pass.rendering.vpls = std::min(film.rendering.vpls, 2048);
    pass.rough = true;
    pass.tolerance = {};
    pass.tolerance.relative = 0.2f;
    pass.coding = rough(pass.coding, usual_quantiser(film.coding));
    return pass;
}

}  // namespace

int usual_quantiser(const encoder::Settings& settings) {
    const double samples = static_cast<double>(settings.width) * settings.height * settings.rate.hertz.value();
    const double density = static_cast<double>(settings.rate_control.bit_rate) / samples;
    // chosen: walks need 0.8 bits per sample at quantiser 1, and about 1 / quantiser of it at others
    // (docs/measurements.md#rates); the ends are where films seldom are.
    return std::clamp(static_cast<int>(std::lround(0.8 / std::max(density, 1e-3))), 2, 24);
}

encoder::Settings rough(encoder::Settings coding, double quantiser) {
    // Other codecs' efforts differ more in bits than in time.
    if (coding.codec == encoder::Codec::mpeg2) coding.effort = encoder::Effort::fast;
    coding.rate_control = {};
    coding.quantiser = static_cast<int>(std::lround(encoder::quantiser_like(coding.codec, quantiser)));
    return coding;
}

std::vector<encoder::BitAllocation> first_pass(const RenderJob& film, bool quiet) {
    const RenderJob pass = small(film);
    Progress progress(film.frame_count(), quiet, "first pass", Counted::frames_of_step);
    FirstPassCollector collector(pass.coding);
    RunStatistics statistics;
    if (!render_through(pass, collector, statistics, advancing(progress))) return {};
    return encoder::allocate_bits(film.coding, collector.film(), size_ratio_of(film, pass));
}

}  // namespace render2mpeg::app
