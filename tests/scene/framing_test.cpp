#include <gtest/gtest.h>

#include <algorithm>

#include "core/numeric.h"
#include "scene/load.h"
#include "scene/pose/snapshot.h"
#include "scene/preparation/complete.h"

namespace render2mpeg::scene {
namespace {

constexpr PictureFormat wide_format{400, 300, 1};

/// A box with its faces to the outside or to the inside; the bits of `open` leave out -x, +x, -y, +y, -z, +z.
Mesh box(glm::vec3 low, glm::vec3 high, bool inward, unsigned open = 0) {
    Mesh mesh;
    for (int axis = 0; axis < 3; ++axis)
        for (int side = 0; side < 2; ++side) {
            if (open >> (2 * axis + side) & 1) continue;
            const int u = (axis + 1) % 3, v = (axis + 2) % 3;
            const unsigned first = static_cast<unsigned>(mesh.positions.size());
            for (int k = 0; k < 4; ++k) {
                glm::vec3 p;
                p[axis] = side ? high[axis] : low[axis];
                p[u] = k == 1 || k == 2 ? high[u] : low[u];
                p[v] = k >= 2 ? high[v] : low[v];
                mesh.positions.push_back(p);
            }
            const bool flip = (side == 1) == inward;
            mesh.triangles.emplace_back(first, first + (flip ? 2 : 1), first + (flip ? 1 : 2));
            mesh.triangles.emplace_back(first, first + (flip ? 3 : 2), first + (flip ? 2 : 3));
        }
    return mesh;
}

Animation film_of(std::vector<Mesh> meshes) {
    Animation film;
    film.source = "film";
    film.materials.emplace_back();
    for (Mesh& mesh : meshes) {
        Object object;
        object.mesh = static_cast<int>(film.meshes.size());
        film.objects.push_back(object);
        film.meshes.push_back(std::move(mesh));
    }
    complete(film);
    return film;
}

bool says(const Animation& film, const std::string& part) {
    return std::any_of(film.notes.begin(), film.notes.end(),
                       [&](const std::string& n) { return n.find(part) != std::string::npos; });
}

Snapshot framed_at(const Animation& film, double seconds) {
    return snapshot_at(film, 0, {static_cast<std::int64_t>(seconds * 1000), 1000}, wide_format);
}

/// Whether every corner of the bounds is on the picture.
bool shows_all(const Animation& film, const Camera& camera) {
    for (int k = 0; k < 8; ++k) {
        const glm::vec3 corner(k & 1 ? film.bounds_max.x : film.bounds_min.x,
                               k & 2 ? film.bounds_max.y : film.bounds_min.y,
                               k & 4 ? film.bounds_max.z : film.bounds_min.z);
        const auto seen = camera.project(corner);
        if (!seen || seen->position.x < 0 || seen->position.y < 0 || seen->position.x > 400 || seen->position.y > 300)
            return false;
    }
    return true;
}

TEST(Framing, OrbitsAnObjectAndKeepsItWholeInThePicture) {
    for (const float size : {1e-3f, 1.0f, 1e5f}) {
        const Animation film = film_of({box(glm::vec3(-size, 0, -size), glm::vec3(size, 3 * size, size), false)});
        EXPECT_TRUE(says(film, "orbits")) << size;
        EXPECT_EQ(film.duration, 8);
        float lowest = 300, highest = 0;
        for (double t = 0; t < 8; t += 0.5) {
            const Camera camera = framed_at(film, t).camera;
            EXPECT_TRUE(shows_all(film, camera)) << t;
            lowest = std::min(lowest, camera.project(glm::vec3(0, 3 * size, 0))->position.y);
            highest = std::max(highest, camera.project(glm::vec3(0))->position.y);
        }
        // Nor is it lost in it.
        EXPECT_GT(highest - lowest, 150) << size;
    }
}

TEST(Framing, GoesOnceAroundInOnePeriod) {
    const Animation film = film_of({box(glm::vec3(-1), glm::vec3(1), false)});
    const glm::vec3 start = framed_at(film, 0).camera.position();
    EXPECT_LT(glm::length(framed_at(film, 8).camera.position() - start), 1e-5 * glm::length(start));
    EXPECT_LT(glm::dot(framed_at(film, 4).camera.position() * glm::vec3(1, 0, 1), start), 0);
}

TEST(Framing, LooksIntoTheOpenSideOfABox) {
    // Open towards +x, +z or -z.
    const std::pair<unsigned, glm::vec3> cases[] = {{2u, {1, 0, 0}}, {32u, {0, 0, 1}}, {16u, {0, 0, -1}}};
    for (const auto& [open, side] : cases) {
        const Animation film =
            film_of({box(glm::vec3(-1), glm::vec3(1), true, open), box({-0.5f, -1, -0.2f}, {0, 0, 0.3f}, false)});
        EXPECT_TRUE(says(film, "open side")) << open;
        for (double t = 0; t < 8; t += 1) {
            const Camera camera = framed_at(film, t).camera;
            EXPECT_GT(glm::dot(glm::normalize(camera.position()), side), 0.9) << open;
            EXPECT_TRUE(shows_all(film, camera));
        }
    }
}

TEST(Framing, TurnsWithinAClosedRoom) {
    const Animation film =
        film_of({box({-3, 0, -2}, {3, 2.5f, 2}, true), box({-0.5f, 0, -0.2f}, {0.5f, 1, 0.3f}, false)});
    EXPECT_TRUE(says(film, "within"));
    const glm::vec3 eye = framed_at(film, 3).camera.position();
    EXPECT_TRUE(glm::all(glm::greaterThan(eye, film.bounds_min)) && glm::all(glm::lessThan(eye, film.bounds_max)));
    EXPECT_EQ(film.duration, 16);
    EXPECT_LT(glm::dot(framed_at(film, 0).camera.forward(), framed_at(film, 8).camera.forward()), -0.99);
}

TEST(Framing, TurnsWithinAHouseWithWallsOfTwoFaces) {
    const Animation film =
        film_of({box({-3, 0, -2}, {3, 2.5f, 2}, true), box({-3.1f, -0.1f, -2.1f}, {3.1f, 2.6f, 2.1f}, false)});
    // From outside it is a block, from inside a room: both are views of it, and each is finite.
    EXPECT_EQ(film.cameras.size(), 1u);
    for (double t = 0; t < film.duration; t += 1) EXPECT_TRUE(core::is_finite(framed_at(film, t).camera.to_world()));
}

TEST(Framing, LastsAsLongAsTheFilmItself) {
    Animation film;
    film.source = "film";
    film.nodes.resize(1);
    film.materials.emplace_back();
    film.meshes.push_back(box(glm::vec3(-1), glm::vec3(1), false));
    Object object;
    object.mesh = object.node = 0;
    film.objects.push_back(object);
    film.tracks.push_back({TrackTarget::translation, 0, Interpolation::linear, 3, {0, 2.5f}, {0, 0, 0, 0, 3, 0}});
    complete(film);
    EXPECT_EQ(film.duration, 2.5);
    EXPECT_TRUE(shows_all(film, framed_at(film, 0).camera));
    EXPECT_TRUE(framed_at(film, 2.5).camera.project({0, 3, 0}));
}

TEST(Framing, WorksForAnEmptyFilm) {
    Animation film;
    film.source = "film";
    complete(film);
    EXPECT_EQ(film.cameras.size(), 1u);
    EXPECT_TRUE(core::is_finite(framed_at(film, 1).camera.to_world()));
}

}  // namespace
}  // namespace render2mpeg::scene
