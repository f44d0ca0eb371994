#include "scene/pose/bent_reflections.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <glm/gtc/constants.hpp>
#include <random>
#include <string>

#include "scene/pose/snapshot.h"
#include "scene/pose/sweep.h"
#include "scene/preparation/complete.h"
#include "tests/support/scene_builder.h"

namespace render2mpeg::scene {
namespace {

using test::SceneBuilder;

/// Adds an edit of what a node's objects mirror: a point from the node's place, what is seen there in the world.
int add_edit(SceneBuilder& b, int object, glm::dvec3 at, glm::dvec3 see, float radius, float border) {
    Animation& film = b.film();
    const int mirror = film.objects.at(static_cast<std::size_t>(object)).node;
    Node point, seen;
    point.parent = mirror;
    point.translation = at / film.nodes[static_cast<std::size_t>(mirror)].scale;
    seen.translation = see;
    film.nodes.push_back(point);
    film.nodes.push_back(seen);
    const int last = static_cast<int>(film.nodes.size()) - 1;
    film.reflections.push_back({mirror, last - 1, last, radius, border});
    return last;
}

int silver(SceneBuilder& b) {
    const int material = b.add_material({1, 1, 1});
    b.material(material).metallic = 1;
    b.material(material).roughness = 0;
    return material;
}

/// A place of an ideal surface and its normal, by two parameters.
struct Place {
    glm::dvec3 at, normal;
};
using Surface = std::function<Place(double, double)>;

/// A mirror, and what an eye sees mirrored at its places.
struct Look {
    const Snapshot& world;
    Surface surface;

