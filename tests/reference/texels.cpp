#include "tests/reference/texels.h"

#include <algorithm>
#include <cmath>

namespace render2mpeg::reference {
namespace {

double linear_of(double code) {
    return code <= 0.04045 ? code / 12.92 : std::pow((code + 0.055) / 1.055, 2.4);
}

int wrapped(int i, int size, core::Wrap wrap) {
    if (wrap == core::Wrap::clamp_to_edge) return std::clamp(i, 0, size - 1);
    const int period = wrap == core::Wrap::repeat ? size : 2 * size;
    const int in_period = ((i % period) + period) % period;
    return in_period < size ? in_period : period - 1 - in_period;
}

}  // namespace

Texels::Texels(const image::Image& image, bool srgb) : width_(image.pixels.width()), height_(image.pixels.height()) {
    for (const glm::vec4& pixel : image.pixels.values()) {
        glm::dvec4 value(pixel);
        for (int c = 0; c < 3; ++c)
            if (srgb && !image.high_range) value[c] = linear_of(value[c]);
        values_.push_back(value);
    }
}

glm::dvec4 Texels::texel(int x, int y) const {
    return values_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)];
}

glm::dvec4 Texels::at(glm::dvec2 uv, core::Wrap wrap_u, core::Wrap wrap_v, bool nearest, bool covers) const {
    const double x = uv.x * width_ - (nearest ? 0.0 : 0.5), y = uv.y * height_ - (nearest ? 0.0 : 0.5);
    const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
    if (nearest) return texel(wrapped(x0, width_, wrap_u), wrapped(y0, height_, wrap_v));
    glm::dvec4 sum(0);
    for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i) {
            glm::dvec4 value = texel(wrapped(x0 + i, width_, wrap_u), wrapped(y0 + j, height_, wrap_v));
            if (covers) value = glm::dvec4(glm::dvec3(value) * value.a, value.a);
            sum += value * ((i == 0 ? x0 + 1 - x : x - x0) * (j == 0 ? y0 + 1 - y : y - y0));
        }
    return covers && sum.a > 0 ? glm::dvec4(glm::dvec3(sum) / sum.a, sum.a) : sum;
}

}  // namespace render2mpeg::reference
