#include "perceptual/glare.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/constants.hpp>

#include "core/sampling.h"
#include "perceptual/eye.h"

namespace render2mpeg::perceptual {
namespace {

using Light = core::Plane<glm::vec3>;

core::Glare glare_of(float strength, core::GlareKind kind = core::GlareKind::still, float size = 0.5f) {
    return {kind, strength, size, 0};
}

glm::dvec3 sum_of(const Light& light) {
    glm::dvec3 sum(0);
    for (const glm::vec3 pixel : light.values()) sum += pixel;
    return sum;
}

Light lamp(int width, int height, glm::ivec2 at, float brightness) {
    Light light(width, height);
    light.at(at.x, at.y) = glm::vec3(brightness);
    return light;
}

TEST(GlareOfEyes, LeavesAnEvenPictureAsItIs) {
    for (const int height : {60, 720}) {  // of single pixels, and of cells of two
        Glare glare(glare_of(0.3f), 96, height, 1, 0);
        const Light shown = glare.over(Light(96, height, glm::vec3(0.2f, 1, 3)), 0);
        for (const glm::vec3 pixel : shown.values())
            for (int c = 0; c < 3; ++c) EXPECT_NEAR(pixel[c] / glm::vec3(0.2f, 1, 3)[c], 1, 2e-5);
    }
}

TEST(GlareOfEyes, KeepsAllLightWhereverTheLampIs) {
    Glare glare(glare_of(0.2f), 90, 60, 1, 0);
    for (const glm::ivec2 at : {glm::ivec2(45, 30), glm::ivec2(0, 0), glm::ivec2(89, 20), glm::ivec2(3, 59)}) {
        const Light shown = glare.over(lamp(90, 60, at, 1000), 0);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum_of(shown)[c], 1000, 0.05);
        EXPECT_GT(shown.at(at.x, at.y).y, 800);
        EXPECT_LT(shown.at(at.x, at.y).y, 985);  // in corners three quarters come back
    }
}

TEST(GlareOfEyes, ReachesAsFarAsItsSizeAndDoesNotComeRoundSlow) {
    Glare glare(glare_of(0.5f, core::GlareKind::still, 0.25f), 120, 80, 1, 0);
    const Light shown = glare.over(lamp(120, 80, {2, 40}, 1000), 0);
    for (int y = 0; y < 80; ++y)
        for (int x = 0; x < 120; ++x) {
            const float distance = glm::length(glm::vec2(x - 2, y - 40));
            if (distance > 21) {
                EXPECT_LT(shown.at(x, y).y, 1e-4f) << x << " " << y;
            } else if (distance < 15) {
                EXPECT_GT(shown.at(x, y).y, 1e-3f) << x << " " << y;
            }
        }
}

TEST(GlareOfEyes, KeepsAllLightInCellsThatTheBorderCutsSlow) {
    Glare glare(glare_of(0.3f), 97, 1025, 1, 0);  // cells of three
    for (const glm::ivec2 at : {glm::ivec2(50, 500), glm::ivec2(96, 500), glm::ivec2(50, 1024), glm::ivec2(96, 1024)})
        EXPECT_NEAR(sum_of(glare.over(lamp(97, 1025, at, 1000), 0)).y, 1000, 12) << at.x << " " << at.y;
}

TEST(GlareOfEyes, IsRoundAsPicturesAreShownSlow) {
    Glare glare(glare_of(0.5f, core::GlareKind::still, 0.25f), 120, 80, 2, 0);
    const Light shown = glare.over(lamp(120, 80, {60, 40}, 1000), 0);
    // Pixels are twice as wide as high: the spread, in heights of a pixel, is alike in both directions.
    glm::dvec2 spread(0);
    for (int y = 0; y < 80; ++y)
        for (int x = 0; x < 120; ++x) {
            const glm::dvec2 offset(2 * (x - 60), y - 40);
            spread += offset * offset * static_cast<double>(shown.at(x, y).y);
        }
    EXPECT_NEAR(spread.x / spread.y, 1, 0.2);
    EXPECT_LT(shown.at(60 + 12, 40).y, 1e-4f);
}

TEST(GlareOfEyes, FallsWithDistanceAndIsDarkWhereAllIsBlackSlow) {
    Glare glare(glare_of(0.1f), 160, 160, 1, 0);
    const Light shown = glare.over(lamp(160, 160, {80, 80}, 1000), 0);
    const auto ring = [&](float radius) {
        double sum = 0;
        for (int i = 0; i < 64; ++i) {
            const float angle = glm::two_pi<float>() * static_cast<float>(i) / 64;
            const glm::ivec2 at(std::lround(80 + radius * std::cos(angle)), std::lround(80 + radius * std::sin(angle)));
            sum += static_cast<double>(shown.at(at.x, at.y).y);
        }
        return sum;
    };
    for (const float radius : {4.0f, 8.0f, 16.0f, 32.0f}) EXPECT_GT(ring(radius), 2 * ring(2 * radius)) << radius;
    const Light black = glare.over(Light(160, 160), 0);
    for (const glm::vec3 pixel : black.values()) EXPECT_EQ(pixel, glm::vec3(0));
}

TEST(GlareOfEyes, IsFiniteBesideASunAndNeverNegative) {
    Glare glare(glare_of(0.5f), 64, 64, 1, 0);
    Light light = lamp(64, 64, {20, 20}, 1e9f);
    for (std::size_t i = 0; i < light.size(); ++i) light.values()[i] += core::uniform(1, i);
    const Light shown = glare.over(light, 0);
    for (const glm::vec3 pixel : shown.values())
        for (int c = 0; c < 3; ++c) {
            EXPECT_TRUE(std::isfinite(pixel[c]));
            EXPECT_GE(pixel[c], 0.0f);
        }
}

TEST(GlareOfEyes, ChangesWithTimeOnlyWhereThatIsAskedForSlow) {
    const Light light = lamp(64, 48, {30, 20}, 100);
    Glare still(glare_of(0.2f), 64, 48, 1, 0), temporal(glare_of(0.2f, core::GlareKind::temporal), 64, 48, 1, 0);
    EXPECT_EQ(still.over(light, 0), still.over(light, 0.8));
    const Light before = temporal.over(light, 0), after = temporal.over(light, 0.8);
    EXPECT_NE(before, after);
    EXPECT_EQ(temporal.over(light, 0), before);  // a function of time alone
    EXPECT_NEAR(sum_of(after).y, 100, 0.01);
}

/// Mean of the pattern at a distance from its middle, in texels.
double mean_at(const core::Plane<float>& pattern, double radius) {
    double sum = 0;
    constexpr int count = 256;
    for (int i = 0; i < count; ++i) {
        const double angle = glm::two_pi<double>() * i / count;
        const glm::dvec2 at = glm::dvec2(eye_texels / 2) + radius * glm::dvec2(std::cos(angle), std::sin(angle));
        sum +=
            static_cast<double>(pattern.at(static_cast<int>(std::lround(at.x)), static_cast<int>(std::lround(at.y))));
    }
    return sum / count;
}

TEST(EyeDiffraction, OfAnOpenDiscIsAirysPattern) {
    // [Airy1835]: the first dark ring at 1.22 wavelengths over the diameter, a bright one of 1.75 % at 1.635 of them.
    const double diameter = 1;  // mm: 51.2 texels, so that the ring lies at 12.2 of them
    const core::Plane<float> pattern = diffraction(open_disc(diameter));
    const double peak = static_cast<double>(pattern.at(eye_texels / 2, eye_texels / 2));
    const double unit = aperture_mm / diameter;
    EXPECT_LT(mean_at(pattern, 1.22 * unit), 2e-3 * peak);
    EXPECT_NEAR(mean_at(pattern, 1.635 * unit) / peak, 0.0175, 0.0015);
    EXPECT_NEAR(mean_at(pattern, 0.5145 * unit) / peak, 0.5, 0.05);
}

TEST(EyeDiffraction, ScattersWhatLiesBeyondTheFirstDarkRing) {
    const core::Plane<float> all = diffraction(aperture(3, 0, 1)), far = scattered(all, 3);
    double sum = 0, near = 0;
    for (int y = 0; y < eye_texels; ++y)
        for (int x = 0; x < eye_texels; ++x) {
            sum += static_cast<double>(far.at(x, y));
            const double distance = glm::length(glm::dvec2(x, y) - glm::dvec2(eye_texels / 2));
            if (distance < 4) near += static_cast<double>(far.at(x, y));
        }
    EXPECT_NEAR(sum, 1, 1e-4);
    EXPECT_EQ(near, 0);
    EXPECT_NEAR(far.at(300, 256) / far.at(256, 320), all.at(300, 256) / all.at(256, 320), 1e-3);
}

TEST(EyeDiffraction, IsWiderForRedThanForBlue) {
    const core::Plane<glm::vec3> white = in_colour(diffraction(open_disc(2)));
    glm::dvec3 sum(0), spread(0);
    for (int y = 0; y < eye_texels; ++y)
        for (int x = 0; x < eye_texels; ++x) {
            const double r = glm::length(glm::dvec2(x, y) - glm::dvec2(eye_texels / 2));
            if (r > 40) continue;
            sum += glm::dvec3(white.at(x, y));
            spread += r * glm::dvec3(white.at(x, y));
        }
    spread /= sum;
    // The channels' mean wavelengths lie some 600 to 450 nm apart.
    EXPECT_GT(spread.r / spread.b, 1.15);
    EXPECT_LT(spread.r / spread.b, 1.5);
    EXPECT_GT(spread.g, spread.b);
}

TEST(Pupil, NarrowsInTheLightAndNeverRests) {
    // [Ritschel2009]: diameters of the mean eye at so many cd/m^2.
    EXPECT_NEAR(pupil_diameter(0.01), 6.04, 0.01);
    EXPECT_NEAR(pupil_diameter(0.1), 4.9, 1e-9);
    EXPECT_NEAR(pupil_diameter(100), 2.40, 0.01);
    double least = 9, most = 0;
    for (int i = 0; i < 200; ++i) {
        const double d = restless_diameter(3, 0.05 * i, 1);
        least = std::min(least, d), most = std::max(most, d);
        EXPECT_NEAR(restless_diameter(3, 0.05 * i + 0.001, 1), d, 0.01);
    }
    EXPECT_GT(most - least, 0.05);
    EXPECT_LT(most - least, 0.6);
}

}  // namespace
}  // namespace render2mpeg::perceptual
