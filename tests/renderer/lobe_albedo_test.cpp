#include "renderer/surface/lobe_albedo.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/reference/scattering.h"

namespace render2mpeg::renderer {
namespace {

TEST(LobeAlbedo, IsTheIntegralOfTheLobe) {
    double worst = 0, sum = 0;
    int count = 0;
    for (const double roughness : {0.1, 0.15, 0.27, 0.4, 0.52, 0.69, 0.85, 1.0}) {
        for (const double cosine : {0.03, 0.08, 0.15, 0.26, 0.4, 0.6, 0.8, 0.97}) {
            const double alpha = roughness * roughness;
            const reference::LobeIntegral truth = reference::integrate_lobe(cosine, alpha);
            const LobeAlbedo table = lobe_albedo(static_cast<float>(cosine), static_cast<float>(alpha));
            for (const double off : {table.f0 - truth.f0, table.f90 - truth.f90}) {
                worst = std::max(worst, std::abs(off));
                sum += std::abs(off);
                ++count;
            }
        }
    }
    EXPECT_LT(worst, 0.015);
    EXPECT_LT(sum / count, 0.002);
}

TEST(LobeAlbedo, OfSmoothSurfacesIsWholeAndGrazesWholly) {
    EXPECT_NEAR(lobe_albedo(1.0f, 0.01f).whole(), 1.0f, 1e-3f);
    EXPECT_NEAR(lobe_albedo(1.0f, 0.01f).f90, 0.0f, 1e-3f);
    for (const float alpha : {0.01f, 0.3f, 1.0f}) EXPECT_NEAR(lobe_albedo(0.0f, alpha).whole(), 1.0f, 0.01f);
    EXPECT_NEAR(lobe_albedo(1.0f, 1.0f).whole(), 1.0f - std::numbers::ln2_v<float>, 1e-3f);
}

TEST(MeanSchlick, IsTheMeanOverTheHemisphere) {
    for (const double cosine : {0.0, 0.03, 0.1, 0.25, 0.5, 0.75, 1.0})
        EXPECT_NEAR(mean_schlick(static_cast<float>(cosine)), reference::mean_fresnel_power(cosine), 4e-4) << cosine;
}

}  // namespace
}  // namespace render2mpeg::renderer
