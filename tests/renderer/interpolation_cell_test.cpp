#include "renderer/cache/interpolation_cell.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/color.h"
#include "core/numeric.h"
#include "tests/renderer/record_wall.h"

namespace render2mpeg::renderer {
namespace {

/// A square of the wall between points that records were asked for.
class Square : public Wall {
  protected:
    static constexpr int left = 8, top = 8, side = 4;
    static constexpr float white = 0.4f;

    glm::vec2 on_picture(const GatherPoint& p) const {
        return stage_.world().camera.project(p.point.position)->position;
    }
    float extent_of(const GatherPoint& p) const {
        return stage_.world().camera.pixel_size() * stage_.world().camera.project(p.point.position)->depth;
    }

    /// Points lie where `shift` moves them to within their pixels.
    GatherPoint shifted(int x, int y, glm::vec2 shift) const {
        GatherPoint p = point_at(x, y);
        p.point.position += extent_of(p) * glm::vec3(shift.x, -shift.y, 0.0f);
        return p;
    }

    template <class Light>
    std::array<CellCorner, 4> corners_of(Light&& light, glm::vec2 shift = {0, 0}) {
        std::array<CellCorner, 4> corners;
        for (int k = 0; k < 4; ++k) {
            const GatherPoint p = shifted(left + k % 2 * side, top + k / 2 * side, k == 1 ? -shift : shift);
            PointLight& found = told_[static_cast<std::size_t>(k)];
            found.direct = glm::vec3(0.25f * light(on_picture(p)));
            found.indirect = glm::vec3(0.75f * light(on_picture(p)));
            found.served = true;
            corners[static_cast<std::size_t>(k)] = {
                {on_picture(p), 0, surface_of(p.point.address, false), p.point.position, p.point.geometric_normal,
                 p.point.shading_normal},
                extent_of(p),
                &found,
                white,
                white,
                core::luminance(found.scattered(p)),
                1.0f,
                1.0f};
        }
        return corners;
    }

    std::optional<InterpolationCell> square_of(const std::array<CellCorner, 4>& corners) {
        return InterpolationCell::between(corners, side, map_, records_, frame);
    }
    /// What the square tells of a point; nothing where that is not within so much of its light.
    std::optional<float> told(const InterpolationCell& square, const GatherPoint& p, float relative) const {
        const auto light = light_of(square, p, relative);
        return light ? std::optional(light->direct.y + light->indirect.y) : std::nullopt;
    }
    std::optional<PointLight> light_of(const InterpolationCell& square, const GatherPoint& p, float relative,
                                       const CacheErrorModel& model = {}) const {
        PointLight light;
        const CacheQuery query{p, {{0, relative, 0}, 0}, on_picture(p), extent_of(p), white};
        if (!square.interpolate(query, model, light)) return std::nullopt;
        EXPECT_TRUE(light.served);
        return light;
    }
    int count_told(const InterpolationCell& square, float relative) const {
        int count = 0;
        for (int y = top; y < top + side; ++y)
            for (int x = left; x < left + side; ++x)
                count += told(square, point_at(x, y), relative).has_value() ? 1 : 0;
        return count;
    }

