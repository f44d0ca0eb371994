#pragma once
// The border type of pictures: Y'CbCr 4:2:0 in display order.
#include <algorithm>
#include <cstdint>

#include "core/plane.h"

namespace render2mpeg::core {

/// How bright pictures are on a display that shows them with known light, cd/m^2: [CTA861, annex P].
struct LightLevel {
    float most = 0;  ///< of the largest channel over pixels, of pictures over them (MaxCLL); 0: not known
    float mean = 0;  ///< its mean over a picture, of pictures the largest (MaxFALL)

    bool operator==(const LightLevel&) const = default;
    void operator+=(const LightLevel& other) {
        most = std::max(most, other.most);
        mean = std::max(mean, other.mean);
    }
};

/// Chroma that pictures keep before rounding, beside their own.
enum class ExactChroma : std::uint8_t {
    none,
    halved,  ///< of 4:2:0: codecs of ten bits
    full     ///< at every pixel: codecs of 4:2:2 and 4:4:4
};

/// A picture in display order: 8-bit Y'CbCr 4:2:0, limited range (luma 16..235, chroma 16..240), chroma sited as in
/// MPEG-2; chroma planes have (w + 1) / 2 by (h + 1) / 2 samples.
struct Picture {
    std::int64_t number = 0;  ///< display number, from 0
    Plane<std::uint8_t> y, cb, cr;
    /// Luma before rounding, in code values: input of the visibility model. Empty for decoded pictures.
    Plane<float> luma;
    /// Cb and Cr before rounding, code values, as ExactChroma says.
    Plane<float> exact_cb, exact_cr;
    Plane<float> alpha;  ///< coverage, 0..1, which colours are not multiplied by; empty: 1 throughout
    LightLevel level;    ///< of views that say how much light is shown

    int width() const { return y.width(); }
    int height() const { return y.height(); }
};

}  // namespace render2mpeg::core
