#include "renderer/base/light_packing.h"

#include <algorithm>
#include <cmath>

namespace render2mpeg::renderer {
namespace {

/// The exponent of a float's lowest normal step, as it is stored, and its bias.
constexpr int least_exponent = 1, bias = 127;

/// The most that there is of a channel: 65535 of the steps beyond which the next is infinite.
constexpr float most_light = 0x1.fffep127f;

}  // namespace

PackedLight::PackedLight(const glm::vec3& given) {
    glm::vec3 light;
    for (int c = 0; c < 3; ++c) light[c] = given[c] < most_light ? given[c] : most_light;
    int above = 0;
    std::frexp(std::max({light.x, light.y, light.z}), &above);
    // The largest channel has all 16 bits, unless rounding it up takes a seventeenth.
    for (int exponent = std::max(above - 16 + bias, least_exponent);; ++exponent) {
        bool fits = true;
        for (int c = 0; c < 3; ++c) {
            const float steps = std::ceil(std::ldexp(light[c], bias - exponent));
            fits = fits && steps <= 65535.0f;
            channel_[c] = static_cast<std::uint16_t>(std::min(steps, 65535.0f));
        }
        exponent_ = static_cast<std::uint16_t>(exponent);
        if (fits) return;
    }
}

BoxGrid::BoxGrid(const glm::vec3& low, const glm::vec3& high) {
    for (int axis = 0; axis < 3; ++axis) {
        low_[axis] = low[axis];
        const float extent = high[axis] - low[axis];
        if (!(extent > 0.0f)) continue;
        // Room for what is rounded outwards: steps, and digits where the whole is small and far from the origin.
        const float largest = std::max(std::abs(low[axis]), std::abs(high[axis]));
        const float room = 0x1p-19f * extent + 0x1p-22f * largest;
        low_[axis] = low[axis] - room;
        step_[axis] = (extent + 2.0f * room) / static_cast<float>(last);
    }
}

std::array<std::uint32_t, 2> BoxGrid::pack(int axis, float low, float high) const {
    if (!(step_[axis] > 0.0f)) return {0, 0};
    const auto clamped = [](double step) {
        return static_cast<std::uint32_t>(std::clamp(step, 0.0, static_cast<double>(last)));
    };
    const double first = std::floor((static_cast<double>(low) - low_[axis]) / step_[axis]);
    const double end = std::ceil((static_cast<double>(high) - low_[axis]) / step_[axis]);
    // Unpacking rounds: widen the interval until it holds both ends.
    for (double wider = 0;; wider = 2 * wider + 1) {
        const std::uint32_t a = clamped(first - wider), b = clamped(end + wider);
        float middle = 0, half = 0;
        unpack(axis, a, b, middle, half);
        const bool holds =
            middle - half <= low && middle + half >= high && middle - low <= half && high - middle <= half;
        if (holds || (a == 0 && b == last)) return {a, b};
    }
}

PackedBox::PackedBox(const BoxGrid& grid, const glm::vec3& low, const glm::vec3& high) {
    for (int axis = 0; axis < 3; ++axis) {
        const auto [a, b] = grid.pack(axis, low[axis], high[axis]);
        low_ |= std::uint64_t{a} << 21 * axis;
        high_ |= std::uint64_t{b} << 21 * axis;
    }
}

}  // namespace render2mpeg::renderer