    static constexpr std::int64_t frame = 3;
    std::array<PointLight, 4> told_;
};

TEST_F(Square, LightThatChangesEvenlyIsToldWhereverPointsLie) {
    const auto light = [](glm::vec2 at) { return 1.0f + 0.05f * at.x - 0.03f * at.y; };
    strew(2, light);
    for (const glm::vec2 shift : {glm::vec2(0), glm::vec2(0.3f, -0.4f), glm::vec2(-0.45f, 0.2f)}) {
        const auto square = square_of(corners_of(light, shift));
        ASSERT_TRUE(square);
        for (int y = top + 1; y < top + side; ++y) {
            for (int x = left + 1; x < left + side; ++x) {
                const GatherPoint p = shifted(x, y, {0.2f, -0.3f});
                const auto found = told(*square, p, 0.02f);
                ASSERT_TRUE(found) << x << ", " << y;
                EXPECT_NEAR(*found, light(on_picture(p)), 2e-3f) << x << ", " << y;
            }
        }
    }
}

TEST_F(Square, RecordsInItThatKnowBetterAreBelieved) {
    // A thin shadow, which passes the corners by.
    strew(1, [](glm::vec2 at) { return std::floor(at.x) == left + 2 ? 0.8f : 1.0f; });
    const auto corners = corners_of([](glm::vec2) { return 1.0f; });
    const auto square = square_of(corners);
    ASSERT_TRUE(square);
    EXPECT_EQ(count_told(*square, 0.02f), 0);
    EXPECT_EQ(count_told(*square, 0.5f), side * side);
    for (std::uint32_t i = 0; i < records_.size(); ++i) records_.change(i).indirect = glm::vec3(1);
    EXPECT_EQ(count_told(square_of(corners).value(), 0.02f), side * side);
}

TEST_F(Square, CornersAloneDoNotTellAStepFromASlope) {
    for (const bool across : {true, false}) {
        const auto light = [across](glm::vec2 at) { return (across ? at.x - left : at.y - top) < 2 ? 1.0f : 1.3f; };
        records_ = {};
        strew(4, light);
        EXPECT_EQ(count_told(square_of(corners_of(light)).value(), 0.02f), 0) << across;
        EXPECT_EQ(count_told(square_of(corners_of(light)).value(), 0.5f), side * side) << across;
        // Those in the midst of its other sides do not either.
        for (std::uint32_t i = 0; i < records_.size(); ++i) {
            glm::vec3& at = records_.change(i).position;
            (across ? at.y : at.x) += 2.0f * extent_of(point_at(left, top)) * (across ? -1.0f : 1.0f);
        }
        map_.build(records_.all(), stage_.world().camera);
        EXPECT_EQ(count_told(square_of(corners_of(light)).value(), 0.02f), 0) << across;
        // Records in its midst tell that it is a slope.
        const auto slope = [across](glm::vec2 at) { return 1.0f + 0.02f * (across ? at.x : at.y); };
        records_ = {};
        strew(2, slope);
        EXPECT_EQ(count_told(square_of(corners_of(slope)).value(), 0.02f), side * side) << across;
    }
}

TEST_F(Square, WhatItsCornersMayBeOffByCounts) {
    strew(4, [](glm::vec2) { return 1.0f; });
    auto corners = corners_of([](glm::vec2) { return 1.0f; });
    told_[2].error = 0.03f * white;
    EXPECT_EQ(count_told(square_of(corners).value(), 0.02f), 0);
    EXPECT_EQ(count_told(square_of(corners).value(), 0.04f), side * side);
    told_[2].error = 0;
    told_[3].cache_error = 0.03f * white;  // of the tolerance of 1 that they had
    EXPECT_EQ(count_told(square_of(corners).value(), 0.02f), 0);
    EXPECT_EQ(count_told(square_of(corners).value(), 0.08f), side * side);
}

TEST_F(Square, AllThatIsKnownOfItsCornersIsTold) {
    strew(4, [](glm::vec2) { return 1.0f; });
    const auto corners = corners_of([](glm::vec2) { return 1.0f; });
    for (PointLight& light : told_) {
        light.age = 4;
        light.clamped = 0.1f * corners[0].scattered;
        light.error = 0.01f * white;
        light.cache_error = 0.02f * white;
    }
    told_[1].age = 8;
    told_[3].capped = true;
    const auto square = square_of(corners);
    ASSERT_TRUE(square);
    const GatherPoint p = point_at(left + 2, top);
    const auto light = light_of(*square, p, 0.1f);
    ASSERT_TRUE(light);
    EXPECT_NEAR(light->direct.x, 0.25f, 1e-5f);
    EXPECT_NEAR(light->indirect.x, 0.75f, 1e-5f);
    EXPECT_NEAR(light->age, 6.0f, 1e-3f);
    EXPECT_TRUE(light->capped);
    const float sent = core::luminance(light->scattered(p));
    EXPECT_NEAR(light->clamped, 0.1f * sent, 1e-3f * sent);
    // In tolerances, by the doubt that fine tolerances ask for, against that of 1 that the corners had.
    const float doubts = residual_factor({{0, 0.1f, 0}, 0}, sent, 0.1f * sent);
    EXPECT_NEAR(light->cache_error, 0.02f * white * white * std::max(doubts, 1.0f) / white / (0.1f * sent),
                0.02f * light->cache_error);
    EXPECT_GE(light->error, 0.01f * white);
    // Who is stricter doubts more.
    EXPECT_TRUE(light_of(*square, p, 0.1f, {1, 0.5f, 1, 1, 1.0f}));
    EXPECT_FALSE(light_of(*square, p, 0.1f, {1, 0.5f, 1, 1, 6.0f}));
}

TEST_F(Square, NothingIsBrighterOrDarkerThanItsCorners) {
    const auto light = [](glm::vec2 at) { return at.x < left + 2 ? 0.0f : 1.0f; };
    strew(2, [](glm::vec2 at) { return (at.x - left - 0.5f) / side; });
    const auto square = square_of(corners_of(light));
    ASSERT_TRUE(square);
    for (int y = top; y < top + side; ++y) {
        for (int x = left; x < left + side; ++x) {
            for (const float shift : {-0.9f, 0.0f, 0.9f}) {
                const auto found = light_of(*square, shifted(x, y, {shift, shift}), 1e6f);
                ASSERT_TRUE(found) << x << ", " << y;
                EXPECT_GE(found->direct.x, 0.0f);
                EXPECT_LE(found->direct.x + found->indirect.x, 1.0f);
                EXPECT_GE(found->age, 0.0f);
            }
        }
    }
}

TEST_F(Square, WhatIsNoticedOfColoursCounts) {
    // Between a blue light and none: hardly any luminance, but chroma.
    strew(1, [](glm::vec2) { return 1.0f; });
    for (std::uint32_t i = 0; i < records_.size(); ++i) records_.change(i).indirect = glm::vec3(1, 1, 1.3f);
    const auto corners = corners_of([](glm::vec2) { return 1.0f; });
    const auto square = square_of(corners);
    ASSERT_TRUE(square);
    GatherPoint p = point_at(left + 2, top + 2);
    p.point.bsdf.diffuse = glm::vec3(1);
    EXPECT_FALSE(told(*square, p, 0.08f)) << "luminance alone is off by 0.0217, doubted twice";
    EXPECT_TRUE(told(*square, p, 0.3f));
}

TEST_F(Square, RecordsOfLobesSayNothingOfIt) {
    strew(1, [](glm::vec2) { return 3.0f; });
    const auto corners = corners_of([](glm::vec2) { return 1.0f; });
    EXPECT_EQ(count_told(square_of(corners).value(), 0.02f), 0);
    for (std::uint32_t i = 0; i < records_.size(); ++i) records_.change(i).lobe.alpha = lobe_width;
    EXPECT_EQ(count_told(square_of(corners).value(), 0.02f), side * side);
}

TEST_F(Square, LightThatTwistsIsNotGuessed) {
    const auto light = [](glm::vec2 at) { return 1.0f + 0.02f * (at.x - left) * (at.y - top); };
    strew(4, light);
    const auto square = square_of(corners_of(light));
    ASSERT_TRUE(square);
    EXPECT_EQ(count_told(*square, 0.01f), 0);
    EXPECT_EQ(count_told(*square, 0.5f), side * side);
}

TEST_F(Square, OtherSurfacesHaveNoPartInIt) {
    strew(4, [](glm::vec2) { return 1.0f; });
    auto corners = corners_of([](glm::vec2) { return 1.0f; });
    const auto square = square_of(corners);
    ASSERT_TRUE(square);
    GatherPoint p = point_at(left + 2, top + 2);
    EXPECT_TRUE(told(*square, p, 0.02f));
    p.point.position.z += 0.5f;
    EXPECT_FALSE(told(*square, p, 0.02f));
    p = point_at(left + 2, top + 2);
    p.point.address.object = 7;
    EXPECT_FALSE(told(*square, p, 0.02f));
    // A bump: its normal is not what the corners' are.
    p = point_at(left + 2, top + 2);
    p.point.shading_normal = glm::normalize(glm::vec3(0.1f, 0, 1));
    EXPECT_FALSE(told(*square, p, 0.02f));
    EXPECT_TRUE(told(*square, p, 0.5f));
    corners[3].mark.position.z += 0.5f;
    EXPECT_FALSE(square_of(corners));
}

TEST_F(Square, CornersThatAreNoSquareTellNothing) {
    strew(4, [](glm::vec2) { return 1.0f; });
    const auto corners = corners_of([](glm::vec2) { return 1.0f; });
    auto flat = corners;
    for (CellCorner& c : flat) c.mark.at = corners[0].mark.at;
    EXPECT_FALSE(square_of(flat));
    auto crossed = corners;
    std::swap(crossed[0].mark.at, crossed[1].mark.at);
    EXPECT_FALSE(square_of(crossed));
    auto black = corners;
    black[1].receives = 0;
    EXPECT_FALSE(square_of(black));
    black = corners;
    black[2].reflects = 0;  // shows no disagreement
    EXPECT_FALSE(square_of(black));
    auto folded = corners;
    folded[3].mark.at = corners[0].mark.at;
    EXPECT_FALSE(square_of(folded));
}

TEST_F(Square, DarknessIsTold) {
    strew(2, [](glm::vec2) { return 0.0f; });
    const auto square = square_of(corners_of([](glm::vec2) { return 0.0f; }));
    ASSERT_TRUE(square);
    EXPECT_EQ(told(*square, point_at(left + 1, top + 1), 0.02f), 0.0f);
}

TEST_F(Square, WhatItRestsOnIsKept) {
    strew(1, [](glm::vec2) { return 1.0f; });
    ASSERT_TRUE(square_of(corners_of([](glm::vec2) { return 1.0f; })));
    for (std::uint32_t i = 0; i < records_.size(); ++i) {
        const glm::vec2 at = stage_.world().camera.project(records_[i].position)->position;
        const bool inside = at.x >= left && at.y >= top && at.x < left + side + 1 && at.y < top + side + 1;
        EXPECT_EQ(records_[i].used, inside ? frame : 0) << at.x << ", " << at.y;
    }
}

}  // namespace
}  // namespace render2mpeg::renderer
