#include "image/stored_image.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace render2mpeg::image {
namespace {

/// Whether the image came from 8 bits per channel: every value is a multiple of 1/255 but for the rounding of a float.
bool fits_in_8_bits(const Image& image) {
    const auto values = image.pixels.values();
    return !image.high_range && std::all_of(values.begin(), values.end(), [](const glm::vec4& p) {
        for (int c = 0; c < 4; ++c) {
            const float code = p[c] * 255.0f;
            if (!(code >= 0.0f && code <= 255.0f) || std::abs(code - std::nearbyint(code)) > 1e-3f) return false;
        }
        return true;
    });
}

Codes codes_of(const glm::vec4& value) {
    Codes codes;
    for (int c = 0; c < 4; ++c) codes.rgba[c] = static_cast<std::uint8_t>(std::nearbyint(value[c] * 255.0f));
    return codes;
}

}  // namespace

StoredImage::StoredImage(const Image& image)
    : width(image.pixels.width()),
      height(image.pixels.height()),
      has_alpha(image.has_alpha),
      high_range(image.high_range),
      pixel_aspect(image.pixel_aspect),
      values(image.pixels.values()) {
    if (!fits_in_8_bits(image)) return;
    const auto room = std::make_shared<std::vector<Codes>>(values.size());
    std::transform(values.begin(), values.end(), room->begin(), codes_of);
    codes = *room;
    memory = room;
    values = {};
}

std::size_t count_non_finite(const StoredImage& image) {
    std::size_t count = 0;
    for (const glm::vec4& p : image.values)
        for (int c = 0; c < 3; ++c) count += std::isfinite(p[c]) ? 0 : 1;
    return count;
}

}  // namespace render2mpeg::image
