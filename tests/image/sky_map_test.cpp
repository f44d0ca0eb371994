#include "image/sky_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/color.h"
#include "core/sampling.h"

namespace render2mpeg::image {
namespace {

constexpr double pi = std::numbers::pi;
constexpr std::uint64_t sky_seed = 7;

Image constant_map(int width, int height, glm::vec3 color) {
    Image image;
    image.pixels = core::Plane<glm::vec4>(width, height, glm::vec4(color, 1));
    image.high_range = true;
    return image;
}

/// A horizon-to-zenith gradient with noise: bright above, dim below.
Image outdoors(int width, int height) {
    Image image = constant_map(width, height, {0, 0, 0});
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const float up = 1 - static_cast<float>(y) / static_cast<float>(height);
            const float v = (0.1f + up * up) * (0.5f + core::uniform(sky_seed, static_cast<std::uint64_t>(x / 4),
                                                                     static_cast<std::uint64_t>(y / 4)));
            image.pixels.at(x, y) = {0.6f * v, 0.8f * v, v, 1};
        }
    return image;
}

/// Where the centre of a pixel lies, written down apart from the class.
glm::dvec3 direction_of(int x, int y, int width, int height) {
    const double theta = pi * (y + 0.5) / height, phi = 2 * pi * ((x + 0.5) / width - 0.5);
    return {std::sin(theta) * std::sin(phi), std::cos(theta), -std::sin(theta) * std::cos(phi)};
}

double pixel_solid_angle(int y, int width, int height) {
    return 2 * pi / width * (std::cos(pi * y / height) - std::cos(pi * (y + 1) / height));
}

glm::dvec3 light_of(const Image& image) {
    glm::dvec3 sum{0};
    const int w = image.pixels.width(), h = image.pixels.height();
    for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) sum += glm::dvec3(image.pixels.at(x, y)) * pixel_solid_angle(y, w, h);
    return sum;
}

/// Irradiance on a surface with this normal, by pixels as points of light.
glm::dvec3 irradiance(const Image& image, glm::dvec3 normal) {
    glm::dvec3 sum{0};
    const int w = image.pixels.width(), h = image.pixels.height();
    for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x)
            sum += glm::dvec3(image.pixels.at(x, y)) *
                   (pixel_solid_angle(y, w, h) * std::max(0.0, glm::dot(normal, direction_of(x, y, w, h))));
    return sum;
}

glm::dvec3 light_of(const std::vector<SkySample>& samples) {
    glm::dvec3 sum{0};
    for (const SkySample& sample : samples) sum += glm::dvec3(sample.irradiance);
    return sum;
}

void expect_close(glm::dvec3 a, glm::dvec3 b, double relative) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], relative * std::abs(b[c]) + 1e-30);
}

TEST(SkyMap, DirectionsFollowTheConvention) {
    // Red marks -z (the middle), green +x, blue the rows about +y.
    Image image = constant_map(64, 32, {0, 0, 0});
    for (int y = 14; y < 18; ++y) {
        for (int x = 30; x < 34; ++x) image.pixels.at(x, y).r = 1;
        for (int x = 46; x < 50; ++x) image.pixels.at(x, y).g = 1;
    }
    for (int x = 0; x < 64; ++x) image.pixels.at(x, 0).b = image.pixels.at(x, 1).b = 1;
    const SkyMap sky(image, {1, 1, 1}, 0);
    expect_close(sky.radiance({0, 0, -1}, 0), {1, 0, 0}, 1e-6);
    expect_close(sky.radiance({1, 0, 0}, 0), {0, 1, 0}, 1e-6);
    expect_close(sky.radiance({0, 5, 0}, 0), {0, 0, 1}, 1e-6);
    expect_close(sky.radiance({0, -1, 0}, 0), {0, 0, 0}, 1e-6);

    // A quarter turn about +y, right-handed, takes -z to -x and +x to -z.
    const SkyMap turned(image, {1, 1, 1}, static_cast<float>(pi / 2));
    expect_close(turned.radiance({-1, 0, 0}, 0), {1, 0, 0}, 1e-6);
    expect_close(turned.radiance({0, 0, -1}, 0), {0, 1, 0}, 1e-6);
    for (const SkySample& sample : turned.samples(400)) {
        const glm::vec3 seen = turned.radiance(sample.direction, 0);
        EXPECT_GT(core::luminance(seen), 0) << sample.id;
    }
}

