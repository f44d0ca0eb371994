#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <numbers>

#include "core/sampling.h"
#include "scene/model/camera.h"
#include "scene/pose/motion.h"
#include "support/scene_builder.h"

/// Cameras that show the sphere, against the formulas of their picture.
namespace render2mpeg::scene {
namespace {

constexpr double pi = std::numbers::pi;
constexpr int width = 256, height = 128;

Camera panorama(const SphereWindow& window = {}, const glm::mat4& to_world = glm::mat4(1.0f)) {
    CameraLens lens;
    make_panorama(lens, window);
    return Camera(lens, to_world, width, height, 2.0f);
}

glm::mat4 turned(double yaw, double pitch, glm::vec3 at) {
    const glm::dquat q = glm::angleAxis(yaw, glm::dvec3(0, 1, 0)) * glm::angleAxis(pitch, glm::dvec3(1, 0, 0));
    glm::dmat4 m = glm::mat4_cast(q);
    m[3] = glm::dvec4(at, 1);
    return glm::mat4(m);
}

float random(int stream, int i) {
    return core::uniform(static_cast<std::uint64_t>(stream), static_cast<std::uint64_t>(i));
}

glm::dvec3 random_direction(int i) {
    const double z = 2.0 * static_cast<double>(random(1, i)) - 1, turn = 2 * pi * static_cast<double>(random(2, i));
    const double out = std::sqrt(1 - z * z);
    return {out * std::cos(turn), z, out * std::sin(turn)};
}

TEST(Panorama, ShowsDirectionsWhereTheSphereHasThem) {
    const Camera camera = panorama();
    const auto expect = [&](glm::vec3 world, glm::vec2 place) {
        const auto seen = camera.project(world);
        ASSERT_TRUE(seen);
        EXPECT_NEAR(seen->position.x, place.x, 1e-4);
        EXPECT_NEAR(seen->position.y, place.y, 1e-4);
        EXPECT_NEAR(seen->depth, glm::length(world), 1e-5);
    };
    expect({0, 0, -3}, {128, 64});
    expect({5, 0, 0}, {192, 64});
    expect({-5, 0, 0}, {64, 64});
    expect({0, 2, -2}, {128, 32});
    expect({1, -std::sqrt(2.0f), -1}, {160, 96});
    EXPECT_NEAR(camera.project({0, 7, 0})->position.y, 0, 1e-4);
    EXPECT_NEAR(camera.project({0, -7, 0})->position.y, height, 1e-4);
    const float behind = camera.project({0, 0, 4})->position.x;
    EXPECT_TRUE(behind == 0) << "the left edge, not the right one: " << behind;
    EXPECT_FALSE(camera.project({0, 0, 0}));
    EXPECT_NEAR(camera.pixel_size(), pi / height, 1e-7);
    EXPECT_FLOAT_EQ(camera.pixel_angle(), camera.pixel_size());
}

TEST(Panorama, ProjectingUndoesLookingInAllDirectionsAndWindows) {
    const SphereWindow some{-1.1, 2.9, -0.3, 1.2};
    for (const SphereWindow& window : {SphereWindow(), half_sphere, some})
        for (int i = 0; i < 2000; ++i) {
            const Camera camera = panorama(window, turned(6 * random(3, i), 3 * random(4, i) - 1.5, {3, -2, 5}));
            const glm::vec2 place{width * random(5, i), height * random(6, i)};
            const Ray ray = camera.ray_through(place);
            EXPECT_NEAR(glm::length(ray.direction), 1, 1e-6);
            EXPECT_EQ(ray.origin, camera.position());
            const double level = std::cos(std::abs(static_cast<double>(place.y) / height - 0.5) * pi);
            const auto seen = camera.project_direction(ray.direction);
            ASSERT_TRUE(seen);
            EXPECT_TRUE(std::isinf(seen->depth));
            EXPECT_NEAR(seen->position.y, place.y, 1e-3);
            // Near a pole a column is narrow, and single precision says less of it.
            EXPECT_NEAR(camera.nearest_turn(seen->position, place).x, place.x, 1e-4 + 1e-4 / std::max(level, 1e-3));
        }
}

TEST(Panorama, EveryDirectionHasAPlaceFromWhichItIsLookedAt) {
    const Camera camera = panorama({}, turned(1, 0.5, {0, 0, 0}));
    for (int i = 0; i < 2000; ++i) {
        const glm::vec3 direction(random_direction(i));
        const auto seen = camera.project_direction(direction);
        ASSERT_TRUE(seen);
        EXPECT_GE(seen->position.x, 0);
        EXPECT_LT(seen->position.x, width);
        EXPECT_NEAR(glm::distance(camera.ray_through(seen->position).direction, direction), 0, 1e-5);
    }
}

TEST(Panorama, LooksOnAcrossThePolesAndTheSeam) {
    const Camera camera = panorama();
    const glm::vec3 over = camera.ray_through({64, -1}).direction, behind = camera.ray_through({192, 1}).direction;
    EXPECT_NEAR(glm::distance(over, behind), 0, 1e-6);
    const glm::vec3 beyond = camera.ray_through({width + 3, 40}).direction,
                    first = camera.ray_through({3, 40}).direction;
    EXPECT_NEAR(glm::distance(beyond, first), 0, 1e-6);
    EXPECT_TRUE(camera.wraps());
    EXPECT_FALSE(panorama(half_sphere).wraps());
    EXPECT_EQ(camera.nearest_turn({2, 7}, {250, 9}), glm::vec2(258, 7));
    EXPECT_EQ(camera.nearest_turn({250, 7}, {2, 9}), glm::vec2(-6, 7));
    EXPECT_EQ(panorama(half_sphere).nearest_turn({2, 7}, {250, 9}), glm::vec2(2, 7));
}

TEST(Panorama, RowsWeighAsMuchAsTheirSolidAngle) {
    for (const SphereWindow& window : {SphereWindow(), half_sphere, SphereWindow{-1, 2, -0.5, 1.25}}) {
        const Camera camera = panorama(window);
        const double pixel = (window.east - window.west) / width * (window.north - window.south) / height;
        double sum = 0;
        for (int y = 0; y < height; ++y) sum += width * pixel * static_cast<double>(camera.weight_of_row(y));
        const double exact = (window.east - window.west) * (std::sin(window.north) - std::sin(window.south));
        EXPECT_NEAR(sum / exact, 1, 1e-4);
        // Even numbers are even over it: as much of it above a place as its number says.
        for (const float u : {0.1f, 0.5f, 0.77f}) {
            const glm::vec2 place = camera.even_position({0.25f, u});
            EXPECT_FLOAT_EQ(place.x, 0.25f * width);
            const double up = window.north - static_cast<double>(place.y) / height * (window.north - window.south);
            EXPECT_NEAR((std::sin(window.north) - std::sin(up)) * (window.east - window.west), u * exact, 1e-4);
        }
    }
}

TEST(Panorama, ABallLiesWithinItsCover) {
    const Camera camera = panorama({}, turned(0.4, 0.2, {1, 0, 0}));
    double widest = 0, narrowest = width;
    for (int i = 0; i < 400; ++i) {
        const double distance = 1 + 4 * static_cast<double>(random(7, i)), radius = 0.4 * distance * random(8, i);
        const glm::vec3 middle(glm::dvec3(1, 0, 0) + distance * random_direction(i));
        const auto cover = camera.cover_of_ball(middle, static_cast<float>(radius));
        ASSERT_TRUE(cover);
        const double across = cover->second.x - cover->first.x;
        widest = std::max(widest, across);
        narrowest = std::min(narrowest, across);
        for (int k = 0; k < 50; ++k) {
            const auto seen = camera.project(middle + glm::vec3(radius * random_direction(1000 + 50 * i + k)));
            ASSERT_TRUE(seen);
            const glm::vec2 at = camera.nearest_turn(seen->position, 0.5f * (cover->first + cover->second));
            EXPECT_GE(at.x, cover->first.x - 1e-2f);
            EXPECT_LE(at.x, cover->second.x + 1e-2f);
            EXPECT_GE(at.y, cover->first.y - 1e-2f);
            EXPECT_LE(at.y, cover->second.y + 1e-2f);
        }
    }
    EXPECT_GT(widest, width) << "balls with a pole in them have all columns";
    EXPECT_LT(narrowest, 10);
    EXPECT_FALSE(Camera().cover_of_ball({0, 0, 0}, 1));
}

/// Motion of the points of a ball about a panorama that turns and moves.
struct Moved {
    Animation film;
    Snapshot first, last;

