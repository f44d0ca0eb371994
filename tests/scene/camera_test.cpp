#include "scene/model/camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>

#include "core/sampling.h"

namespace render2mpeg::scene {
namespace {

constexpr int width = 1920, height = 1080;
constexpr float aspect = 1920.0f / 1080.0f;

CameraLens lens(double fov) {
    CameraLens result;
    result.vertical_fov = static_cast<float>(fov);
    return result;
}

CameraLens orthographic(float magnification) {
    CameraLens result;
    result.projection = ProjectionKind::orthographic;
    result.y_magnification = magnification;
    return result;
}

glm::mat4 placed(glm::vec3 position, double yaw, double pitch) {
    const glm::dquat q = glm::angleAxis(yaw, glm::dvec3(0, 1, 0)) * glm::angleAxis(pitch, glm::dvec3(1, 0, 0));
    glm::dmat4 m = glm::mat4_cast(q);
    m[3] = glm::dvec4(position, 1);
    return glm::mat4(m);
}

glm::vec2 random_position(int i) {
    return {width * core::uniform(1, static_cast<std::uint64_t>(i)),
            height * core::uniform(2, static_cast<std::uint64_t>(i))};
}

TEST(Camera, LooksAlongMinusZWithYUpAndXRight) {
    const Camera camera(lens(glm::half_pi<double>()), glm::mat4(1.0f), 200, 100, 2.0f);
    const auto centre = camera.project({0, 0, -5});
    ASSERT_TRUE(centre);
    EXPECT_EQ(centre->position, glm::vec2(100, 50));
    EXPECT_EQ(centre->depth, 5);
    const auto corner = camera.project({2, 1, -1});
    ASSERT_TRUE(corner);
    EXPECT_NEAR(corner->position.x, 200, 1e-4);
    EXPECT_NEAR(corner->position.y, 0, 1e-4);
    EXPECT_EQ(camera.forward(), glm::vec3(0, 0, -1));
    EXPECT_NEAR(camera.pixel_size(), 0.02f, 1e-7);
}

TEST(Camera, ASphereIsRoundAsShownWhateverThePixels) {
    // Of a sphere on the axis, the outermost points to the right and above are as far from the centre when the picture
    // is shown, and a pixel of the picture's own is that much narrower or wider.
    struct Format {
        int width, height;
        double pixel_aspect;
    };
    for (const Format f :
         {Format{720, 576, 64.0 / 45}, {720, 576, 16.0 / 15}, {720, 480, 8.0 / 9}, {704, 480, 40.0 / 33}})
        for (const bool perspective : {true, false}) {
            const float shape = static_cast<float>(f.width * f.pixel_aspect / f.height);
            const Camera camera(perspective ? lens(0.9) : orthographic(3), glm::mat4(1.0f), f.width, f.height, shape);
            const auto right = camera.project({1, 0, -5}), above = camera.project({0, 1, -5});
            ASSERT_TRUE(right && above);
            const double across = right->position.x - 0.5 * f.width, up = 0.5 * f.height - above->position.y;
            EXPECT_NEAR(across * f.pixel_aspect / up, 1, 1e-6);
            EXPECT_NEAR(camera.pixel_size() * up, perspective ? 0.2 : 1, 1e-5);
        }
}

TEST(Camera, AShiftedLensMovesThePictureAndNothingElse) {
    for (const bool perspective : {true, false}) {
        CameraLens plain = perspective ? lens(0.9) : orthographic(3), shifted = plain;
        shifted.shift = {0.25f, -0.1f};
        const glm::mat4 to_world = placed({1, 2, 3}, 0.5, 0.2);
        const Camera before(plain, to_world, width, height, aspect), after(shifted, to_world, width, height, aspect);
        for (int i = 0; i < 20; ++i) {
            const glm::vec2 position = random_position(i);
            const Ray ray = before.ray_through(position);
            const glm::vec3 point = ray.origin + 3.0f * ray.direction;
            const auto seen = after.project(point);
            ASSERT_TRUE(seen);
            EXPECT_NEAR(seen->position.x, position.x - 0.25 * height, 2e-2);
            EXPECT_NEAR(seen->position.y, position.y - 0.1 * height, 2e-2);
            const Ray back = after.ray_through(seen->position);
            EXPECT_NEAR(glm::distance(back.origin + 3.0f * back.direction, point), 0, 1e-5);
            const glm::vec4 ndc = after.world_to_ndc() * glm::vec4(point, 1);
            EXPECT_NEAR(ndc.x / ndc.w * width, seen->position.x, 2e-2);
            EXPECT_NEAR(ndc.y / ndc.w * height, seen->position.y, 2e-2);
        }
    }
}

TEST(Camera, HasNoPlaceForWhatIsBehindIt) {
    const Camera camera(lens(1), placed({1, 2, 3}, 0.5, 0.2), width, height, aspect);
    EXPECT_FALSE(camera.project(camera.position()));
    EXPECT_FALSE(camera.project(camera.position() - camera.forward()));
    EXPECT_FALSE(camera.project_direction(-camera.forward()));
    EXPECT_TRUE(camera.project(camera.position() + camera.forward()));
    EXPECT_FALSE(camera.project(glm::vec3(std::nanf(""))));
}

/// Directions are unit vectors in single precision: they tell two positions apart that lie this many pixels apart, and
/// no less.
double direction_quantum(const Camera& camera, glm::vec2 position) {
    const double half_y = 0.5 * static_cast<double>(camera.pixel_size()) * height,
                 half_x = half_y * static_cast<double>(aspect);
    const double x = (2 * static_cast<double>(position.x) / width - 1) * half_x,
                 y = (1 - 2 * static_cast<double>(position.y) / height) * half_y;
    // A pixel spans this angle, foreshortened twice away from the axis.
    const double angle = static_cast<double>(camera.pixel_size()) / (1 + x * x + y * y);
    return 1.2e-7 / angle;
}

TEST(Camera, ProjectsWhatItsRaysHitToWhereTheyStarted) {
    for (const double degrees : {10.0, 40.0, 90.0, 120.0}) {
        const Camera camera(lens(glm::radians(degrees)), placed({0.5, -0.25, 0.125}, 0.7, -0.3), width, height, aspect);
        for (int i = 0; i < 200; ++i) {
            const glm::vec2 position = random_position(i);
            const Ray ray = camera.ray_through(position);
            EXPECT_NEAR(glm::length(ray.direction), 1, 1e-6);
            const auto seen = camera.project_exact(glm::dvec3(ray.origin) + 7.0 * glm::dvec3(ray.direction));
            ASSERT_TRUE(seen);
            EXPECT_LT(glm::length(seen->position - position), 1e-3) << degrees;
        }
    }
}

TEST(Camera, RaysAndProjectionAreInverseForExtremeLensesAsFarAsUnitDirectionsCanSay) {
    for (const double degrees : {0.01, 0.1, 1.0, 170.0, 179.9}) {
        const Camera along_axis(lens(glm::radians(degrees)), glm::mat4(1.0f), width, height, aspect);
        const Camera turned(lens(glm::radians(degrees)), placed({0, 0, 0}, 2.1, 0.4), width, height, aspect);
        for (int i = 0; i < 200; ++i) {
            const glm::vec2 position = random_position(i);
            // In the camera's own axes nothing cancels.
            const auto seen = along_axis.project_direction(along_axis.ray_through(position).direction);
            ASSERT_TRUE(seen);
            EXPECT_LT(glm::length(seen->position - position), 1e-3) << degrees;
            const auto by_turned = turned.project_direction(turned.ray_through(position).direction);
            ASSERT_TRUE(by_turned);
            EXPECT_LT(glm::length(by_turned->position - position), 1e-3 + direction_quantum(turned, position))
                << degrees;
        }
    }
}

TEST(Camera, OrthographicRaysAreParallelAndInverseToProjection) {
    for (const float magnification : {1e-3f, 1.0f, 1e4f}) {
        const Camera camera(orthographic(magnification), placed({0, 0, 0}, 0.3, 1.1), width, height, aspect);
        for (int i = 0; i < 100; ++i) {
            const glm::vec2 position = random_position(i);
            const Ray ray = camera.ray_through(position);
            EXPECT_EQ(ray.direction, camera.ray_through({0, 0}).direction);
            const auto seen = camera.project_exact(glm::dvec3(ray.origin) + 3.0 * static_cast<double>(magnification) *
                                                                                glm::dvec3(ray.direction));
            ASSERT_TRUE(seen);
            EXPECT_LT(glm::length(seen->position - position), 1e-3) << magnification;
            EXPECT_NEAR(seen->depth, 3 * magnification, 1e-5 * magnification);
        }
    }
    EXPECT_FALSE(Camera(orthographic(1), glm::mat4(1.0f), width, height, aspect).project_direction({0, 0, -1}));
}

TEST(Camera, DepthIsAlongItsAxisNotAlongTheRay) {
    const Camera camera(lens(1.2), placed({3, 2, 1}, -0.4, 0.6), width, height, aspect);
    const Ray corner = camera.ray_through({0, 0});
    const auto seen = camera.project(corner.origin + 10.0f * corner.direction);
    ASSERT_TRUE(seen);
    EXPECT_NEAR(seen->depth, 10 * glm::dot(corner.direction, camera.forward()), 1e-5);
}

TEST(Camera, MatricesForOtherProgramsSeeWhatItSees) {
    for (const CameraLens& seen_by : {lens(0.8), orthographic(3)}) {
        CameraLens with_near = seen_by;
        with_near.near = 0.5f;
        const Camera camera(with_near, placed({1, -2, 3}, 0.7, -0.3), width, height, aspect);
        for (int i = 0; i < 20; ++i) {
            const Ray ray = camera.ray_through(random_position(i));
            const glm::vec3 point = ray.origin + 4.0f * ray.direction;
            const auto expected = camera.project(point);
            ASSERT_TRUE(expected);
            const glm::vec4 ndc = camera.world_to_ndc() * glm::vec4(point, 1);
            EXPECT_NEAR(ndc.x / ndc.w * width, expected->position.x, 2e-2);
            EXPECT_NEAR(ndc.y / ndc.w * height, expected->position.y, 2e-2);
            const glm::vec4 near = camera.world_to_ndc() * glm::vec4(camera.position() + 0.5f * camera.forward(), 1);
            EXPECT_NEAR(near.z / near.w, 0, 1e-5);
            EXPECT_GT(ndc.z / ndc.w, 0);
            const glm::vec4 local = camera.world_to_camera() * glm::vec4(point, 1);
            EXPECT_NEAR(local.z, expected->depth, 1e-4) << "z is along the view";
            EXPECT_EQ(local.y > 0, expected->position.y < height / 2.0f) << "y is up";
        }
    }
}

}  // namespace
}  // namespace render2mpeg::scene
