#include "perceptual/exposure.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "perceptual/display.h"

namespace render2mpeg::perceptual {
namespace {

std::vector<float> lit_of(std::span<const float> luminances) {
    std::vector<float> lit;
    for (const float luminance : luminances)
        if (luminance > 0.0f && std::isfinite(luminance)) lit.push_back(luminance);
    return lit;
}

}  // namespace

float auto_exposure(std::span<const float> surfaces, std::span<const float> sky) {
    std::vector<float> lit = lit_of(surfaces);
    // chosen: 1/20 of what is lit, between a bird before the sky (1/100) and the land below a high horizon (1/5).
    const std::vector<float> lit_sky = lit_of(sky);
    if (lit.size() * 19 < lit_sky.size()) lit.insert(lit.end(), lit_sky.begin(), lit_sky.end());
    if (lit.empty()) return 0.0f;
    std::sort(lit.begin(), lit.end());

    // Leave out what no exposure that suits the bright samples could show: mid grey lies 7.5 stops above the first code
    // value, and bright samples some 2.5 above mid grey. chosen: ten stops below the 90th percentile, tried 6 .. 14
    // with a third of the samples in unlit corners: 6 leaves out what is seen, 12 is led 0.9 EV astray by what is
    // black.
    const float bright = lit[(lit.size() - 1) * 9 / 10];
    const auto first = std::lower_bound(lit.begin(), lit.end(), bright / 1024.0f);

    // Average the logarithms [Reinhard2002, eq. 1] over the middle half. chosen: a quarter off either end, tried 0 ..
    // 0.4: without, lamps and shadows decide (0.3 EV on animations/colonnade); more is the median, blind to the rest.
    const auto count = static_cast<std::size_t>(lit.end() - first);
    const std::size_t begin = count / 4, end = count - begin;
    double sum = 0.0;
    for (std::size_t i = begin; i < end; ++i)
        sum += std::log2(static_cast<double>(first[static_cast<std::ptrdiff_t>(i)]));
    const double key = std::log2(0.18);  // [Reinhard2002, eq. 2]: their usual key
    const auto exposure = static_cast<float>(key - sum / static_cast<double>(end - begin));
    return std::clamp(exposure, -Display::max_exposure, Display::max_exposure);
}

}  // namespace render2mpeg::perceptual
