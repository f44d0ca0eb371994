#include "image/channel_bounds.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/sampling.h"

namespace render2mpeg::image {
namespace {

using core::Wrap;

Image random_alpha(int width, int height) {
    Image image;
    image.pixels = core::Plane<glm::vec4>(width, height);
    image.has_alpha = image.high_range = true;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            image.pixels.at(x, y) =
                glm::vec4(core::uniform(31, static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y)));
    return image;
}

TEST(ChannelBounds, HoldEverySampleOfTheirBox) {
    for (const Wrap wrap_u : {Wrap::repeat, Wrap::mirrored_repeat, Wrap::clamp_to_edge})
        for (const Wrap wrap_v : {Wrap::repeat, Wrap::mirrored_repeat, Wrap::clamp_to_edge})
            for (const glm::ivec2 size : {glm::ivec2{13, 7}, {1, 9}, {64, 64}, {2, 1}}) {
                const Image image = random_alpha(size.x, size.y);
                const Texture texture(image, Encoding::linear, wrap_u, wrap_v);
                const ChannelBounds bounds(texture, 3);
                for (std::uint64_t i = 0; i < 300; ++i) {
                    const auto draw = [&](std::uint64_t k) { return core::uniform(32, i, k); };
                    const float extent = std::pow(10.0f, 3.0f * draw(0) - 3.0f);
                    const glm::vec2 low = 6.0f * glm::vec2(draw(1), draw(2)) - 3.0f,
                                    high = low + extent * glm::vec2(draw(3), draw(4));
                    const auto within = bounds.within(low, high);
                    ASSERT_TRUE(within);
                    for (std::uint64_t k = 0; k < 20; ++k) {
                        const glm::vec2 uv = glm::mix(low, high, glm::vec2(draw(10 + k), draw(40 + k)));
                        const float sample = texture.sample(uv, {}).w;
                        EXPECT_GE(sample, within->low - 1e-6f);
                        EXPECT_LE(sample, within->high + 1e-6f);
                    }
                }
            }
}

TEST(ChannelBounds, OfAPointAreThoseOfItsFourTexels) {
    const Image image = random_alpha(32, 16);
    const Texture texture(image, Encoding::linear, Wrap::repeat, Wrap::clamp_to_edge);
    const ChannelBounds bounds(texture, 3);
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 32; ++x) {
            const glm::dvec2 at((x + 1.0) / 32, (y + 1.0) / 16);
            const float a = image.pixels.at(x, y).w, b = image.pixels.at((x + 1) % 32, y).w,
                        c = image.pixels.at(x, std::min(y + 1, 15)).w,
                        d = image.pixels.at((x + 1) % 32, std::min(y + 1, 15)).w;
            const auto within = bounds.within(at + 0.0005, at + 0.0005);
            ASSERT_TRUE(within);
            EXPECT_EQ(within->low, std::min({a, b, c, d}));
            EXPECT_EQ(within->high, std::max({a, b, c, d}));
        }
}

TEST(ChannelBounds, SayNothingOfBoxesThatAreNotFiniteOrTooFar) {
    const Texture texture(random_alpha(8, 8), Encoding::linear, Wrap::repeat, Wrap::repeat);
    const ChannelBounds bounds(texture, 3);
    constexpr double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
    EXPECT_FALSE(bounds.within({nan, 0}, {1, 1}));
    EXPECT_FALSE(bounds.within({0, 0}, {1, nan}));
    EXPECT_FALSE(bounds.within({0, -inf}, {1, 1}));
    EXPECT_FALSE(bounds.within({0, 0}, {1e6, 1}));
    ASSERT_TRUE(bounds.within({-500, -500}, {500, 500}));
    EXPECT_EQ(*bounds.within({-500, -500}, {500, 500}), bounds.all());
}

}  // namespace
}  // namespace render2mpeg::image