    glm::dvec3 eye() const { return glm::dvec3(world.camera.position()); }
    bool faces(double u, double v, double cosine) const {
        const Place p = surface(u, v);
        return -glm::dot(glm::normalize(p.at - eye()), p.normal) > cosine;
    }
    glm::dvec3 mirrored(double u, double v) const {
        const Place p = surface(u, v);
        const glm::dvec3 i = glm::normalize(p.at - eye());
        return i - 2 * glm::dot(i, p.normal) * p.normal;
    }
    glm::dvec3 bent(double u, double v) const {
        const Place p = surface(u, v);
        return world.bends->bent(0, false, p.at, p.normal, mirrored(u, v), 0.5f);
    }
    /// Area that mirrored rays sweep about a place once bent, over what they sweep by themselves: negative where the
    /// picture is folded.
    double jacobian(double u, double v) const {
        const double h = 1e-5;
        const auto area = [&](auto&& direction) {
            const glm::dvec3 d = direction(u, v), du = direction(u + h, v) - direction(u - h, v),
                             dv = direction(u, v + h) - direction(u, v - h);
            return glm::dot(glm::cross(du, dv), d);
        };
        return area([&](double x, double y) { return bent(x, y); }) /
               area([&](double x, double y) { return mirrored(x, y); });
    }
    /// The smallest on a grid of what the eye sees.
    double least_jacobian(double u0, double u1, double v0, double v1, int steps = 60) const {
        double least = 1e30;
        for (int i = 0; i <= steps; ++i)
            for (int k = 0; k <= steps; ++k) {
                const double u = u0 + (u1 - u0) * i / steps, v = v0 + (v1 - v0) * k / steps;
                // Where bent rays are kept from the surface they lose a dimension.
                if (!faces(u, v, 0.15) || glm::dot(bent(u, v), surface(u, v).normal) < 0.051) continue;
                least = std::min(least, jacobian(u, v));
            }
        return least;
    }
};

Place on_plane(double u, double v) {
    return {{u, v, 0}, {0, 0, 1}};
}
/// The sphere of radius 1 about the origin, by longitude and latitude.
Place on_sphere(double u, double v) {
    const glm::dvec3 p(std::sin(u) * std::cos(v), std::sin(v), std::cos(u) * std::cos(v));
    return {p, p};
}
/// A cylinder of radius 1 along y.
Place on_cylinder(double u, double v) {
    const glm::dvec3 n(std::sin(u), 0, std::cos(u));
    return {n + glm::dvec3(0, v, 0), n};
}

/// A tube's mesh with its true normals: squares of its surface, two triangles each.
Mesh tube(double height, std::uint32_t sides, std::uint32_t rows) {
    Mesh mesh;
    for (std::uint32_t k = 0; k <= rows; ++k)
        for (std::uint32_t i = 0; i <= sides; ++i) {
            const Place p = on_cylinder(2 * glm::pi<double>() * i / sides, height * (2.0 * k / rows - 1));
            mesh.positions.emplace_back(p.at);
            mesh.normals.emplace_back(p.normal);
        }
    for (std::uint32_t k = 0; k < rows; ++k)
        for (std::uint32_t i = 0; i < sides; ++i) {
            const std::uint32_t a = k * (sides + 1) + i, c = a + sides + 1;
            mesh.triangles.emplace_back(a, a + 1, c);
            mesh.triangles.emplace_back(c, a + 1, c + 1);
        }
    return mesh;
}

/// A body of three different axes.
Place on_ellipsoid(double u, double v) {
    const glm::dvec3 axes(1.6, 0.7, 1), p = on_sphere(u, v).at;
    return {axes * p, glm::normalize(p / axes)};
}

struct Mirror {
    const char* name;
    Surface surface;
    std::function<int(SceneBuilder&)> add;  ///< returns the object
};
std::vector<Mirror> mirrors() {
    return {{"plane", on_plane,
             [](SceneBuilder& b) {
                 return b.add_quad({-9, -9, 0}, {18, 0, 0}, {0, 18, 0}, silver(b));
             }},
            {"sphere", on_sphere,
             [](SceneBuilder& b) {
                 return b.add_sphere({0, 0, 0}, 1, silver(b), 96);
             }},
            {"cylinder", on_cylinder,
             [](SceneBuilder& b) { return b.add_object(b.add_mesh(tube(1.5, 96, 32)), silver(b)); }},
            {"ellipsoid", on_ellipsoid, [](SceneBuilder& b) {
                 return b.add_object(b.add_mesh(SceneBuilder::sphere(1, 96)), silver(b), {0, 0, 0}, {1, 0, 0, 0},
                                     {1.6, 0.7, 1});
             }}};
}

TEST(BentReflections, ShowTheirTargetWhileEverythingMoves) {
    SceneBuilder b;
    const int mirror = b.add_object(b.add_mesh(SceneBuilder::sphere(1, 48)), silver(b), {0, 0, 0},
                                    glm::angleAxis(0.4, glm::dvec3(0, 1, 0)));
    b.move_object(mirror, {{0, 0, 0}, {0.2, 0.1, -0.3}, {0.4, 0, 0.2}, {0.3, -0.2, 0}});
    const int seen = add_edit(b, mirror, {0.2, 0.3, 0.93}, {3, 1, 2}, 0.3f, 0.3f);
    b.add_track(TrackTarget::translation, seen, 3, {0, 1, 2, 3}, {3, 1, 2, 2, 2, 3, -1, 2, 3, -2, 1, 3});
    b.add_track(TrackTarget::reflection_radius, 0, 1, {0, 3}, {0.3f, 0.1f});
    const int camera = b.add_camera({0.5f, 0.6f, 5}, {0, 0, 0});
    b.add_track(TrackTarget::translation, b.film().cameras[static_cast<std::size_t>(camera)].node, 3, {0, 3},
                {0.5f, 0.6f, 5, -0.5f, 0.2f, 4});
    const Animation film = b.build();
    const glm::dvec3 targets[] = {{3, 1, 2}, {2, 2, 3}, {-1, 2, 3}, {-2, 1, 3}};
    for (int second = 0; second < 4; ++second) {
        const Snapshot s = test::snapshot(film, second, 64, 64);
        const Bend& bend = s.bends->middle().front();
        ASSERT_EQ(bend.strength, 1);
        // The normals that a sphere's mesh interpolates are those of the sphere.
        const glm::dvec3 n = glm::normalize(bend.at - glm::dvec3(s.objects[0].to_world[3])),
                         i = glm::normalize(bend.at - glm::dvec3(s.camera.position())),
                         mirrored = i - 2 * glm::dot(i, n) * n, e = glm::normalize(targets[second] - bend.at);
        EXPECT_GT(glm::length(mirrored - e), 0.1) << second;  // by law something else is seen there
        EXPECT_LT(glm::length(s.bends->bent(0, false, bend.at, n, mirrored, 0.5f) - e), 1e-6) << second;
    }
}

TEST(BentReflections, HoldForParallelEyesAndWhileTheShutterIsOpen) {
    SceneBuilder b;
    const int mirror = b.add_sphere({0, 0, 0}, 1, silver(b), 96);
    b.move_object(mirror, {{0, 0, 0}, {0.4, 0.2, 0}});
    const int seen = add_edit(b, mirror, {0, 0, 1}, {2, 1, 3}, 0.2f, 0.2f);
    b.add_track(TrackTarget::translation, seen, 3, {0, 1}, {2, 1, 3, 1, 2, 3});
    CameraLens lens;
    lens.projection = ProjectionKind::orthographic;
    lens.y_magnification = 2;
    b.add_camera(lens, {0, 0, 5}, {0, 0, 0});
    b.film().shutter.angle = 360;
    const Animation film = b.build();
    const Snapshot s = test::snapshot(film, 1, 64, 64);
    ASSERT_TRUE(s.sweep && !s.sweep->knots.empty());
    for (const float time : {0.0f, 0.5f, 1.0f}) {
        // It is open from half a second before until half a second after, when nothing moves any more.
        const double second = std::min(0.5 + static_cast<double>(time), 1.0);
        const auto& objects =
            time == 0.5f ? s.objects : (time < 0.5f ? s.sweep->knots.front() : s.sweep->knots.back()).objects;
        const glm::dvec3 centre(objects[0].to_world[3]), n(0, 0, 1), at = centre + n;
        EXPECT_NEAR(centre.x, 0.4 * second, 1e-6);
        const glm::dvec3 e = glm::normalize(glm::dvec3(2 - second, 1 + second, 3) - at);
        EXPECT_LT(glm::length(s.bends->bent(0, false, at, n, {0, 0, 1}, time) - e), 2e-3) << time;
    }
}

TEST(BentReflections, DoNotFoldWhateverOneEditAsksFor) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> any(-1, 1);
    for (const Mirror& mirror : mirrors()) {
        int strong = 0;
        double least = 1e30, smallest = 1e30;
        for (int trial = 0; trial < 12; ++trial) {
            SceneBuilder b;
            const int object = mirror.add(b);
            const Place p = mirror.surface(0.4 * any(random), 0.4 * any(random));
            const glm::dvec3 eye(1.5 * any(random), 1.5 * any(random), 3.5 + any(random));
            const glm::dvec3 to = glm::normalize(glm::dvec3(any(random), any(random), any(random)) + 1.2 * p.normal);
            add_edit(b, object, p.at, p.at + 4.0 * to, static_cast<float>(0.05 + 0.2 * std::abs(any(random))), 0.05f);
            b.add_camera(glm::vec3(eye), glm::vec3(p.at));
            const Animation film = b.build();
            const Snapshot s = test::snapshot(film, 0, 64, 64);
            const Bend& bend = s.bends->middle().front();
            strong += glm::length(bend.turn) > 0.5;
            smallest = std::min(smallest, 1 / std::max(bend.fade, 1e-3));
            const double found = Look{s, mirror.surface}.least_jacobian(-1.5, 1.5, -1.4, 1.4, 40);
            // Of 400 trials those that fold (6) turn by more.
            if (glm::length(bend.turn) > 1.4) continue;
            EXPECT_GT(found, 0) << mirror.name << " " << trial << " turn " << glm::length(bend.turn) << " border "
                                << 1 / bend.fade << " everywhere " << bend.everywhere;
            least = std::min(least, found);
        }
        EXPECT_GT(strong, 3) << mirror.name;
        EXPECT_LT(smallest, 0.8) << mirror.name;  // borders are no wider than they must be
        EXPECT_LT(least, 0.5) << mirror.name;     // nor is the bound slack
    }
}

TEST(BentReflections, MeetWithoutAFold) {
    // Two edits whose borders overlap, and whose pictures keep their order.
    for (const Mirror& mirror : mirrors()) {
        SceneBuilder b;
        const int object = mirror.add(b);
        const Place p = mirror.surface(-0.4, 0), q = mirror.surface(0.4, 0.1);
        b.add_camera({0.3f, 0.2f, 4}, {0, 0, 0});
        const auto naturally = [&](const Place& at) {
            const glm::dvec3 i = glm::normalize(at.at - glm::dvec3(0.3, 0.2, 4));
            return i - 2 * glm::dot(i, at.normal) * at.normal;
        };
        const double way = mirror.name == std::string("plane")       ? 0.04
                           : mirror.name == std::string("ellipsoid") ? 0.12
                                                                     : 0.25;
        add_edit(b, object, p.at, p.at + 5.0 * naturally(p) + 5 * way * glm::dvec3(1, 1, 0), 0.2f, 0.6f);
        add_edit(b, object, q.at, q.at + 5.0 * naturally(q) + 5 * way * glm::dvec3(-0.5, 1, 0), 0.2f, 0.6f);
        const Animation film = b.build();
        const Snapshot s = test::snapshot(film, 0, 64, 64);
        const Look look{s, mirror.surface};
        for (const auto& [at, k] : {std::pair(p, 0), std::pair(q, 1)}) {
            const glm::dvec3 see(
                film.nodes[static_cast<std::size_t>(film.reflections[static_cast<std::size_t>(k)].see)].translation);
            EXPECT_LT(glm::length(s.bends->bent(0, false, at.at, at.normal, naturally(at), 0.5f) -
                                  glm::normalize(see - at.at)),
                      2e-3)
                << mirror.name;
        }
        EXPECT_GT(look.least_jacobian(-1.5, 1.5, -1.4, 1.4), 0) << mirror.name;
    }
}

TEST(BentReflections, ThatReachFarDoNotFoldThoseThatDoNot) {
    // An edit that moves its picture little, beside one that moves it so far that its border covers the other.
    for (const Mirror& mirror : mirrors()) {
        SceneBuilder b;
        const int object = mirror.add(b);
        const Place p = mirror.surface(-0.6, 0), q = mirror.surface(0.5, 0.1);
        b.add_camera({0.3f, 0.2f, 4}, {0, 0, 0});
        const auto naturally = [](const Place& at) {
            const glm::dvec3 i = glm::normalize(at.at - glm::dvec3(0.3, 0.2, 4));
            return i - 2 * glm::dot(i, at.normal) * at.normal;
        };
        const double way = mirror.name == std::string("plane") ? 0.08 : 0.3;
        add_edit(b, object, p.at, p.at + 5.0 * naturally(p) + 5 * way * glm::dvec3(0, 1, 0), 0.1f, 0.1f);
        add_edit(b, object, q.at, q.at + 5.0 * naturally(q) + glm::dvec3(0, 0.1, 0), 0.1f, 0.1f);
        const Animation film = b.build();
        const Snapshot s = test::snapshot(film, 0, 64, 64);
        const Look look{s, mirror.surface};
        EXPECT_GT(look.least_jacobian(-1.5, 1.5, -1.4, 1.4), 0) << mirror.name;
    }
}

TEST(BentReflections, FadeWithoutAJump) {
    for (const Mirror& mirror : mirrors()) {
        SceneBuilder b;
        const int object = mirror.add(b);
        const Place p = mirror.surface(0.1, 0.2), q = mirror.surface(-0.5, 0.3);
        add_edit(b, object, p.at, p.at + glm::dvec3(0.5, 0.7, 3), 0.2f, 0.3f);
        add_edit(b, object, q.at, q.at + glm::dvec3(-1, 2, 3), 0.1f, 0.4f);
        b.add_camera({0.3f, 0.2f, 4}, {0, 0, 0});
        const Animation film = b.build();
        const Snapshot s = test::snapshot(film, 0, 64, 64);
        const Look look{s, mirror.surface};
        // Half the step is half the change, and a quarter of the change of the change, wherever borders begin and end.
        const auto largest = [&](int steps, glm::dvec2& most) {
            most = glm::dvec2(0);
            for (int k = 1; k < steps; ++k) {
                const auto at = [&](int n) { return look.bent(-1.0 + 2.0 * n / steps, 0.25); };
                ASSERT_GT(glm::dot(at(k), mirror.surface(-1.0 + 2.0 * k / steps, 0.25).normal), 0.051);
                most.x = std::max(most.x, glm::length(at(k + 1) - at(k)));
                most.y = std::max(most.y, glm::length(at(k + 1) - 2.0 * at(k) + at(k - 1)));
            }
        };
        glm::dvec2 coarse, fine;
        largest(4000, coarse);
        largest(8000, fine);
        EXPECT_NEAR(fine.x / coarse.x, 0.5, 0.01) << mirror.name;
        EXPECT_NEAR(fine.y / coarse.y, 0.25, 0.03) << mirror.name;
    }
}

TEST(BentReflections, LeaveTheRestOfTheFilmAlone) {
    SceneBuilder b;
    const int mirror = b.add_sphere({0, 0, 0}, 1, silver(b), 96), other = b.add_sphere({3, 0, 0}, 1, silver(b));
    add_edit(b, mirror, {0, 0, 1}, {0.5, 0.2, 4}, 0.1f, 0.1f);
    b.add_camera({0, 0, 5}, {0, 0, 0});
    const Animation film = b.build();
    const Snapshot s = test::snapshot(film, 0, 64, 64);
    EXPECT_TRUE(s.bends->edits(static_cast<std::uint32_t>(mirror)));
    EXPECT_FALSE(s.bends->edits(static_cast<std::uint32_t>(other)));
    const Look look{s, on_sphere};
    EXPECT_NE(look.bent(0.05, 0), look.mirrored(0.05, 0));
    EXPECT_EQ(look.bent(1.2, 0), look.mirrored(1.2, 0));
    EXPECT_EQ(s.bends->bent(0, true, {0, 0, 1}, {0, 0, -1}, {0, 0, -1}, 0.5f), glm::dvec3(0, 0, -1));
    // A film without edits has nothing that could cost.
    SceneBuilder plain;
    plain.add_sphere({0, 0, 0}, 1, silver(plain));
    const Animation without = plain.build();
    EXPECT_EQ(test::snapshot(without, 0, 64, 64).bends, nullptr);
}

TEST(BentReflections, StandWhateverTheyAreTold) {
    // Targets behind the surface, at the point, very far; points seen edge-on and from behind; many that overlap.
    std::mt19937 random(3);
    std::uniform_real_distribution<double> any(-1, 1);
    SceneBuilder b;
    const int object = b.add_sphere({0, 0, 0}, 1, silver(b), 48);
    for (const glm::dvec3 see :
         {glm::dvec3(0, 0, -3), glm::dvec3(0, 0, 1.0001), glm::dvec3(1e7, -1e7, 1e7), glm::dvec3(0, 0, 1 + 1e-12)})
        add_edit(b, object, {0.01 * any(random), 0.01 * any(random), 1}, see, 0.01f, 0.01f);
    for (int k = 0; k < 60; ++k) {
        const Place p = on_sphere(4 * any(random), 1.5 * any(random));
        add_edit(b, object, p.at, 3.0 * glm::dvec3(any(random), any(random), any(random)), 1e-6f + 0.5f * (k % 3),
                 1e-6f);
    }
    add_edit(b, object, {1, 0, 0}, {1, 5, 0}, 1e6f, 1e6f);
    b.add_camera({0, 0, 5}, {0, 0, 0});
    Animation film = b.unfinished();
    for (Reflection& edit : film.reflections) edit.radius = std::max(edit.radius, 0.02f);
    complete(film);
    const Snapshot s = test::snapshot(film, 0, 64, 64);
    const Look look{s, on_sphere};
    for (int k = 0; k < 4000; ++k) {
        const double u = 1.5 * any(random), v = 1.5 * any(random);
        if (!look.faces(u, v, 0.0)) continue;
        const glm::dvec3 e = look.bent(u, v);
        EXPECT_NEAR(glm::length(e), 1, 1e-9);
        EXPECT_GT(glm::dot(e, on_sphere(u, v).normal), 0) << u << " " << v;
    }
}

}  // namespace
}  // namespace render2mpeg::scene
