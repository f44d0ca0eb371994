#include "renderer/records.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "core/sampling.h"
#include "renderer/record_fit.h"
#include "renderer/record_gather.h"
#include "renderer/record_groups.h"
#include "renderer/record_plane.h"
#include "tests/renderer/stage.h"

namespace render2mpeg::renderer {
namespace {

constexpr int side = 24;

/// A wall that fills the picture, seen head on.
test::SceneBuilder wall() {
    test::SceneBuilder b;
    b.add_quad({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, b.add_material({0.5f, 0.4f, 0.3f}));
    b.add_camera({0, 0, 2}, {0, 0, 0});
    return b;
}

/// The wall with records here and there, whose irradiance is a function of their place on the picture.
class Wall : public ::testing::Test {
  protected:
    Wall() : stage_(wall(), side, side), seen_(stage_.see()), map_(side, side) {}

    template <class Light>
    void strew(int step, Light&& light) {
        for (const GatherTile& tile : seen_.tiles) {
            for (const GatherPoint& p : tile) {
                const auto at = stage_.world().camera.project(p.point.position);
                if (static_cast<int>(at->position.x) % step != 0 || static_cast<int>(at->position.y) % step != 0)
                    continue;
                Record r;
                r.address = p.point.address;
                r.position = p.point.position;
                r.geometric_normal = p.point.geometric_normal;
                r.shading_normal = p.point.shading_normal;
                r.indirect = glm::vec3(light(at->position));
                records_.add(r);
            }
        }
        map_.build(records_.all(), stage_.world().camera);
    }

    const GatherPoint& point_at(int x, int y) const {
        const int across = seen_.tiles_across();
        const GatherTile& tile = seen_.tiles[static_cast<std::size_t>(y / tile_size * across + x / tile_size)];
        for (const GatherPoint& p : tile)
            if (p.pixel == y % tile_size * tile_size + x % tile_size) return p;
        ADD_FAILURE();
        return tile.front();
    }

    RecordEstimate estimate_at(const GatherPoint& p, float relative) {
        const auto at = stage_.world().camera.project(p.point.position);
        const RecordQuery query{
            p, {0, relative, 0}, at->position, stage_.world().camera.pixel_size() * at->depth, 0.4f};
        return estimate(query, map_, records_, {}, 0);
    }
    RecordEstimate estimate_at(int x, int y, float relative) { return estimate_at(point_at(x, y), relative); }

    /// The records' light is what a lobe of white metal sends to an eye, which may be elsewhere than the camera.
    void polish(glm::vec3 eye) {
        for (std::uint32_t i = 0; i < records_.size(); ++i) {
            Record& r = records_.change(i);
            r.lobe = {lobe_width, glm::normalize(eye - r.position), r.indirect, glm::vec3(0)};
            r.indirect = glm::vec3(0);
        }
    }
    RecordEstimate estimate_polished(GatherPoint p, float relative) {
        const glm::vec3 eye = stage_.world().camera.position();
        p.point.bsdf = {glm::vec3(0), glm::vec3(1), lobe_width};
        p.point.outgoing = glm::normalize(eye - p.point.position);
        const auto at = stage_.world().camera.project(p.point.position);
        const float extent = stage_.world().camera.pixel_size() * at->depth;
        return estimate({p, {0, relative, 0}, at->position, extent, 1.0f, eye}, map_, records_, {}, 0);
    }
    static constexpr float lobe_width = 0.25f;

    test::Stage stage_;
    Seen seen_;
    Records records_;
    RecordMap map_;
};

TEST_F(Wall, LightThatChangesEvenlyIsFoundBetweenRecords) {
    const auto light = [](glm::vec2 at) { return 1.0f + 0.05f * at.x - 0.03f * at.y; };
    strew(4, light);
    int found = 0;
    for (int y = 5; y < 19; ++y) {
        for (int x = 5; x < 19; ++x) {
            const RecordEstimate e = estimate_at(x, y, 0.02f);
            if (!e.holds) continue;
            ++found;
            const float expected = light({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
            EXPECT_NEAR(e.light.indirect.x, expected, 1e-3f * expected) << x << ", " << y;
        }
    }
    EXPECT_GE(found, 14 * 14 * 9 / 10);
}

TEST_F(Wall, LightThatBendsIsFoundWhereRecordsKnowItsSlopes) {
    const auto light = [](glm::vec2 at) { return 1.0f + 0.01f * (at.x - 12.0f) * (at.x - 12.0f); };
    strew(4, light);
    const auto worst = [&] {
        std::pair<int, float> found{0, 0.0f};
        for (int y = 5; y < 19; ++y)
            for (int x = 5; x < 19; ++x) {
                const RecordEstimate e = estimate_at(x, y, 0.2f);
                const float expected = light({static_cast<float>(x) + 0.5f, 0.0f});
                if (!e.holds) continue;
                ++found.first;
                found.second = std::max(found.second, std::abs(e.light.indirect.x / expected - 1.0f));
            }
        return found;
    };
    const auto [found, off] = worst();
    const float pixel = stage_.world().camera.pixel_size() * 2.0f;  // the wall's distance
    for (std::uint32_t i = 0; i < records_.size(); ++i) {
        const float x = stage_.world().camera.project(records_[i].position)->position.x;
        records_.change(i).slopes.by_place[0] = glm::vec3(0.02f * (x - 12.0f) / pixel);
    }
    const auto [found_by_slopes, off_by_slopes] = worst();
    EXPECT_GE(found_by_slopes, found);
    EXPECT_GT(found, 14 * 14 / 2);
    EXPECT_GT(off, 0.02f);
    EXPECT_LT(off_by_slopes, 0.4f * off);
}

TEST_F(Wall, NobodyGuessesAcrossAnEdgeOfLight) {
    const auto light = [](glm::vec2 at) { return at.x < 11.0f ? 1.0f : 1.3f; };
    strew(2, light);
    int found = 0;
    for (int y = 4; y < 20; ++y) {
        for (int x = 1; x < 23; ++x) {
            const RecordEstimate e = estimate_at(x, y, 0.02f);
            if (!e.holds) continue;
            ++found;
            const float expected = light({static_cast<float>(x) + 0.5f, 0.0f});
            EXPECT_NEAR(e.light.indirect.x, expected, 0.05f * expected) << x << ", " << y;
        }
    }
    EXPECT_GE(found, 100);
    EXPECT_LE(found, 16 * 20);
}

TEST_F(Wall, RecordsOfAnotherSurfaceSayNothing) {
    strew(1, [](glm::vec2) { return 1.0f; });
    GatherPoint p = point_at(12, 12);
    EXPECT_TRUE(estimate_at(p, 0.02f).holds);
    GatherPoint other = p;
    other.point.address.object = 7;
    EXPECT_FALSE(estimate_at(other, 0.02f).holds);
    other = p;
    other.point.geometric_normal = other.point.shading_normal = glm::normalize(glm::vec3(1, 0, 1));
    EXPECT_FALSE(estimate_at(other, 0.02f).holds);
    // A step of the size of some pixels.
    other = p;
    other.point.position.z -= 0.5f;
    EXPECT_FALSE(estimate_at(other, 0.02f).holds);
}

TEST_F(Wall, NobodyIsServedBeyondWhereRecordsLie) {
    strew(1, [](glm::vec2 at) { return at.x < 12.0f ? 1.0f : 1.0f; });
    Records half;
    for (const Record& r : records_.all())
        if (stage_.world().camera.project(r.position)->position.x < 12.0f) half.add(r);
    records_ = half;
    map_.build(records_.all(), stage_.world().camera);
    EXPECT_TRUE(estimate_at(10, 12, 0.02f).holds);
    for (int x = 14; x < side; ++x) EXPECT_FALSE(estimate_at(x, 12, 0.02f).holds) << x;
}

TEST_F(Wall, RecordsAlongALineServeWhatLiesCloseToIt) {
    // As on a moulding of one pixel.
    const auto light = [](glm::vec2 at) { return 1.0f + 0.002f * at.y; };
    strew(1, light);
    Records line;
    for (const Record& r : records_.all())
        if (std::floor(stage_.world().camera.project(r.position)->position.x) == 12.0f) line.add(r);
    records_ = line;
    map_.build(records_.all(), stage_.world().camera);
    const auto holds = [&](float x, float relative) {
        GatherPoint p = point_at(12, 12);
        p.point.position.x += (x - 12.0f) * stage_.world().camera.pixel_size() * 2.0f;
        const RecordEstimate e = estimate_at(p, relative);
        if (e.holds) {
            EXPECT_NEAR(e.light.indirect.x, light({0.0f, 12.5f}), 0.01f) << x;
        }
        return e.holds;
    };
    EXPECT_TRUE(holds(12.4f, 0.05f));
    EXPECT_TRUE(holds(13.0f, 0.05f));
    EXPECT_FALSE(holds(13.8f, 0.05f));
    // What changes along the line may change across it as well.
    for (std::uint32_t i = 0; i < records_.size(); ++i) records_.change(i).indirect *= i % 2 == 0 ? 1.0f : 1.05f;
    EXPECT_FALSE(holds(12.4f, 0.05f));
}

TEST_F(Wall, LobesThatOneEyeSawAreFoundBetweenRecords) {
    // From pixel to pixel half vectors turn by a twelfth of the lobe's width.
    const auto light = [](glm::vec2 at) { return 1.0f + 0.05f * at.x - 0.03f * at.y; };
    strew(4, light);
    polish(stage_.world().camera.position());
    int found = 0;
    for (int y = 5; y < 19; ++y) {
        for (int x = 5; x < 19; ++x) {
            const RecordEstimate e = estimate_polished(point_at(x, y), 0.02f);
            if (!e.holds) continue;
            ++found;
            const float expected = light({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
            EXPECT_NEAR(e.light.glossy.x, expected, 1e-3f * expected) << x << ", " << y;
        }
    }
    EXPECT_GE(found, 14 * 14 * 9 / 10);
}

TEST_F(Wall, LobesThatAnotherEyeSawServeByHowFarItWas) {
    // Two away, an eye that moves by 0.05 turns half vectors by a twentieth of the width, one that moves by 0.3 by more
    // than an eighth.
    const auto holds = [&](float moved, float relative) {
        records_.forget();
        strew(2, [](glm::vec2) { return 1.0f; });
        polish(stage_.world().camera.position() + glm::vec3(moved, 0, 0));
        return estimate_polished(point_at(12, 12), relative).holds;
    };
    EXPECT_TRUE(holds(0.0f, 0.01f));
    EXPECT_FALSE(holds(0.05f, 0.02f));
    EXPECT_TRUE(holds(0.05f, 0.04f));
    EXPECT_FALSE(holds(0.3f, 10.0f));
}

TEST_F(Wall, RecordsAlongALineSayNothingOfLobesOfASurfaceThatBends) {
    strew(1, [](glm::vec2) { return 1.0f; });
    Records line;
    for (const Record& r : records_.all())
        if (std::floor(stage_.world().camera.project(r.position)->position.x) == 12.0f) line.add(r);
    records_ = line;
    polish(stage_.world().camera.position());
    map_.build(records_.all(), stage_.world().camera);
    const auto holds = [&](float bent, float relative) {
        GatherPoint p = point_at(12, 12);
        p.point.position.x += 0.4f * stage_.world().camera.pixel_size() * 2.0f;
        p.point.geometric_normal = p.point.shading_normal = {std::sin(bent), 0.0f, std::cos(bent)};
        return estimate_polished(p, relative).holds;
    };
    EXPECT_TRUE(holds(0.0f, 0.05f));
    EXPECT_TRUE(holds(0.01f, 0.05f));
    EXPECT_FALSE(holds(0.1f, 0.05f));
    // Beyond the lobe's width no tolerance helps.
    EXPECT_TRUE(holds(0.2f, 10.0f));
    EXPECT_FALSE(holds(0.3f, 10.0f));
}

TEST_F(Wall, CoarselyGatheredRecordsServeNoFinePixel) {
    strew(2, [](glm::vec2) { return 1.0f; });
    Records coarse;
    for (Record r : records_.all()) {
        r.error = 0.2f;
        coarse.add(r);
    }
    records_ = coarse;
    map_.build(records_.all(), stage_.world().camera);
    EXPECT_FALSE(estimate_at(12, 12, 0.02f).holds);
    EXPECT_TRUE(estimate_at(12, 12, 0.4f).holds);
}

TEST_F(Wall, RecordsOfOneSetErrAlikeAndThoseOfFourDoNot) {
    // 0.4 x 0.03 is more than 2 % of the wall's 0.41, half of it is less.
    strew(2, [](glm::vec2) { return 1.0f; });
    const auto holds = [&](bool one_set, bool capped, float error) {
        for (std::uint32_t i = 0; i < records_.size(); ++i) {
            const glm::vec2 at = stage_.world().camera.project(records_[i].position)->position;
            Record& r = records_.change(i);
            r.set = static_cast<std::uint8_t>(one_set ? 0 : record_set(static_cast<int>(at.x), static_cast<int>(at.y)));
            r.error = error;
            r.capped = capped;
        }
        return estimate_at(13, 13, 0.02f).holds;
    };
    EXPECT_TRUE(holds(false, false, 0.03f));
    EXPECT_FALSE(holds(true, false, 0.03f));
    EXPECT_TRUE(holds(true, false, 0.01f));
    // What the largest cut left counts as well.
    EXPECT_FALSE(holds(true, true, 0.03f));
}

TEST_F(Wall, APointsOwnRecordServesWhereLightHardlyChangesUpToIt) {
    // Light with an edge everywhere: no plane fits, and only the record at the place itself knows.
    strew(1, [](glm::vec2 at) { return (static_cast<int>(at.x) + static_cast<int>(at.y)) % 2 == 0 ? 1.0f : 1.3f; });
    const auto estimate_off = [&](float off, float relative) {
        GatherPoint p = point_at(12, 12);
        const float pixel = stage_.world().camera.pixel_size() * 2.0f;
        p.point.position.x += off * pixel;
        return estimate_at(p, relative);
    };
    // 30 % a pixel: 0.6 of it times the distance is within 2 % up to a thirtieth of a pixel.
    EXPECT_TRUE(estimate_off(0.0f, 0.02f).holds);
    EXPECT_FLOAT_EQ(estimate_off(0.0f, 0.02f).light.indirect.x, 1.0f);
    EXPECT_TRUE(estimate_off(0.02f, 0.02f).holds);
    EXPECT_FALSE(estimate_off(0.05f, 0.02f).holds);
    EXPECT_TRUE(estimate_off(0.05f, 0.04f).holds);
    EXPECT_FALSE(estimate_off(0.2f, 0.08f).holds);
}

TEST_F(Wall, MapsFindEveryRecordWhereItIsSeen) {
    strew(3, [](glm::vec2) { return 1.0f; });
    std::size_t found = 0;
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            for (const RecordMark& m : map_.row(y, x, x)) {
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
    records_.use(3, 6);
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
    for (const Record& r : records_.all()) EXPECT_GE(r.indirect.x, 3.0f);
}

TEST_F(Wall, EverySurfaceOfAPixelKeepsItsNewestRecords) {
    // As after a cut to a far view: many surfaces, each with some records, in one pixel.
    for (std::uint32_t i = 0; i < 600; ++i) {
        Record r;
        r.address.object = i % 100;
        r.position = point_at(12, 12).point.position;
        r.indirect = glm::vec3(static_cast<float>(i));
        records_.add(r);
    }
    map_.build(records_.all(), stage_.world().camera);
    records_.thin(0, map_);
    ASSERT_EQ(records_.size(), 4u * 100u);
    for (const Record& r : records_.all()) EXPECT_GE(r.indirect.x, 200.0f);
}

TEST_F(Wall, NobodyIsServedWhereThePictureDoesNotReach) {
    strew(1, [](glm::vec2) { return 1.0f; });
    const GatherPoint p = point_at(12, 12);
    const float extent = stage_.world().camera.pixel_size() * 2.0f, none = std::numeric_limits<float>::quiet_NaN();
    const auto holds = [&](glm::vec2 at) {
        return estimate({p, {0, 0.02f, 0}, at, extent, 0.4f}, map_, records_, {}, 0).holds;
    };
    EXPECT_TRUE(holds({12.5f, 12.5f}));
    for (const float off : {-1e30f, -40.0f, -15.5f, -14.0f, -10.0f, 33.5f, 38.0f, 39.5f, 60.0f, 1e30f, none}) {
        EXPECT_FALSE(holds({off, 12.5f})) << off;
        EXPECT_FALSE(holds({12.5f, off})) << off;
    }
}

TEST_F(Wall, RecordsKeepTheirErrorsWithoutCaution) {
    const GatherPoint p = point_at(12, 12);
    PointLight light;
    light.direct = glm::vec3(1);
    light.error = 0.03f;
    const auto plain = record_of(p, light, {}, 1.0f, 0);
    light.error *= 2.5f;
    const auto cautious = record_of(p, light, {}, 2.5f, 0);
    ASSERT_TRUE(plain && cautious);
    EXPECT_GT(plain->error, 0.03f);
    EXPECT_NEAR(cautious->error, plain->error, 1e-6f);
}

TEST_F(Wall, LobesOfRoughnessTwoTenthsAndMoreTakeRecords) {
    const LobeTrials untried;
    GatherPoint p = point_at(12, 12);
    EXPECT_TRUE(takes_records(p, untried));
    p.point.bsdf = {glm::vec3(0.5f), glm::vec3(0.04f), 0.2f * 0.2f};
    EXPECT_TRUE(takes_records(p, untried));
    p.point.bsdf.alpha = 0.19f * 0.19f;
    EXPECT_FALSE(takes_records(p, untried));
    p.point.bsdf.alpha = 1.0f;
    p.reached_by_specular = true;
    EXPECT_FALSE(takes_records(p, untried));
}

TEST_F(Wall, LobesOfAMaterialThatIsNotServedTakeNoRecords) {
    LobeTrials trials;
    for (int frame = 0; frame < 2; ++frame) {
        trials.note(3, 100, 5);
        trials.judge();
    }
    GatherPoint p = point_at(12, 12);
    p.point.material = 3;
    EXPECT_TRUE(takes_records(p, trials)) << "without a lobe";
    p.point.bsdf.f0 = glm::vec3(0.04f);
    EXPECT_FALSE(takes_records(p, trials));
    p.point.material = 4;
    EXPECT_TRUE(takes_records(p, trials));
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

TEST(RecordPlane, ReachesNoFartherThanItsSamplesAreApart) {
    RecordPlane together, about, beside;
    for (int i = 0; i < 4; ++i) {
        const glm::vec2 corner{i % 2 == 0 ? -0.5f : 0.5f, i / 2 == 0 ? -0.5f : 0.5f};
        together.add({1.1f, 0.5f}, 0.37f, glm::vec3(1));
        about.add(corner, 1.0f, glm::vec3(1));
        beside.add(corner + glm::vec2{1, 1}, 1.0f, glm::vec3(1));
    }
    EXPECT_GT(together.reach(), 1e5f);  // whatever rounding makes of no distance at all
    EXPECT_EQ(about.reach(), 0.0f);
    EXPECT_NEAR(beside.reach(), 2.0f, 1e-5f);
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
