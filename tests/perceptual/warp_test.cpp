#include "perceptual/warp.h"

#include <gtest/gtest.h>

#include <limits>

namespace render2mpeg::perceptual {
namespace {

constexpr int size = 12;

/// A wall of one object, seen from ahead; every pixel its own triangle.
core::Visible wall() {
    core::Visible visible(0, size, size);
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            visible.kind.at(x, y) = core::PixelClass::surface;
            visible.address.at(x, y) = {3, static_cast<std::uint32_t>(y * size + x), 0.25f, 0.25f};
            visible.material.at(x, y) = 1;
            visible.depth.at(x, y) = 5.0f;
            visible.geometric_normal.at(x, y) = core::PackedNormal(glm::vec3(0, 0, 1));
        }
    return visible;
}

core::MotionField motion(glm::vec2 vector, float depth = 5.0f) {
    core::MotionField field;
    field.vector = core::Plane<glm::vec2>(size, size, vector);
    field.depth_in_reference = core::Plane<float>(size, size, depth);
    field.kind = core::Plane<core::PixelClass>(size, size, core::PixelClass::surface);
    return field;
}

core::Plane<float> ramp() {
    core::Plane<float> plane(size, size);
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) plane.at(x, y) = 1.0f + static_cast<float>(3 * x + 20 * y);
    return plane;
}

TEST(Carry, WhatDoesNotMoveKeepsItsValues) {
    const core::MotionField still = motion({0, 0});
    EXPECT_EQ(warp(ramp(), wall(), wall(), nullptr), ramp());
    EXPECT_EQ(warp(ramp(), wall(), wall(), &still), ramp());
}

TEST(Carry, InterpolatesBetweenFourPixels) {
    const core::MotionField field = motion({1.25f, 0.25f});
    const core::Plane<float> warped = warp(ramp(), wall(), wall(), &field);
    EXPECT_FLOAT_EQ(warped.at(2, 3), 1 + 3 * 3.25f + 20 * 3.25f);
    EXPECT_EQ(warped.at(size - 1, 3), no_partner) << "it lies outside";
    EXPECT_EQ(warped.at(2, size - 1), 1 + 3 * 3.25f + 20 * (size - 1))
        << "less than half a pixel beyond the last centre, inside";
}

TEST(Carry, GoesOnBeyondTheSeamOfAPanorama) {
    core::MotionField field = motion({2.25f, 0});
    field.wraps = true;
    const core::Plane<float> warped = warp(ramp(), wall(), wall(), &field);
    EXPECT_FLOAT_EQ(warped.at(2, 3), 1 + 3 * 4.25f + 20 * 3);
    EXPECT_FLOAT_EQ(warped.at(size - 1, 3), 1 + 3 * 1.25f + 20 * 3);
    const float last = ramp().at(size - 1, 3), first = ramp().at(0, 3);
    EXPECT_FLOAT_EQ(warped.at(size - 3, 3), 0.75f * last + 0.25f * first) << "between the last column and the first";
    EXPECT_FLOAT_EQ(*value_along(field, ramp(), size - 1, 3), 1 + 3 * 1.25f + 20 * 3);
    field.vector = core::Plane<glm::vec2>(size, size, {-3, 0});
    EXPECT_FLOAT_EQ(warp(ramp(), wall(), wall(), &field).at(1, 0), 1 + 3 * (size - 2));
}

TEST(Carry, FindsNoPartnerInAnotherThing) {
    const core::MotionField still = motion({0, 0});
    const auto partner = [&](auto change) {
        core::Visible there = wall();
        change(there);
        return warp(ramp(), there, wall(), &still).at(4, 4);
    };
    EXPECT_GT(partner([](core::Visible&) {}), 0.0f);
    EXPECT_EQ(partner([](core::Visible& v) { v.address.at(4, 4).object = 2; }), no_partner);
    // Another triangle of the same object: only depth and normal can tell.
    const auto other = [](core::Visible& v) { v.address.at(4, 4).primitive = 9999; };
    EXPECT_GT(partner(other), 0.0f);
    EXPECT_EQ(partner([&](core::Visible& v) { other(v), v.material.at(4, 4) = 2; }), no_partner);
    EXPECT_EQ(partner([&](core::Visible& v) { other(v), v.kind.at(4, 4) = core::PixelClass::reflected; }), no_partner);
    EXPECT_EQ(partner([&](core::Visible& v) { other(v), v.depth.at(4, 4) = 5.4f; }), no_partner);
    EXPECT_EQ(partner([&](core::Visible& v) { other(v), v.depth.at(4, 4) = std::numeric_limits<float>::infinity(); }),
              no_partner);
    EXPECT_EQ(partner([&](core::Visible& v) {
                  other(v), v.geometric_normal.at(4, 4) = core::PackedNormal(glm::vec3(1, 0, 1));
              }),
              no_partner);
    // A triangle that is seen again is the same whatever its depth and normal have become.
    EXPECT_GT(partner([](core::Visible& v) { v.depth.at(4, 4) = 50.0f; }), 0.0f);
}

TEST(Carry, MixesNoValueAcrossAnEdge) {
    core::Visible there = wall();
    core::Plane<float> values(size, size, 1.0f);
    for (int y = 0; y < size; ++y)
        for (int x = 6; x < size; ++x) there.address.at(x, y).object = 8, values.at(x, y) = 1000.0f;
    const core::MotionField field = motion({0.5f, 0});
    const core::Plane<float> warped = warp(values, there, wall(), &field);
    for (int x = 0; x < 6; ++x) EXPECT_EQ(warped.at(x, 5), 1.0f) << x;
    EXPECT_EQ(warped.at(6, 5), no_partner);
}

TEST(Carry, HoldsOffMotionThatIsNone) {
    core::MotionField field = motion({0, 0});
    field.kind.at(2, 2) = core::PixelClass::none;
    field.vector.at(3, 3) = {std::numeric_limits<float>::quiet_NaN(), 0};
    field.vector.at(4, 4) = {1e30f, -1e30f};
    const core::Plane<float> warped = warp(ramp(), wall(), wall(), &field);
    EXPECT_EQ(warped.at(2, 2), no_partner);
    EXPECT_EQ(warped.at(3, 3), no_partner);
    EXPECT_EQ(warped.at(4, 4), no_partner);
}

TEST(Carry, TheSkyIsTheSameEverywhere) {
    core::Visible sky(0, size, size);
    for (core::PixelClass& kind : sky.kind.values()) kind = core::PixelClass::sky;
    core::MotionField field = motion({2, 1}, std::numeric_limits<float>::infinity());
    for (core::PixelClass& kind : field.kind.values()) kind = core::PixelClass::sky;
    EXPECT_FLOAT_EQ(warp(ramp(), sky, sky, &field).at(3, 3), 1 + 3 * 5 + 20 * 4);
}

}  // namespace
}  // namespace render2mpeg::perceptual
