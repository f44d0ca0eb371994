#include "image/texture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/color.h"
#include "core/sampling.h"
#include "image/halve.h"

namespace render2mpeg::image {
namespace {

using core::Wrap;

constexpr std::uint64_t seed = 20;

/// An image of random values, as multiples of 1/255 or any.
Image noise(int width, int height, bool in_codes = true) {
    Image image;
    image.pixels = core::Plane<glm::vec4>(width, height);
    image.high_range = !in_codes;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 4; ++c) {
                const float v = core::uniform(seed, static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y),
                                              static_cast<std::uint64_t>(c));
                image.pixels.at(x, y)[c] = in_codes ? std::floor(v * 256) / 255.0f : v;
            }
    return image;
}

Image checkerboard(int size, int square) {
    Image image;
    image.pixels = core::Plane<glm::vec4>(size, size);
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x)
            image.pixels.at(x, y) = glm::vec4(glm::vec3((x / square + y / square) % 2 ? 1.0f : 0.0f), 1);
    return image;
}

Footprint square(float texels, int size) {
    return {{texels / static_cast<float>(size), 0}, {0, texels / static_cast<float>(size)}};
}

/// Bilinear interpolation in double precision, written down as the textbook has it.
glm::dvec4 bilinear(const Image& image, glm::dvec2 uv, Wrap wrap_u, Wrap wrap_v, bool srgb) {
    const int w = image.pixels.width(), h = image.pixels.height();
    const double x = uv.x * w - 0.5, y = uv.y * h - 0.5;
    const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
    glm::dvec4 sum{0};
    for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i) {
            glm::dvec4 p(image.pixels.at(wrapped(x0 + i, w, wrap_u), wrapped(y0 + j, h, wrap_v)));
            if (srgb)
                for (int c = 0; c < 3; ++c)
                    p[c] = p[c] <= 0.04045 ? p[c] / 12.92 : std::pow((p[c] + 0.055) / 1.055, 2.4);
            sum += p * (i ? x - x0 : 1 - (x - x0)) * (j ? y - y0 : 1 - (y - y0));
        }
    return sum;
}

TEST(Texture, MagnificationIsBilinearUnderEveryWrapEncodingAndStorage) {
    for (const Wrap wrap : {Wrap::repeat, Wrap::mirrored_repeat, Wrap::clamp_to_edge})
        for (const bool srgb : {false, true})
            for (const bool in_codes : {true, false}) {
                const Image image = noise(13, 6, in_codes);
                const Texture texture(image, srgb ? Encoding::srgb : Encoding::linear, wrap, wrap);
                for (std::uint64_t i = 0; i < 500; ++i) {
                    const glm::vec2 uv{core::uniform(seed, i, 7) * 6 - 3, core::uniform(seed, i, 8) * 6 - 3};
                    const glm::vec4 v = texture.sample(uv, square(core::uniform(seed, i, 9), 13));
                    const glm::dvec4 truth = bilinear(image, uv, wrap, wrap, srgb && in_codes);
                    for (int c = 0; c < 4; ++c) EXPECT_NEAR(v[c], truth[c], 3e-5) << i;
                }
            }
}
}  // namespace
}  // namespace render2mpeg::image
