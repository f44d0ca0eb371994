#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "core/sampling.h"
#include "scene/model/camera.h"

/// Cameras' two eyes, against the geometry of Blender's settings.
namespace render2mpeg::scene {
namespace {

constexpr double pi = std::numbers::pi;
constexpr int width = 256, height = 128;

float random(int stream, int i) {
    return core::uniform(static_cast<std::uint64_t>(stream), static_cast<std::uint64_t>(i));
}

const glm::mat4 somewhere = glm::translate(glm::mat4(1), glm::vec3(3, -2, 5)) *
                            glm::rotate(glm::mat4(1), 0.7f, glm::normalize(glm::vec3(0.2f, 1, -0.4f)));

Camera flat(Eye eye, const Stereo& stereo, const glm::mat4& to_world = glm::mat4(1)) {
    CameraLens lens;
    lens.stereo = stereo;
    lens.eye = eye;
    return Camera(lens, to_world, width, height, 2);
}

Camera around(Eye eye, const Stereo& stereo, const glm::mat4& to_world = glm::mat4(1)) {
    CameraLens lens;
    make_panorama(lens, {});
    lens.stereo = stereo;
    lens.eye = eye;
    return Camera(lens, to_world, width, height, 2);
}

/// Columns by which the left eye sees a point farther right than the right one.
float parallax(const Stereo& stereo, glm::vec3 world) {
    return flat(Eye::left, stereo).project(world)->position.x - flat(Eye::right, stereo).project(world)->position.x;
}

TEST(Stereo, FlatPicturesMeetAtThePlaneOfConvergenceOrInfinitelyFarAway) {
    Stereo stereo{.interocular_distance = 0.2, .convergence_distance = 4};
    for (const glm::vec2 at : {glm::vec2(0, 0), glm::vec2(1.5f, -0.7f), glm::vec2(-2, 0.4f)}) {
        EXPECT_NEAR(parallax(stereo, glm::vec3(at, -4)), 0, 1e-3);
        EXPECT_GT(parallax(stereo, glm::vec3(0.5f * at, -2)), 1);
        EXPECT_LT(parallax(stereo, glm::vec3(2.0f * at, -8)), -1);
    }
    stereo.convergence = Convergence::parallel;
    // Pixels of the distance at depth 4: by similar triangles, and so far apart everywhere.
    const double there = 0.2 / (4 * static_cast<double>(flat(Eye::left, stereo).pixel_size()));
    EXPECT_NEAR(parallax(stereo, {0.3f, 0.1f, -4}), there, 1e-3);
    EXPECT_NEAR(parallax(stereo, {30, 10, -4e5f}), 0, 1e-3);
    stereo.convergence = Convergence::toe_in;
    EXPECT_NEAR(parallax(stereo, {0, 0, -4}), 0, 1e-3);
    EXPECT_NEAR(flat(Eye::left, stereo).project({0, 0, -4})->position.x, width / 2, 1e-3);
}

TEST(Stereo, EyesLieBesideTheCameraOrOneOfThemIsIt) {
    for (const Convergence convergence : {Convergence::parallel, Convergence::off_axis, Convergence::toe_in})
        for (const Pivot pivot : {Pivot::left, Pivot::center, Pivot::right}) {
            const Stereo stereo{
                .interocular_distance = 0.3, .convergence_distance = 2, .convergence = convergence, .pivot = pivot};
            const Camera left = flat(Eye::left, stereo, somewhere), right = flat(Eye::right, stereo, somewhere),
                         single = flat(Eye::single, stereo, somewhere);
            EXPECT_NEAR(glm::distance(left.position(), right.position()), 0.3, 1e-5);
            EXPECT_EQ(single.to_world(), somewhere);
            const Camera& still = pivot == Pivot::left ? left : right;
            if (pivot == Pivot::center) {
                EXPECT_NEAR(glm::distance(0.5f * (left.position() + right.position()), single.position()), 0, 1e-5);
            } else {
                EXPECT_NEAR(glm::distance(still.position(), single.position()), 0, 1e-6);
                EXPECT_NEAR(glm::distance(still.ray_through({3, 5}).direction, single.ray_through({3, 5}).direction), 0,
                            1e-6);
            }
            // Wherever the camera moves, its eyes go with it.
            EXPECT_EQ(left.moved(glm::mat4(1), left.lens().vertical_fov).position(),
                      flat(Eye::left, stereo).position());
        }
}

TEST(Stereo, RaysOfPanoramasBeginOnACircleBesideTheirDirection) {
    for (const bool meets : {false, true}) {
        const Stereo stereo{.interocular_distance = 0.5,
                            .convergence_distance = 3,
                            .convergence = meets ? Convergence::off_axis : Convergence::parallel,
                            .pole_merge_to = 0};
        for (int i = 0; i < 500; ++i) {
            const glm::vec2 place{width * random(1, i), height * random(2, i)};
            const Ray ray = around(Eye::left, stereo).ray_through(place),
                      way = around(Eye::single, stereo).ray_through(place);
            EXPECT_NEAR(glm::length(ray.origin), 0.25, 1e-6);
            EXPECT_NEAR(ray.origin.y, 0, 1e-6);
            EXPECT_NEAR(glm::dot(ray.origin, way.direction), 0, 1e-6);
            EXPECT_GE(glm::cross(way.direction, ray.origin).y, 0) << "to the left";
            if (meets)
                EXPECT_NEAR(glm::length(glm::cross(3.0f * way.direction - ray.origin, ray.direction)), 0, 1e-5);
            else
                EXPECT_NEAR(glm::distance(ray.direction, way.direction), 0, 1e-6);
        }
    }
}

TEST(Stereo, ProjectingUndoesLookingRoundTheCircle) {
    for (const double merges : {0.0, 75.0})
        for (const Convergence convergence : {Convergence::parallel, Convergence::off_axis})
            for (const Eye eye : {Eye::left, Eye::right})
                for (int i = 0; i < 1000; ++i) {
                    const Stereo stereo{.interocular_distance = 0.4,
                                        .convergence_distance = 2.5,
                                        .convergence = convergence,
                                        .pole_merge_from = glm::radians(40.0),
                                        .pole_merge_to = glm::radians(merges)};
                    const Camera camera = around(eye, stereo, somewhere);
                    const glm::vec2 place{width * random(3, i), height * (0.02f + 0.96f * random(4, i))};
                    const Ray ray = camera.ray_through(place);
                    const float far = std::exp(8 * random(5, i) - 1);
                    const double level = std::cos((static_cast<double>(place.y) / height - 0.5) * pi);
                    // Near the axis a point is on rays to both sides, and single precision says little of where it is.
                    if (static_cast<double>(far) * level < 0.5) continue;
                    const auto seen = camera.project(ray.origin + far * ray.direction);
                    ASSERT_TRUE(seen);
                    EXPECT_NEAR(seen->position.y, place.y, 2e-3 / level) << far;
                    EXPECT_NEAR(camera.nearest_turn(seen->position, place).x, place.x, 2e-3 / level) << far;
                    EXPECT_NEAR(glm::distance(camera.eye_of(ray.origin + far * ray.direction), ray.origin), 0,
                                2e-4 / level);
                    const auto sky = camera.project_direction(ray.direction);
                    ASSERT_TRUE(sky);
                    EXPECT_TRUE(std::isinf(sky->depth));
                    EXPECT_NEAR(sky->position.y, place.y, 2e-3 / level);
                    EXPECT_NEAR(camera.nearest_turn(sky->position, place).x, place.x, 2e-3 / level);
                }
}

TEST(Stereo, PointsInFrontOfAPanoramaAreSeenAsFarApartAsTheCircleSays) {
    const Stereo stereo{.interocular_distance = 0.5, .convergence = Convergence::parallel, .pole_merge_to = 0};
    for (const double turn : {0.0, 1.0, -2.5}) {
        const glm::vec3 at(static_cast<float>(2 * std::sin(turn)), 0, static_cast<float>(-2 * std::cos(turn)));
        const glm::vec2 left = around(Eye::left, stereo).project(at)->position,
                        right = around(Eye::right, stereo).project(at)->position;
        // The line of sight is a tangent: asin(radius / distance) to either side.
        const double columns = width / (2 * pi) * 2 * std::asin(0.25 / 2);
        EXPECT_NEAR(left.x - right.x, columns, 1e-3);
        EXPECT_NEAR(left.y, height / 2, 1e-4);
    }
    EXPECT_FALSE(around(Eye::left, stereo).project({0.1f, 0, 0.1f})) << "within the circle";
}

TEST(Stereo, EyesComeTogetherTowardsThePoles) {
    const Stereo stereo{.interocular_distance = 0.5};
    const EyeCircle circle = circle_of(stereo, Eye::right);
    EXPECT_EQ(circle.at(glm::radians(-59.0)), 0.25);
    EXPECT_NEAR(circle.at(glm::radians(67.5)), 0.25 * std::cos(pi / 4), 1e-12);
    EXPECT_EQ(circle.at(glm::radians(76.0)), 0);
    EXPECT_EQ(circle_of(stereo, Eye::left).at(0.3), -0.25);
    const Camera left = around(Eye::left, stereo), right = around(Eye::right, stereo);
    const glm::vec3 above(0.3f, 5, 0.2f);
    EXPECT_EQ(left.project(above)->position, right.project(above)->position);
    EXPECT_EQ(left.ray_through({70, 3}).origin, glm::vec3(0));
    EXPECT_NE(left.project({0, 0, -5})->position, right.project({0, 0, -5})->position);
    EXPECT_NE(circle_of({.pole_merge_to = 0}, Eye::left).at(1.5), 0);
}

TEST(Stereo, APanoramaThatDoesNotLookAroundHasTwoPlaces) {
    const Stereo stereo{.interocular_distance = 0.5, .spherical = false};
    const Camera left = around(Eye::left, stereo), right = around(Eye::right, stereo);
    for (int i = 0; i < 20; ++i) {
        const glm::vec2 place{width * random(6, i), height * random(7, i)};
        EXPECT_EQ(left.ray_through(place).origin, glm::vec3(-0.25f, 0, 0));
        EXPECT_EQ(right.ray_through(place).origin, glm::vec3(0.25f, 0, 0));
        EXPECT_EQ(left.ray_through(place).direction, right.ray_through(place).direction);
    }
}

}  // namespace
}  // namespace render2mpeg::scene
