#pragma once
// False-colour pictures with a legend.
#include <string>
#include <vector>

#include "core/picture.h"
#include "core/plane.h"
#include "perceptual/display.h"

namespace render2mpeg::perceptual {

/// Quantity shown by a false-colour picture, and the text of its legend.
struct HeatScale {
    std::string title;         ///< letters A-Z, digits, spaces and . % / - : ( ); others are left blank
    float low = 0, high = 1;   ///< of the colours' ends; values beyond get the end's colour
    bool logarithmic = false;  ///< then 0 < low < high
    struct Mark {
        float value;
        std::string text;
    };
    std::vector<Mark> marks;  ///< on the legend's bar, ascending
};

/// Lines that the legend adds below a picture.
inline constexpr int legend_height = 32;

/// Black over blue, red and yellow to white, with rising luma, so that the order shows without colour. Not finite:
/// grey. R', G', B' in 0..1.
glm::vec3 heat_color(float value, const HeatScale& scale);

/// The values with a legend below: width by height + legend_height. Words of the title that do not fit are dropped; a
/// long first one is cut.
core::Picture heatmap(const core::Plane<float>& values, const HeatScale& scale, ColorMatrix matrix);

}  // namespace render2mpeg::perceptual
