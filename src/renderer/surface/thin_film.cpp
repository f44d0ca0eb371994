#include "renderer/surface/thin_film.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace render2mpeg::renderer {
namespace {

constexpr float pi_of_film = std::numbers::pi_v<float>;

float squared(float x) {
    return x * x;
}

float rising_power(float cosine) {
    const float m = std::clamp(1.0f - cosine, 0.0f, 1.0f);
    return squared(squared(m)) * m;
}

/// Colour of a wave that is late by `path` nanometres and `shift`, as linear BT.709, per channel of `shift`.
glm::vec3 sensitivity(float path, glm::vec3 shift) {
    const float phase = 2 * pi_of_film * path * 1e-9f;
    const glm::vec3 val(5.4856e-13f, 4.4201e-13f, 5.2481e-13f), pos(1.6810e6f, 1.7953e6f, 2.2084e6f),
        var(4.3278e9f, 9.3046e9f, 6.6121e9f);
    glm::vec3 xyz;
    for (int c = 0; c < 3; ++c)
        xyz[c] = val[c] * std::sqrt(2 * pi_of_film * var[c]) * std::cos(pos[c] * phase + shift[c]) *
                 std::exp(-squared(phase) * var[c]);
    xyz.x += 9.7470e-14f * std::sqrt(2 * pi_of_film * 4.5282e9f) * std::cos(2.2399e6f * phase + shift.x) *
             std::exp(-4.5282e9f * squared(phase));
    xyz /= 1.0685e-7f;
    return {3.2404542f * xyz.x - 1.5371385f * xyz.y - 0.4985314f * xyz.z,
            -0.9692660f * xyz.x + 1.8760108f * xyz.y + 0.0415560f * xyz.z,
            0.0556434f * xyz.x - 0.2040259f * xyz.y + 1.0572252f * xyz.z};
}

}  // namespace

glm::vec3 thin_film(float film_ior, float thickness, float cosine, glm::vec3 base_f0) {
    // A film that is thinner than any wave is none.
    const float t = std::clamp(thickness / 0.03f, 0.0f, 1.0f);
    const float ior = std::lerp(1.0f, film_ior, t * t * (3 - 2 * t));
    const float cos2 = 1 - (1 - squared(cosine)) / squared(ior);
    if (cos2 < 0) return glm::vec3(1);
    const float inside = std::sqrt(cos2);

    const float r0 = squared((ior - 1) / (ior + 1));
    const float r12 = r0 + (1 - r0) * rising_power(cosine), t121 = 1 - r12;
    const float turn21 = ior < 1 ? 0.0f : pi_of_film;
    glm::vec3 r23, turn;
    for (int c = 0; c < 3; ++c) {
        const float root = std::sqrt(std::clamp(base_f0[c], 0.0f, 0.9999f));
        const float base_ior = (1 + root) / (1 - root);
        const float r1 = squared((base_ior - ior) / (base_ior + ior));
        r23[c] = r1 + (1 - r1) * rising_power(inside);
        turn[c] = turn21 + (base_ior < ior ? pi_of_film : 0.0f);
    }
    const glm::vec3 r123 = glm::clamp(r12 * r23, glm::vec3(1e-5f), glm::vec3(0.9999f));
    const glm::vec3 within = squared(t121) * r23 / (1.0f - r123);
    glm::vec3 sum = r12 + within, order = within - t121;
    const float path = 2 * ior * thickness * inside;
    for (int m = 1; m <= 2; ++m) {
        order *= glm::sqrt(r123);
        const auto times = static_cast<float>(m);
        sum += order * 2.0f * sensitivity(times * path, times * turn);
    }
    return glm::clamp(sum, glm::vec3(0), glm::vec3(1));
}

glm::vec3 schlick_f0(glm::vec3 reflectance, float cosine) {
    const float rise = std::min(rising_power(cosine), 0.9999f);
    return glm::clamp((reflectance - rise) / (1 - rise), glm::vec3(0), glm::vec3(1));
}

}  // namespace render2mpeg::renderer
