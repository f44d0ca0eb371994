#include "renderer/cache/cache_query.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/sampling.h"
#include "renderer/cache/local_regression.h"
#include "renderer/cache/receiver.h"
#include "renderer/gather/ray_sums.h"
#include "tests/renderer/record_wall.h"

namespace render2mpeg::renderer {
namespace {

TEST_F(Wall, LightThatChangesEvenlyIsFoundBetweenRecords) {
    const auto light = [](glm::vec2 at) { return 1.0f + 0.05f * at.x - 0.03f * at.y; };
    strew(4, light);
    int found = 0;
    for (int y = 5; y < 19; ++y) {
        for (int x = 5; x < 19; ++x) {
            const auto e = estimate_at(x, y, 0.02f);
            if (!e) continue;
            ++found;
            const float expected = light({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
            EXPECT_NEAR(e->indirect.x, expected, 1e-3f * expected) << x << ", " << y;
        }
    }
    EXPECT_GE(found, 14 * 14 * 9 / 10);
}

TEST_F(Wall, LightThatBendsAlikeInAllDirectionsIsFoundBetweenRecords) {
    const auto light = [](glm::vec2 at) { return 1.0f - 0.002f * glm::dot(at - 12.0f, at - 12.0f); };
    strew(2, light);
    int found = 0;
    for (int y = 7; y < 17; ++y)
        for (int x = 7; x < 17; ++x) {
            const auto e = estimate_at(x, y, 0.02f);
            if (!e) continue;
            ++found;
            // Planes through records within 6 pixels would miss a hundredth.
            EXPECT_NEAR(e->indirect.x, light({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f}), 1e-4f);
        }
    EXPECT_EQ(found, 100);
}

TEST_F(Wall, NobodyGuessesAcrossAnEdgeOfLight) {
    const auto light = [](glm::vec2 at) { return at.x < 11.0f ? 1.0f : 1.3f; };
    strew(2, light);
    int found = 0;
    for (int y = 4; y < 20; ++y) {
        for (int x = 1; x < 23; ++x) {
            const auto e = estimate_at(x, y, 0.02f);
            if (!e) continue;
            ++found;
            const float expected = light({static_cast<float>(x) + 0.5f, 0.0f});
            EXPECT_NEAR(e->indirect.x, expected, 0.05f * expected) << x << ", " << y;
        }
    }
    EXPECT_GE(found, 100);
    EXPECT_LE(found, 16 * 20);
}

TEST_F(Wall, RecordsOfAnotherSurfaceSayNothing) {
    strew(1, [](glm::vec2) { return 1.0f; });
    GatherPoint p = point_at(12, 12);
    EXPECT_TRUE(estimate_at(p, 0.02f).has_value());
    GatherPoint other = p;
    other.point.address.object = 7;
    EXPECT_FALSE(estimate_at(other, 0.02f).has_value());
    other = p;
    other.point.geometric_normal = other.point.shading_normal = glm::normalize(glm::vec3(1, 0, 1));
    EXPECT_FALSE(estimate_at(other, 0.02f).has_value());
    // A step of the size of some pixels.
    other = p;
    other.point.position.z -= 0.5f;
    EXPECT_FALSE(estimate_at(other, 0.02f).has_value());
}

TEST_F(Wall, NobodyIsServedBeyondWhereRecordsLie) {
    strew(1, [](glm::vec2) { return 1.0f; });
    RecordStore half;
    for (const IrradianceRecord& r : records_.all())
        if (stage_.world().camera.project(r.position)->position.x < 12.0f) half.insert(r);
    records_ = half;
    map_.build(records_.all(), stage_.world().camera);
    EXPECT_TRUE(estimate_at(10, 12, 0.02f).has_value());
    for (int x = 14; x < wall_side; ++x) EXPECT_FALSE(estimate_at(x, 12, 0.02f).has_value()) << x;
}

TEST_F(Wall, FewRecordsHaveAMeanWhereTheyLieAllAround) {
    const auto keep = [&](float step, const std::vector<glm::ivec2>& pixels) {
        records_ = {};
        strew(1, [&](glm::vec2 at) { return at.x < 12.0f ? 1.0f : 1.0f + step; });
        RecordStore few;
        for (const IrradianceRecord& r : records_.all())
            if (std::ranges::count(pixels, glm::ivec2(stage_.world().camera.project(r.position)->position)) > 0)
                few.insert(r);
        ASSERT_EQ(few.size(), pixels.size());
        records_ = few;
        map_.build(records_.all(), stage_.world().camera);
    };
    const std::vector<glm::ivec2> around{{11, 11}, {13, 11}, {11, 13}, {13, 13}};
    keep(0.0f, around);
    const auto even = estimate_at(12, 12, 0.02f, true);
    ASSERT_TRUE(even.has_value());
    EXPECT_NEAR(even->indirect.x, 1.0f, 1e-4f);
    EXPECT_FALSE(estimate_at(15, 12, 0.02f, true).has_value()) << "they lie to one side";
    EXPECT_FALSE(estimate_at(12, 12, 0.02f).has_value()) << "a bound wants more";
    keep(0.3f, around);
    EXPECT_FALSE(estimate_at(12, 12, 0.02f, true).has_value()) << "light has an edge there";
    keep(0.0f, {{11, 11}, {13, 11}, {12, 13}});
    EXPECT_FALSE(estimate_at(12, 12, 0.02f, true).has_value()) << "three tell no error";
}

TEST_F(Wall, CoarselyGatheredRecordsServeNoFinePixel) {
    strew(2, [](glm::vec2) { return 1.0f; });
    RecordStore coarse;
    for (IrradianceRecord r : records_.all()) {
        r.error = {0.2f / core::errors_of_one_in_hundred};
        coarse.insert(r);
    }
    records_ = coarse;
    map_.build(records_.all(), stage_.world().camera);
    EXPECT_FALSE(estimate_at(12, 12, 0.02f).has_value());
    EXPECT_TRUE(estimate_at(12, 12, 0.4f).has_value());
}

TEST_F(Wall, NobodyIsServedWhereNothingMayErr) {
    strew(1, [](glm::vec2) { return 1.0f; });
    EXPECT_TRUE(estimate_at(12, 12, 0.02f).has_value());
    EXPECT_FALSE(estimate_at(12, 12, 0.0f).has_value()) << "even by records without any error";
}

TEST_F(Wall, NobodyIsServedWhereThePictureDoesNotReach) {
    strew(1, [](glm::vec2) { return 1.0f; });
    const GatherPoint p = point_at(12, 12);
    const float extent = stage_.world().camera.pixel_size() * 2.0f, none = std::numeric_limits<float>::quiet_NaN();
    const auto holds = [&](glm::vec2 at) {
        return query_cache({p, {0, 0.02f, 0}, at, extent, 0.4f}, map_, records_, {}, 1.0f, 0).has_value();
    };
    EXPECT_TRUE(holds({12.5f, 12.5f}));
    for (const float off : {-1e30f, -40.0f, -15.5f, -14.0f, -10.0f, 33.5f, 38.0f, 39.5f, 60.0f, 1e30f, none}) {
        EXPECT_FALSE(holds({off, 12.5f})) << off;
        EXPECT_FALSE(holds({12.5f, off})) << off;
    }
}

/// Records in every pixel, lit by 64 rays whose noise is this large, about a step of light.
struct NoisyWall : Wall {
    void strew_noisy(float noise, float step) {
        strew(1, [&](glm::vec2 at) { return at.x < 12.0f ? 1.0f : 1.0f + step; });
        for (std::uint32_t i = 0; i < records_.size(); ++i) {
            IrradianceRecord& r = records_.change(i);
            // Two uniform numbers have a sixth of the square of their range as variance.
            const float dice = core::uniform(7, i) + core::uniform(8, i) - 1.0f;
            r.by_rays[0] = r.indirect + std::sqrt(6.0f) * noise * dice;
            r.indirect = glm::vec3(0);
            r.ray_count = 64;
            r.batch_variance = noise * noise * std::pow(64.0f / batch_rays, variance_power);
        }
    }
    /// Root of the mean square error of what planes find about each record, of the estimates told, and of the records.
    struct Errors {
        double found = 0, told = 0, raw = 0, radius = 0;
    };
    Errors errors(int first, int last, float step) {
        Errors e;
        LocalRegression fit;
        int count = 0;
        for (std::uint32_t i = 0; i < records_.size(); ++i) {
            const auto at = stage_.world().camera.project(records_[i].position)->position;
            if (at.x < static_cast<float>(first) || at.x > static_cast<float>(last)) continue;
            const GatherPoint& p = point_at(static_cast<int>(at.x), static_cast<int>(at.y));
            const float extent = stage_.world().camera.pixel_size() * 2.0f;
            fit.collect({p, {0, 0.02f, 0}, at, extent, receives(p)}, LocalRegression::Of::rays_light, map_, records_,
                        i);
            const RegressionError told = fit.estimate();
            double light = 0;
            for (std::size_t k = 0; k < fit.size(); ++k)
                light += static_cast<double>(fit.weight(k) * records_[fit.record(k)].by_rays[0].x);
            const double truth = at.x < 12.0f ? 1.0 : 1.0 + static_cast<double>(step);
            e.found += (light - truth) * (light - truth);
            e.raw += std::pow(static_cast<double>(records_[i].by_rays[0].x) - truth, 2);
            e.told += told.square / std::pow(static_cast<double>(receives(p)), 2);
            e.radius += told.radius;
            ++count;
        }
        return {std::sqrt(e.found / count), std::sqrt(e.told / count), std::sqrt(e.raw / count), e.radius / count};
    }
};

TEST_F(NoisyWall, NoiseOfRaysIsAveragedWhereLightIsEven) {
    strew_noisy(0.1f, 0.0f);
    const Errors e = errors(0, 23, 0.0f);
    EXPECT_NEAR(e.raw, 0.1, 0.01);
    EXPECT_LT(e.found, 0.4 * e.raw);
    // What a plane misses is never told as less than nothing.
    EXPECT_GT(e.told, 0.8 * e.found);
    EXPECT_LT(e.told, 2 * e.found);
    EXPECT_GT(e.radius, 3);
}

/// Variance of the mean of 8x8 pixels over that of one, by weights of bent planes of this radius on even records.
double common_share(int radius) {
    const double end = 1.1 * (radius + 0.5) * (radius + 0.5);
    const auto closeness = [&](double d2) { return d2 < end ? (1 - d2 / end) * (1 - d2 / end) : 0.0; };
    constexpr int far = 8;
    double sum = 0, second = 0, fourth = 0, of_pixel = 0, of_block = 0;
    for (int y = -far; y <= far; ++y)
        for (int x = -far; x <= far; ++x) {
            const double d2 = x * x + y * y, k = closeness(d2);
            sum += k, second += k * d2, fourth += k * d2 * d2;
        }
    // They sum to 1, and to 0 times the square of the distance.
    const auto weight = [&](int x, int y) {
        const double d2 = x * x + y * y;
        return closeness(d2) * (1 - second / fourth * d2) / (sum - second / fourth * second);
    };
    for (int y = -far; y < 8 + far; ++y)
        for (int x = -far; x < 8 + far; ++x) {
            double share = 0;
            for (int p = 0; p < 64; ++p) share += weight(x - p % 8, y - p / 8) / 64;
            of_block += share * share;
            of_pixel += weight(x, y) * weight(x, y);
        }
    return of_block / of_pixel;
}

TEST_F(NoisyWall, WhatABlockHasInCommonIsToldAndCosts) {
    strew_noisy(0.1f, 0.0f);
    // Shares of every record in the mean of 8x8 pixels, by the weights of each.
    std::vector<double> shares(records_.size(), 0.0);
    LocalRegression fit;
    double variance = 0, told = 0, of_pixel = 0;
    for (int p = 0; p < 64; ++p) {
        const GatherPoint& point = point_at(8 + p % 8, 8 + p / 8);
        const auto at = stage_.world().camera.project(point.point.position)->position;
        fit.collect({point, {0, 0.02f, 0}, at, stage_.world().camera.pixel_size() * 2.0f, receives(point)},
                    LocalRegression::Of::rays_light, map_, records_);
        const RegressionError error = fit.estimate();
        for (std::size_t k = 0; k < fit.size(); ++k) shares[fit.record(k)] += fit.weight(k) / 64.0;
        EXPECT_NEAR(error.of_block / error.variance, common_share(error.radius), 1e-4);
        const double shown = receives(point);
        told += error.of_block / (64 * shown * shown);
        of_pixel += error.variance / (64 * shown * shown);
    }
    for (const double share : shares) variance += share * share * 0.01;
    EXPECT_GT(variance, 4 * of_pixel / 64) << "neighbours share noise";
    EXPECT_NEAR(told / variance, 1.0, 0.35);
    // Where coding hides half as much of it, a pixel's error counts by three times of that more.
    EXPECT_DOUBLE_EQ((Allocation{0.1f, 0.5f}.priced(1.0, 0.25)), 1.75);
    EXPECT_DOUBLE_EQ((Allocation{0.1f}.priced(1.0, 0.25)), 1.0);
}

TEST_F(NoisyWall, StepsOfLightAreNoNoise) {
    strew_noisy(0.02f, 0.5f);
    const Errors e = errors(8, 15, 0.5f);
    EXPECT_LT(e.found, 2 * e.raw);
    EXPECT_LT(e.radius, 2);
}

TEST(Records, TellTheVarianceThatTheirReceiverSees) {
    // Of light that scatters by a tenth on a red wall, in one update and in two.
    GatherPoint red;
    red.weight = glm::vec3(1);
    red.point.bsdf.diffuse = {0.8f, 0.05f, 0.05f};
    const GatherPoint plain = plain_receiver(red);
    RayLight rays{{glm::vec3(1)}, 0.0f, 0.0f, 16};
    const double shown = shown_luminance(plain, rays.light);
    rays.batch_variance = static_cast<float>(0.01 * shown * shown);
    auto record = record_of(red, {}, {}, rays, 1.0f, 0);
    ASSERT_TRUE(record.has_value());
    EXPECT_NEAR(record->batch_variance * receives(plain) * receives(plain), rays.batch_variance, 1e-6);
    EXPECT_TRUE(take_rays(rays, plain, *record));
    EXPECT_EQ(record->ray_count, 32u);
    EXPECT_NEAR(record->batch_variance * receives(plain) * receives(plain), rays.batch_variance, 1e-6);
    rays.light[0].x = std::numeric_limits<float>::infinity();
    EXPECT_FALSE(take_rays(rays, plain, *record));
    EXPECT_EQ(record->ray_count, 32u);
}

TEST_F(NoisyWall, SmoothPlacesAreServedWithinATolerance) {
    strew_noisy(0.1f, 0.0f);
    EXPECT_TRUE(estimate_at(12, 12, 0.1f).has_value());
    EXPECT_FALSE(estimate_at(12, 12, 0.001f).has_value());
}

}  // namespace
}  // namespace render2mpeg::renderer
