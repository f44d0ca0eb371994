#include "scene/model/track.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/constants.hpp>

#include "scene/load.h"
#include "scene/preparation/validate.h"

namespace render2mpeg::scene {
namespace {

Track track(Interpolation interpolation, std::vector<float> times, std::vector<float> values,
            TrackTarget target = TrackTarget::translation, int width = 3) {
    return {target, 0, interpolation, width, std::move(times), std::move(values)};
}

glm::vec3 value_at(const Track& t, double seconds) {
    std::array<float, 4> v{};
    t.sample(seconds, v);
    return {v[0], v[1], v[2]};
}

glm::quat rotation_at(const Track& t, double seconds) {
    std::array<float, 4> v{};
    t.sample(seconds, v);
    return {v[3], v[0], v[1], v[2]};
}

/// About +z; w first is glm's order, last ours.
std::vector<float> about_z(std::initializer_list<double> angles, double sign = 1) {
    std::vector<float> values;
    for (const double a : angles) {
        for (const double v : {0.0, 0.0, std::sin(a / 2), std::cos(a / 2)})
            values.push_back(static_cast<float>(sign * v));
    }
    return values;
}

TEST(Track, IsConstantBeforeTheFirstKeyAndAfterTheLast) {
    for (const Interpolation i : {Interpolation::step, Interpolation::linear}) {
        const Track t = track(i, {1, 2}, {1, 2, 3, 4, 5, 6});
        EXPECT_EQ(value_at(t, -1e9), glm::vec3(1, 2, 3));
        EXPECT_EQ(value_at(t, 1), glm::vec3(1, 2, 3));
        EXPECT_EQ(value_at(t, 2), glm::vec3(4, 5, 6));
        EXPECT_EQ(value_at(t, 1e9), glm::vec3(4, 5, 6));
    }
}

TEST(Track, OfOneKeyHasItsValueAlways) {
    const Track t = track(Interpolation::linear, {5}, {1, 2, 3});
    for (const double s : {0.0, 5.0, 6.0}) EXPECT_EQ(value_at(t, s), glm::vec3(1, 2, 3)) << s;
    const Track cubic = track(Interpolation::cubic_spline, {5}, {9, 9, 9, 1, 2, 3, 9, 9, 9});
    for (const double s : {0.0, 5.0, 6.0}) EXPECT_EQ(value_at(cubic, s), glm::vec3(1, 2, 3)) << s;
}

TEST(Track, StepHoldsUntilTheNextKeyAndLinearGoesStraight) {
    EXPECT_EQ(value_at(track(Interpolation::step, {0, 1}, {0, 0, 0, 8, 4, 2}), 0.999), glm::vec3(0));
    EXPECT_EQ(value_at(track(Interpolation::linear, {0, 1}, {0, 0, 0, 8, 4, 2}), 0.25), glm::vec3(2, 1, 0.5));
}

TEST(Track, CubicSplineIsTheHermiteCurveWithTangentsPerSecond) {
    // x(t) = t^3 over two seconds: tangents 0 and 12. y = t^2: 0 and 4. z = 1.
    const Track t = track(Interpolation::cubic_spline, {0, 2}, {0, 0, 0, 0, 0, 1, 0, 0, 0, 12, 4, 0, 8, 4, 1, 0, 0, 0});
    for (const double s : {0.0, 0.3, 1.0, 1.7, 2.0}) {
        EXPECT_NEAR(value_at(t, s).x, s * s * s, 1e-6) << s;
        EXPECT_NEAR(value_at(t, s).y, s * s, 1e-6) << s;
        EXPECT_NEAR(value_at(t, s).z, 1, 1e-6) << s;
    }
}

TEST(Track, CubicSplinesOfRotationsStayOnTheUnitSphere) {
    std::vector<float> values;
    for (const double angle : {0.0, 2.0}) {
        const std::vector<float> q = about_z({angle});
        values.insert(values.end(), {0, 0, 3, -5});
        values.insert(values.end(), q.begin(), q.end());
        values.insert(values.end(), {0, 0, 3, -5});
    }
    const Track t = track(Interpolation::cubic_spline, {0, 1}, values, TrackTarget::rotation, 4);
    for (const double s : {0.1, 0.5, 0.9}) EXPECT_NEAR(glm::length(rotation_at(t, s)), 1, 1e-6) << s;
}

TEST(Track, RotationsTurnAtConstantSpeedAlongTheShorterArc) {
    // 170 degrees and, by the other sign of the quaternion, the same.
    for (const double sign : {1.0, -1.0}) {
        std::vector<float> values = about_z({0.0});
        const std::vector<float> to = about_z({2.967}, sign);
        values.insert(values.end(), to.begin(), to.end());
        const Track t = track(Interpolation::linear, {0, 1}, values, TrackTarget::rotation, 4);
        for (const double s : {0.1, 0.25, 0.5, 0.9}) {
            const glm::vec3 x = rotation_at(t, s) * glm::vec3(1, 0, 0);
            EXPECT_NEAR(std::atan2(x.y, x.x), 2.967 * s, 2e-6) << s << " " << sign;
        }
    }
}

TEST(Track, RotationsThatAreAllButEqualInterpolateWithoutLossOfDigits) {
    for (const double angle : {1e-7, 1e-5, 1e-4, 1e-3}) {
        const Track t = track(Interpolation::linear, {0, 1}, about_z({0.0, angle}), TrackTarget::rotation, 4);
        const glm::quat q = rotation_at(t, 0.5);
        EXPECT_NEAR(2 * std::atan2(static_cast<double>(q.z), static_cast<double>(q.w)), angle / 2, 1e-7 * angle + 1e-14)
            << angle;
    }
}

TEST(Track, AntipodalQuaternionsAreOneRotation) {
    std::vector<float> values = about_z({0.7});
    for (const float v : about_z({0.7}, -1)) values.push_back(v);
    const Track t = track(Interpolation::linear, {0, 1}, values, TrackTarget::rotation, 4);
    for (const double s : {0.0, 0.3, 0.5, 1.0}) {
        const glm::vec3 x = rotation_at(t, s) * glm::vec3(1, 0, 0);
        EXPECT_NEAR(std::atan2(x.y, x.x), 0.7, 1e-6) << s;
    }
}

TEST(Track, QuaternionsWithoutLengthAreNoRotation) {
    const Track t = track(Interpolation::linear, {0, 1}, {0, 0, 0, 0, 0, 0, 0, 0}, TrackTarget::rotation, 4);
    for (const double s : {0.0, 0.5, 1.0}) EXPECT_EQ(rotation_at(t, s), glm::quat(1, 0, 0, 0)) << s;
}

TEST(Track, UnnormalisedQuaternionsAreNormalised) {
    std::vector<float> values = about_z({0.0, 1.0});
    for (float& v : values) v *= 20;
    const Track t = track(Interpolation::linear, {0, 1}, values, TrackTarget::rotation, 4);
    EXPECT_NEAR(glm::length(rotation_at(t, 0.0)), 1, 1e-6);
    EXPECT_NEAR(glm::length(rotation_at(t, 0.4)), 1, 1e-6);
}

TEST(Track, SamplesWideWeights) {
    const int width = 40;
    std::vector<float> values;
    for (int k = 0; k < 2; ++k)
        for (int i = 0; i < width; ++i) values.push_back(static_cast<float>(k * i));
    const Track t = track(Interpolation::linear, {0, 1}, values, TrackTarget::weights, width);
    std::vector<float> out(width);
    t.sample(0.5, out);
    for (int i = 0; i < width; ++i) EXPECT_EQ(out[static_cast<std::size_t>(i)], 0.5f * static_cast<float>(i));
}

TEST(Track, VariesWhereItsValuesOrItsTangentsDo) {
    EXPECT_FALSE(varies(track(Interpolation::linear, {0, 1}, {1, 2, 3, 1, 2, 3})));
    EXPECT_TRUE(varies(track(Interpolation::linear, {0, 1}, {1, 2, 3, 1, 2, 3.5f})));
    EXPECT_FALSE(varies(track(Interpolation::cubic_spline, {0}, {9, 9, 9, 1, 2, 3, 9, 9, 9})));
    EXPECT_FALSE(
        varies(track(Interpolation::cubic_spline, {0, 1}, {9, 9, 9, 1, 2, 3, 0, 0, 0, 0, 0, 0, 1, 2, 3, 9, 9, 9})));
    EXPECT_TRUE(
        varies(track(Interpolation::cubic_spline, {0, 1}, {0, 0, 0, 1, 2, 3, 0, 1, 0, 0, 0, 0, 1, 2, 3, 0, 0, 0})));
}

}  // namespace
}  // namespace render2mpeg::scene
