#include "renderer/cache/irradiance_record.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "core/sampling.h"
#include "renderer/cache/gather_requests.h"
#include "renderer/cache/request_groups.h"
#include "tests/renderer/record_wall.h"

namespace render2mpeg::renderer {
namespace {

TEST_F(Wall, MapsFindEveryRecordWhereItIsSeen) {
    strew(3, [](glm::vec2) { return 1.0f; });
    std::size_t found = 0;
    for (int y = 0; y < wall_side; ++y) {
        for (int x = 0; x < wall_side; ++x) {
            for (const SurfaceMark& m : map_.row(y, x, x)) {
                ++found;
                EXPECT_EQ(std::floor(m.at.x), static_cast<float>(x));
                EXPECT_EQ(std::floor(m.at.y), static_cast<float>(y));
                EXPECT_EQ(m.position, records_[m.record].position);
            }
        }
    }
    EXPECT_EQ(found, records_.size());
    EXPECT_EQ(found, 64u);
}

TEST_F(Wall, WhatServesNobodyIsForgotten) {
    strew(4, [](glm::vec2) { return 1.0f; });
    const std::size_t all = records_.size();
    records_.mark_used(3, 6);
    records_.thin(8, map_);
    EXPECT_EQ(records_.size(), all);
    records_.thin(9, {});
    EXPECT_EQ(records_.size(), 1u);
    records_.thin(15, {});
    EXPECT_EQ(records_.size(), 0u);
}

TEST_F(Wall, NoPixelKeepsMoreRecordsThanSayMore) {
    for (int i = 0; i < 7; ++i) strew(3, [&](glm::vec2) { return static_cast<float>(i); });
    ASSERT_EQ(records_.size(), 7u * 64u);
    records_.thin(0, map_);
    ASSERT_EQ(records_.size(), 4u * 64u);
    // The newest.
    for (const IrradianceRecord& r : records_.all()) EXPECT_GE(r.indirect.x, 3.0f);
}

TEST_F(Wall, EverySurfaceOfAPixelKeepsItsNewestRecords) {
    // As after a cut to a far view: many surfaces, each with some records, in one pixel.
    for (std::uint32_t i = 0; i < 600; ++i) {
        IrradianceRecord r;
        r.address.object = i % 100;
        r.position = point_at(12, 12).point.position;
        r.indirect = glm::vec3(static_cast<float>(i));
        records_.insert(r);
    }
    map_.build(records_.all(), stage_.world().camera);
    records_.thin(0, map_);
    ASSERT_EQ(records_.size(), 4u * 100u);
    for (const IrradianceRecord& r : records_.all()) EXPECT_GE(r.indirect.x, 200.0f);
}

TEST_F(Wall, RecordsKeepTheirErrorsWithoutErrorScale) {
    const GatherPoint p = point_at(12, 12);
    PointLight light;
    light.direct = glm::vec3(1);
    light.error = {0.03f};
    const auto plain = record_of(p, light, {}, {}, 1.0f, 0);
    light.error = 2.5f * light.error;
    const auto cautious = record_of(p, light, {}, {}, 2.5f, 0);
    ASSERT_TRUE(plain && cautious);
    EXPECT_GT(plain->error.value, 0.03f);
    EXPECT_NEAR(cautious->error.value, plain->error.value, 1e-6f);
}

TEST_F(Wall, EveryRequestIsGatheredOnceInGroupsOfOneSet) {
    std::vector<PointRef> requests;
    for (std::uint32_t t = 0; t < seen_.tiles.size(); ++t)
        for (std::uint32_t i = 0; i < seen_.tiles[t].size(); ++i)
            if (core::uniform(3, t, i) < 0.4f) requests.push_back({t, i});
    std::set<std::pair<std::uint32_t, std::uint32_t>> met;
    std::size_t full = 0, points = 0;
    const auto groups = group_requests(seen_, requests, stage_.world().camera.position());
    for (const RequestGroup& group : groups) {
        ASSERT_LE(group.points.size(), 16u);
        full += group.points.size() == 16 ? 1 : 0;
        points += group.points.size();
        for (const PointRef& p : group.points) EXPECT_TRUE(met.insert({p.tile, p.index}).second);
    }
    EXPECT_EQ(points, requests.size());
    EXPECT_GE(full, groups.size() * 3 / 4);
}

TEST(RecordSets, AreEvenlySpreadOnEveryLattice) {
    for (const int step : {1, 2, 4}) {
        int of_set[4] = {};
        for (int y = 0; y < 32; y += step)
            for (int x = 0; x < 32; x += step) ++of_set[record_set(x, y)];
        for (const int count : of_set) EXPECT_EQ(count, 32 * 32 / step / step / 4) << step;
    }
}

}  // namespace
}  // namespace render2mpeg::renderer
