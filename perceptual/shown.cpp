#include "perceptual/shown.h"

#include <algorithm>
#include <cmath>

namespace render2mpeg::perceptual {
namespace {

/// Chroma at a luma sample: on the even columns, and between each two rows.
float chroma_at(const core::Plane<std::uint8_t>& plane, int x, int y) {
    const int left = x / 2, right = std::min(left + x % 2, plane.width() - 1);
    const int near = y / 2, far = std::clamp(y % 2 == 0 ? near - 1 : near + 1, 0, plane.height() - 1);
    const auto mean = [&](int row) { return 0.5f * (plane.at(left, row) + plane.at(right, row)); };
    return 0.75f * mean(near) + 0.25f * mean(far) - 128.0f;
}

}  // namespace

std::vector<std::uint8_t> shown_rgb(const core::Picture& picture, ColorMatrix matrix) {
    // [BT709, 3.4] and [BT601, 2.5.3], turned around.
    const glm::vec3 weight = luma_weights(matrix);
    const float blue_scale = (1 - weight.z) / 112, red_scale = (1 - weight.x) / 112;
    std::vector<std::uint8_t> codes;
    codes.reserve(3 * picture.y.size());
    for (int y = 0; y < picture.height(); ++y)
        for (int x = 0; x < picture.width(); ++x) {
            const float luma = (static_cast<float>(picture.y.at(x, y)) - 16) / 219;
            const float blue = luma + blue_scale * chroma_at(picture.cb, x, y);
            const float red = luma + red_scale * chroma_at(picture.cr, x, y);
            const float green = (luma - weight.x * red - weight.z * blue) / weight.y;
            for (const float signal : {red, green, blue})
                codes.push_back(static_cast<std::uint8_t>(std::lround(255 * std::clamp(signal, 0.0f, 1.0f))));
        }
    return codes;
}

}  // namespace render2mpeg::perceptual