TEST(SkyMap, SamplesHoldAllLightOfTheMap) {
    const Image image = outdoors(160, 80);
    const SkyMap sky(image, {2, 1, 0.5f}, 1);
    const glm::dvec3 truth = light_of(image) * glm::dvec3(2, 1, 0.5);
    for (const int count : {1, 2, 3, 7, 64, 255, 1024, 100000}) {
        const std::vector<SkySample> samples = sky.samples(count);
        EXPECT_LE(samples.size(), static_cast<std::size_t>(count));
        expect_close(light_of(samples), truth, 2e-6);
    }
    expect_close(glm::dvec3(sky.mean()) * 4.0 * pi, truth, 2e-6);
}

TEST(SkyMap, SamplesHaveAboutEqualPower) {
    const SkyMap sky(outdoors(512, 256), {1, 1, 1}, 0);
    const std::vector<SkySample> samples = sky.samples(300);
    EXPECT_EQ(samples.size(), 300u);
    double least = 1e30, most = 0, total = 0, solid_angle = 0;
    for (const SkySample& sample : samples) {
        const double power = core::luminance(sample.irradiance);
        least = std::min(least, power);
        most = std::max(most, power);
        total += power;
        solid_angle += sample.solid_angle;
        EXPECT_NEAR(glm::length(sample.direction), 1, 1e-6);
    }
    EXPECT_GT(least, 0.75 * total / 300);
    EXPECT_LT(most, 1.3 * total / 300);
    EXPECT_NEAR(solid_angle, 4 * pi, 1e-4);
}

TEST(SkyMap, ASunOfOnePixelIsOneSampleAtItsCentre) {
    Image image = constant_map(256, 128, {0, 0, 0});
    image.pixels.at(40, 17) = {1e9f, 5e8f, 1e8f, 1};
    const glm::dvec3 truth = glm::dvec3(1e9, 5e8, 1e8) * pixel_solid_angle(17, 256, 128);
    for (const int count : {1, 2, 1000}) {
        const std::vector<SkySample> samples = SkyMap(image, {1, 1, 1}, 0).samples(count);
        ASSERT_EQ(samples.size(), 1u);
        expect_close(samples[0].irradiance, truth, 1e-6);
        EXPECT_LT(glm::distance(glm::dvec3(samples[0].direction), direction_of(40, 17, 256, 128)), 1e-6);
    }

    // With a sky about it, the sun is still one sample and all others are the sky's.
    Image both = outdoors(256, 128);
    both.pixels.at(40, 17) += glm::vec4(1e9f, 5e8f, 1e8f, 0);
    const std::vector<SkySample> samples = SkyMap(both, {1, 1, 1}, 0).samples(100);
    EXPECT_EQ(samples.size(), 100u);
    const auto bright = [](const SkySample& sample) { return sample.irradiance.x > 1000; };
    ASSERT_EQ(std::count_if(samples.begin(), samples.end(), bright), 1);
    const SkySample sun = *std::find_if(samples.begin(), samples.end(), bright);
    EXPECT_LT(glm::distance(glm::dvec3(sun.direction), direction_of(40, 17, 256, 128)), 1e-6);
    EXPECT_NEAR(sun.solid_angle, pixel_solid_angle(17, 256, 128), 1e-9);
    glm::dvec3 rest{0};
    for (const SkySample& sample : samples)
        if (sample.id != sun.id) rest += glm::dvec3(sample.irradiance);
    const glm::dvec3 sun_pixel = glm::dvec3(glm::vec3(both.pixels.at(40, 17))) * pixel_solid_angle(17, 256, 128);
    both.pixels.at(40, 17) = glm::vec4(0, 0, 0, 1);
    expect_close(rest, light_of(both), 1e-5);
    expect_close(sun.irradiance, sun_pixel, 1e-6);
}