    explicit Moved(double yaw, glm::vec3 shift) {
        test::SceneBuilder b;
        b.add_sphere({0, 0, 0}, 4, b.add_material(), 64);
        CameraLens lens;
        make_panorama(lens, {});
        b.add_camera(lens, {0, 0, 0}, {0, 0, -1});
        film = b.build();
        const PictureFormat format{width, height, 1};
        first = snapshot_at(film, 0, {0, 1}, format);
        last = snapshot_at(film, 1, {1, 1}, format);
        last.camera = first.camera.moved(turned(yaw, 0, shift), 1);
    }
};

TEST(PanoramaMotion, OfATurnIsOneForAllPixelsAcrossTheSeam) {
    const double yaw = 2 * pi * 5 / width;  // five columns to the left: all goes to the right
    const Moved moved(yaw, {0, 0, 0});
    core::Visible sky(0, width, height);
    for (core::PixelClass& kind : sky.kind.values()) kind = core::PixelClass::sky;
    const core::MotionField field = motion_between(sky, moved.first, moved.last);
    EXPECT_TRUE(field.wraps);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const double level = std::sin((y + 0.5) / height * pi);
            EXPECT_NEAR(field.vector.at(x, y).x, 5, 1e-3 / level) << x << ", " << y;
            EXPECT_NEAR(field.vector.at(x, y).y, 0, 1e-3);
        }
    EXPECT_FLOAT_EQ(field.column(258), 2);
    EXPECT_FLOAT_EQ(field.column(-3), 253);
}

TEST(PanoramaMotion, IsTheDerivativeOfTheSpheresFormula) {
    // A small step of the eye: longitude changes by its part across over the distance and the cosine of the latitude.
    const glm::dvec3 step{2e-3, 1e-3, -3e-3};
    const Moved moved(0, glm::vec3(step));
    core::Visible visible(0, width, height);
    int compared = 0;
    for (std::uint32_t t = 0; t < moved.film.meshes[0].triangles.size(); t += 7) {
        const core::SurfaceAddress address{0, t, 0.3f, 0.3f};
        const std::optional<glm::vec3> at = carry(address, moved.first);
        ASSERT_TRUE(at);
        const auto place = moved.first.camera.project(*at);
        ASSERT_TRUE(place);
        const glm::dvec3 p(*at);
        const double distance = glm::length(p), flat = std::hypot(p.x, p.z);
        if (flat < 0.1 * distance) continue;
        const int x = static_cast<int>(place->position.x),
                  y = std::min(static_cast<int>(place->position.y), height - 1);
        visible.kind.at(x, y) = core::PixelClass::surface;
        visible.address.at(x, y) = address;
        const core::MotionField field = motion_field_for(visible, moved.first, moved.last);
        core::MotionField row = field;
        motion_of_rows(visible, moved.first, moved.last, y, y + 1, row);
        const glm::dvec3 east{-p.z / flat, 0, p.x / flat}, north = glm::cross(east, p / distance);
        const double columns = -glm::dot(step, east) / flat * width / (2 * pi),
                     rows = glm::dot(step, north) / distance * height / pi;
        EXPECT_NEAR(row.vector.at(x, y).x, columns, 2e-3);
        EXPECT_NEAR(row.vector.at(x, y).y, rows, 2e-3);
        ++compared;
    }
    EXPECT_GT(compared, 500);
}

}  // namespace
}  // namespace render2mpeg::scene
