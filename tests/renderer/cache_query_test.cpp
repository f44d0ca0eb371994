#include "renderer/cache/cache_query.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "renderer/cache/plane_fit.h"
#include "renderer/cache/request_groups.h"
#include "tests/renderer/record_wall.h"

namespace render2mpeg::renderer {
namespace {

TEST_F(Wall, LightThatChangesEvenlyIsFoundBetweenRecords) {
    const auto light = [](glm::vec2 at) { return 1.0f + 0.05f * at.x - 0.03f * at.y; };
    strew(4, light);
    int found = 0;
    for (int y = 5; y < 19; ++y) {
        for (int x = 5; x < 19; ++x) {
            const CacheEstimate e = estimate_at(x, y, 0.02f);
            if (!e.valid) continue;
            ++found;
            const float expected = light({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
            EXPECT_NEAR(e.light.indirect.x, expected, 1e-3f * expected) << x << ", " << y;
        }
    }
    EXPECT_GE(found, 14 * 14 * 9 / 10);
}

TEST_F(Wall, NobodyGuessesAcrossAnEdgeOfLight) {
    const auto light = [](glm::vec2 at) { return at.x < 11.0f ? 1.0f : 1.3f; };
    strew(2, light);
    int found = 0;
    for (int y = 4; y < 20; ++y) {
        for (int x = 1; x < 23; ++x) {
            const CacheEstimate e = estimate_at(x, y, 0.02f);
            if (!e.valid) continue;
            ++found;
            const float expected = light({static_cast<float>(x) + 0.5f, 0.0f});
            EXPECT_NEAR(e.light.indirect.x, expected, 0.05f * expected) << x << ", " << y;
        }
    }
    EXPECT_GE(found, 100);
    EXPECT_LE(found, 16 * 20);
}

TEST_F(Wall, TwoColumnsOfALatticeDoNotTellAnEdgeFromASlope) {
    for (int k = 0; k < 16; ++k) {
        const float edge = 10.0f + static_cast<float>(k % 4), along = k / 4 % 2 == 0 ? 0.0f : 0.01f;
        const auto light = [&](glm::vec2 at) {
            return ((k < 8 ? at.x : at.y) < edge ? 1.0f : 1.3f) + along * (k < 8 ? at.y : at.x);
        };
        records_ = {};
        strew(4, light);
        int found = 0;
        for (int y = 4; y < 20; ++y) {
            for (int x = 4; x < 20; ++x) {
                const CacheEstimate e = estimate_at(x, y, 0.02f);
                if (!e.valid) continue;
                ++found;
                const float expected = light({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
                EXPECT_NEAR(e.light.indirect.x, expected, 0.04f * expected) << k << ": " << x << ", " << y;
            }
        }
        EXPECT_GE(found, 16 * 16 / 4) << k;
    }
}

TEST_F(Wall, RecordsOfAnotherSurfaceSayNothing) {
    strew(1, [](glm::vec2) { return 1.0f; });
    GatherPoint p = point_at(12, 12);
    EXPECT_TRUE(estimate_at(p, 0.02f).valid);
    GatherPoint other = p;
    other.point.address.object = 7;
    EXPECT_FALSE(estimate_at(other, 0.02f).valid);
    other = p;
    other.point.geometric_normal = other.point.shading_normal = glm::normalize(glm::vec3(1, 0, 1));
    EXPECT_FALSE(estimate_at(other, 0.02f).valid);
    // A step of the size of some pixels.
    other = p;
    other.point.position.z -= 0.5f;
    EXPECT_FALSE(estimate_at(other, 0.02f).valid);
}

TEST_F(Wall, NobodyIsServedBeyondWhereRecordsLie) {
    strew(1, [](glm::vec2 at) { return at.x < 12.0f ? 1.0f : 1.0f; });
    RecordStore half;
    for (const IrradianceRecord& r : records_.all())
        if (stage_.world().camera.project(r.position)->position.x < 12.0f) half.insert(r);
    records_ = half;
    map_.build(records_.all(), stage_.world().camera);
    EXPECT_TRUE(estimate_at(10, 12, 0.02f).valid);
    for (int x = 14; x < wall_side; ++x) EXPECT_FALSE(estimate_at(x, 12, 0.02f).valid) << x;
}

TEST_F(Wall, RecordsAlongALineServeWhatLiesCloseToIt) {
    // As on a moulding of one pixel.
    const auto light = [](glm::vec2 at) { return 1.0f + 0.002f * at.y; };
    strew(1, light);
    RecordStore line;
    for (const IrradianceRecord& r : records_.all())
        if (std::floor(stage_.world().camera.project(r.position)->position.x) == 12.0f) line.insert(r);
    records_ = line;
    map_.build(records_.all(), stage_.world().camera);
    const auto holds = [&](float x, float relative) {
        GatherPoint p = point_at(12, 12);
        p.point.position.x += (x - 12.0f) * stage_.world().camera.pixel_size() * 2.0f;
        p.point.address.u += x - 12.0f;
        const CacheEstimate e = estimate_at(p, relative);
        if (e.valid) {
            EXPECT_NEAR(e.light.indirect.x, light({0.0f, 12.5f}), 0.01f) << x;
        }
        return e.valid && !e.moved_to;
    };
    EXPECT_TRUE(holds(12.4f, 0.05f));
    EXPECT_TRUE(holds(12.7f, 0.05f));
    EXPECT_FALSE(holds(12.8f, 0.05f)) << "the next row of pixels may be lit otherwise";
    // What changes along the line may change across it as well.
    for (std::uint32_t i = 0; i < records_.size(); ++i) records_.change(i).indirect *= i % 2 == 0 ? 1.0f : 1.05f;
    EXPECT_FALSE(holds(12.4f, 0.05f));
}

TEST_F(Wall, CoarselyGatheredRecordsServeNoFinePixel) {
    strew(2, [](glm::vec2) { return 1.0f; });
    RecordStore coarse;
    for (IrradianceRecord r : records_.all()) {
        r.error = 0.2f;
        coarse.insert(r);
    }
    records_ = coarse;
    map_.build(records_.all(), stage_.world().camera);
    EXPECT_FALSE(estimate_at(12, 12, 0.02f).valid);
    EXPECT_TRUE(estimate_at(12, 12, 0.4f).valid);
}

TEST_F(Wall, RecordsOfOneSetErrAlikeAndThoseOfFourDoNot) {
    // 0.4 x 0.03 is more than 2 % of the wall's 0.41, half of it is less.
    strew(2, [](glm::vec2) { return 1.0f; });
    const auto holds = [&](bool one_set, bool capped, float error) {
        for (std::uint32_t i = 0; i < records_.size(); ++i) {
            const glm::vec2 at = stage_.world().camera.project(records_[i].position)->position;
            IrradianceRecord& r = records_.change(i);
            r.set = static_cast<std::uint8_t>(one_set ? 0 : record_set(static_cast<int>(at.x), static_cast<int>(at.y)));
            r.error = error;
            r.capped = capped;
        }
        return estimate_at(13, 13, 0.02f).valid;
    };
    EXPECT_TRUE(holds(false, false, 0.03f));
    EXPECT_FALSE(holds(true, false, 0.03f));
    EXPECT_TRUE(holds(true, false, 0.01f));
    // What the largest cut left counts as well.
    EXPECT_FALSE(holds(true, true, 0.03f));
}

/// Light with an edge everywhere: no plane fits, and each record knows its own place alone.
float chequered(glm::vec2 at) {
    return (static_cast<int>(at.x) + static_cast<int>(at.y)) % 2 == 0 ? 1.0f : 1.3f;
}

TEST_F(Wall, APixelsOwnRecordServesItAtTheRecordsPlaceWhereOthersDisagree) {
    strew(1, chequered);
    const float pixel = stage_.world().camera.pixel_size() * 2.0f;  // the wall's distance
    const auto estimate_off = [&](float off, float relative = 0.02f) {
        GatherPoint p = point_at(12, 12);
        p.point.position.x += off * pixel;
        p.point.address.u += off;
        return estimate_at(p, relative);
    };
    // 30 % a pixel: twice the tolerance lies 0.13 pixels off.
    for (const float off : {0.0f, 0.02f, -0.06f, 0.12f}) {
        const CacheEstimate e = estimate_off(off);
        ASSERT_TRUE(e.valid) << off;
        // 0.6 of it times the distance is within 2 % up to a thirtieth of a pixel: there light is the point's own.
        EXPECT_EQ(e.moved_to.has_value(), std::abs(off) > 0.03f);
        EXPECT_FLOAT_EQ(e.light.indirect.x, 1.0f) << off;
        EXPECT_EQ(e.light.cache_error > 0.0f, off != 0.0f && !e.moved_to);
        if (!e.moved_to) continue;
        const glm::vec2 place = stage_.world().camera.project(records_[*e.moved_to].position)->position;
        EXPECT_EQ(glm::floor(place), glm::vec2(12, 12)) << off;
    }
    EXPECT_FALSE(estimate_off(0.15f).valid);
    EXPECT_FALSE(estimate_off(0.3f).valid);
    EXPECT_TRUE(estimate_off(0.3f, 0.05f).valid);
    // The pixel beside has another.
    EXPECT_FLOAT_EQ(estimate_off(0.95f).light.indirect.x, 1.3f);
    EXPECT_FALSE(estimate_off(0.55f).valid);
    // Where others agree it is light at the point itself.
    records_.forget();
    strew(1, [](glm::vec2) { return 1.0f; });
    EXPECT_TRUE(estimate_off(0.3f).valid);
    EXPECT_FALSE(estimate_off(0.3f).moved_to);
}

TEST_F(Wall, OfSeveralRecordsInAPixelTheNearestThatIsFineEnoughServes) {
    strew(1, chequered);
    const float pixel = stage_.world().camera.pixel_size() * 2.0f;
    const auto add = [&](float off, float light, float error) {
        const auto r0 = std::find_if(records_.all().begin(), records_.all().end(), [&](const IrradianceRecord& known) {
            return known.address == point_at(12, 12).point.address;
        });
        IrradianceRecord r = *r0;
        r.address.u = 2.0f;  // another place
        r.position.x += off * pixel;
        r.indirect = glm::vec3(light);
        r.error = error;
        records_.insert(r);
        map_.build(records_.all(), stage_.world().camera);
    };
    add(0.2f, 1.01f, 0.0f);
    GatherPoint p = point_at(12, 12);
    EXPECT_FLOAT_EQ(estimate_at(p, 0.02f).light.indirect.x, 1.0f);
    p.point.position.x += 0.25f * pixel;
    EXPECT_FLOAT_EQ(estimate_at(p, 0.02f).light.indirect.x, 1.01f);
    // 0.4 x 0.03 is more than 2 % of the wall's 0.41, and less than 4 %.
    add(0.24f, 1.02f, 0.03f);
    EXPECT_FLOAT_EQ(estimate_at(p, 0.02f).light.indirect.x, 1.01f);
    EXPECT_FLOAT_EQ(estimate_at(p, 0.04f).light.indirect.x, 1.02f);
}

TEST_F(Wall, NoRecordServesAPixelItWouldShareNoGatherPointIn) {
    strew(1, chequered);
    ASSERT_TRUE(estimate_at(12, 12, 0.02f).valid);
    const auto holds_turned = [&](float degrees) {
        GatherPoint p = point_at(12, 12);
        const float angle = glm::radians(degrees);
        p.point.shading_normal = {std::sin(angle), 0, std::cos(angle)};
        return estimate_at(p, 0.02f).valid;
    };
    EXPECT_TRUE(holds_turned(8));
    EXPECT_FALSE(holds_turned(15));
    GatherPoint p = point_at(12, 12);
    p.point.position.z -= 2.0f * stage_.world().camera.pixel_size() * 0.6f;
    EXPECT_FALSE(estimate_at(p, 0.02f).valid);
}

TEST_F(Wall, NobodyIsServedWhereThePictureDoesNotReach) {
    strew(1, [](glm::vec2) { return 1.0f; });
    const GatherPoint p = point_at(12, 12);
    const float extent = stage_.world().camera.pixel_size() * 2.0f, none = std::numeric_limits<float>::quiet_NaN();
    const auto holds = [&](glm::vec2 at) {
        return query_cache({p, {0, 0.02f, 0}, at, extent, 0.4f}, map_, records_, {}, 0).valid;
    };
    EXPECT_TRUE(holds({12.5f, 12.5f}));
    for (const float off : {-1e30f, -40.0f, -15.5f, -14.0f, -10.0f, 33.5f, 38.0f, 39.5f, 60.0f, 1e30f, none}) {
        EXPECT_FALSE(holds({off, 12.5f})) << off;
        EXPECT_FALSE(holds({12.5f, off})) << off;
    }
}

TEST(PlaneFit, ReachesNoFartherThanItsSamplesAreApart) {
    PlaneFit together, about, beside;
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

}  // namespace
}  // namespace render2mpeg::renderer