TEST(SkyMap, SamplesLightSurfacesAsTheSkyDoes) {
    const Image image = outdoors(256, 128);
    const std::vector<SkySample> samples = SkyMap(image, {1, 1, 1}, 0).samples(1024);
    for (std::uint64_t i = 0; i < 20; ++i) {
        const glm::vec3 normal = core::sample_sphere({core::uniform(sky_seed, i, 1), core::uniform(sky_seed, i, 2)});
        glm::dvec3 sum{0};
        for (const SkySample& sample : samples)
            sum +=
                glm::dvec3(sample.irradiance) * static_cast<double>(std::max(0.0f, glm::dot(normal, sample.direction)));
        expect_close(sum, irradiance(image, normal), 0.01);
    }
}

TEST(SkyMap, AConstantSkyIsSpreadEvenly) {
    const SkyMap sky(glm::vec3{0.5f, 1, 2});
    EXPECT_TRUE(sky.uniform());
    expect_close(sky.radiance({0.1f, 0.2f, 0.3f}, 0.5f), {0.5, 1, 2}, 0);
    const std::vector<SkySample> samples = sky.samples(500);
    ASSERT_EQ(samples.size(), 500u);
    expect_close(light_of(samples), glm::dvec3(0.5, 1, 2) * 4.0 * pi, 1e-5);
    for (std::uint64_t i = 0; i < 50; ++i) {
        const glm::vec3 normal = core::sample_sphere({core::uniform(sky_seed, i, 5), core::uniform(sky_seed, i, 6)});
        double sum = 0;
        for (const SkySample& sample : samples)
            sum += sample.irradiance.y * std::max(0.0f, glm::dot(normal, sample.direction));
        EXPECT_NEAR(sum, pi, 0.005 * pi);
    }

    // No two directions are closer than three quarters of what equal discs would allow.
    float closest = -1;
    for (std::size_t i = 0; i < samples.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            closest = std::max(closest, glm::dot(samples[i].direction, samples[j].direction));
    EXPECT_GT(std::acos(closest), 0.75 * 2 * std::sqrt(4 * pi / 500 / pi));
}

TEST(SkyMap, BlackAndBrokenSkiesGiveNoLight) {
    EXPECT_TRUE(SkyMap(constant_map(16, 8, {0, 0, 0}), {1, 1, 1}, 0).samples(100).empty());
    EXPECT_TRUE(SkyMap(constant_map(16, 8, {1, 1, 1}), {0, 0, 0}, 0).samples(100).empty());
    EXPECT_TRUE(SkyMap(glm::vec3(0)).samples(100).empty());
    EXPECT_TRUE(SkyMap(Image{}, {1, 1, 1}, 0).samples(100).empty());
    EXPECT_TRUE(SkyMap(glm::vec3(1)).samples(0).empty());
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_TRUE(SkyMap(constant_map(16, 8, {nan, -1, nan}), {1, 1, 1}, 0).samples(100).empty());

    // An infinite pixel is a sun of the largest half float.
    Image image = constant_map(16, 8, {0, 0, 0});
    image.pixels.at(3, 3).r = std::numeric_limits<float>::infinity();
    const std::vector<SkySample> samples = SkyMap(image, {1, 1, 1}, 0).samples(1000);
    ASSERT_FALSE(samples.empty());
    expect_close(light_of(samples), {65504 * pixel_solid_angle(3, 16, 8), 0, 0}, 1e-5);
}

TEST(SkyMap, EveryLookupIsFinite) {
    const SkyMap sky(outdoors(64, 32), {1, 1, 1}, 0);
    constexpr float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    for (const float v : {0.0f, -0.0f, 1.0f, -1.0f, 1e-38f, 1e30f, inf, nan})
        for (const float w : {0.0f, 1.0f, -1.0f, nan})
            for (const float solid_angle : {0.0f, 1e-12f, 1.0f, 20.0f, -1.0f, inf, nan}) {
                const glm::vec3 seen = sky.radiance({v, w, v}, solid_angle);
                for (int c = 0; c < 3; ++c) EXPECT_TRUE(seen[c] >= 0 && seen[c] < 10);
            }
}

TEST(SkyMap, LookupsOfRaysAreTheSameInTheMean) {
    const SkyMap sky(outdoors(256, 128), glm::vec3(1), 0.4f);
    constexpr int count = 4096;
    for (const float solid_angle : {0.0f, 0.001f, 0.05f}) {
        double mean = 0, whole = 0, off = 0;
        for (std::uint64_t index = 0; index < count; ++index) {
            const glm::vec3 d = core::sample_sphere({core::halton(0, index), core::halton(1, index)});
            const auto ray = static_cast<double>(core::luminance(sky.radiance_of_ray(d, solid_angle)));
            const auto eye = static_cast<double>(core::luminance(sky.radiance(d, solid_angle)));
            mean += ray / count;
            whole += eye / count;
            off += std::abs(ray - eye) / count;
        }
        EXPECT_NEAR(mean, whole, 0.01 * whole) << solid_angle;
        EXPECT_LT(off, solid_angle > 0.0f ? 0.1 * whole : 1e-5 * whole) << solid_angle;
    }
    EXPECT_EQ(sky.radiance_of_ray({0, 1, 0}, 100.0f), sky.mean());
}

TEST(SkyMap, WideLookupsAreMeansOverTheSphere) {
    // A function that is smooth on the sphere, at the poles as well; there the image's own means would be wrong.
    const auto smooth = [](glm::dvec3 d) { return 2 + d.x + 0.5 * d.y + 2 * d.x * d.z + d.y * d.y * d.y; };
    Image image = constant_map(256, 128, {0, 0, 0});
    for (int y = 0; y < 128; ++y)
        for (int x = 0; x < 256; ++x) {
            const auto value = static_cast<float>(smooth(direction_of(x, y, 256, 128)));
            image.pixels.at(x, y) = {value, value, value, 1};
        }
    const SkyMap sky(image, {1, 1, 1}, 0);
    for (const double solid_angle : {0.0, 0.001, 0.01, 0.03})
        for (std::uint64_t i = 0; i < 40; ++i) {
            glm::vec3 axis = core::sample_sphere({core::uniform(sky_seed, i, 8), core::uniform(sky_seed, i, 9)});
            if (i < 2) axis = {0, i == 0 ? 1 : -1, 0};
            glm::vec3 tangent, bitangent;
            core::make_frame(axis, tangent, bitangent);
            double truth = 0;
            for (std::uint64_t j = 0; j < 1000; ++j) {
                const double cosine = 1 - solid_angle / (2 * pi) * core::halton(0, j);
                const double sine = std::sqrt(1 - cosine * cosine), turn = 2 * pi * core::halton(1, j);
                truth +=
                    smooth(glm::dvec3(axis) * cosine +
                           (glm::dvec3(tangent) * std::cos(turn) + glm::dvec3(bitangent) * std::sin(turn)) * sine) /
                    1000;
            }
            EXPECT_NEAR(sky.radiance(axis, static_cast<float>(solid_angle)).y, truth, 0.02 + 3 * solid_angle) << axis.y;
        }
    expect_close(sky.radiance({0, 1, 0}, static_cast<float>(4 * pi)), sky.mean(), 1e-6);
    EXPECT_NEAR(sky.mean().y, 2, 1e-3);
}

}  // namespace
}  // namespace render2mpeg::image
