#include "scene/pose/motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/constants.hpp>
#include <limits>

#include "scene/preparation/complete.h"
#include "support/scene_builder.h"

namespace render2mpeg::scene {
namespace {

using core::PixelClass;

constexpr int size = 32;
constexpr PictureFormat motion_format{size, size, 1};
constexpr core::Rational second{1, 1}, zero{0, 1};

Mesh wall_mesh() {
    // 40 x 40 in the plane z = 0, in 20 x 20 squares, so that every pixel has a triangle of its own.
    Mesh mesh;
    mesh.name = "wall";
    for (int y = 0; y <= 20; ++y)
        for (int x = 0; x <= 20; ++x) mesh.positions.emplace_back(2 * x - 20, 2 * y - 20, 0);
    for (unsigned y = 0; y < 20; ++y)
        for (unsigned x = 0; x < 20; ++x) {
            const unsigned a = y * 21 + x;
            mesh.triangles.emplace_back(a, a + 1, a + 22);
            mesh.triangles.emplace_back(a, a + 22, a + 21);
        }
    return mesh;
}

/// A film of one wall at z = -10 before a camera at the origin.
Animation wall_film() {
    Animation film;
    film.source = "wall";
    film.nodes.resize(2);
    film.nodes[0].translation = {0, 0, -10};
    film.meshes.push_back(wall_mesh());
    film.materials.emplace_back();
    Object object;
    object.node = 0;
    object.mesh = 0;
    film.objects.push_back(object);
    CameraLens lens;
    lens.node = 1;
    lens.vertical_fov = static_cast<float>(glm::half_pi<double>());
    film.cameras.push_back(lens);
    film.sky.color = glm::vec3(1);
    return film;
}

Track turn(int node, double angle, glm::dvec3 axis) {
    const glm::dquat q = glm::angleAxis(angle, axis);
    return {TrackTarget::rotation,
            node,
            Interpolation::linear,
            4,
            {0, 1},
            {0, 0, 0, 1, static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z),
             static_cast<float>(q.w)}};
}

Track shift(int node, glm::vec3 from, glm::vec3 to) {
    return {
        TrackTarget::translation, node, Interpolation::linear, 3, {0, 1}, {from.x, from.y, from.z, to.x, to.y, to.z}};
}

/// What the camera sees of triangles, by brute force: the nearest triangle under each pixel's centre.
core::Visible look(const Snapshot& snapshot) {
    core::Visible visible(snapshot.frame, size, size);
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            const Ray ray = snapshot.camera.ray_through({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
            visible.kind.at(x, y) = PixelClass::sky;
            double nearest = std::numeric_limits<double>::infinity();
            for (std::uint32_t o = 0; o < snapshot.objects.size(); ++o) {
                if (!snapshot.objects[o].present) continue;
                const Mesh& mesh =
                    snapshot.animation->meshes[static_cast<std::size_t>(snapshot.animation->objects[o].mesh)];
                for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
                    const Triangle corners = triangle_of(snapshot, o, t);
                    const glm::dvec3 a(corners.a), e1 = glm::dvec3(corners.b) - a, e2 = glm::dvec3(corners.c) - a,
                                                   d(ray.direction);
                    const glm::dvec3 p = glm::cross(d, e2), s = glm::dvec3(ray.origin) - a, q = glm::cross(s, e1);
                    const double det = glm::dot(e1, p), u = glm::dot(s, p) / det, v = glm::dot(d, q) / det,
                                 far = glm::dot(e2, q) / det;
                    if (!(u >= 0 && v >= 0 && u + v <= 1 && far > 0 && far < nearest)) continue;
                    nearest = far;
                    visible.kind.at(x, y) = PixelClass::surface;
                    visible.address.at(x, y) = {o, t, static_cast<float>(u), static_cast<float>(v)};
                    visible.depth.at(x, y) =
                        static_cast<float>(far * glm::dot(d, glm::dvec3(snapshot.camera.forward())));
                }
            }
        }
    return visible;
}

struct Shown {
    Animation film;
    Snapshot first, last;
    core::Visible visible;  ///< of `first`
    core::MotionField motion;

    explicit Shown(Animation animation) : film(std::move(animation)) {
        complete(film);
        first = snapshot_at(film, 0, zero, motion_format);
        last = snapshot_at(film, 1, second, motion_format);
        visible = look(first);
        motion = motion_between(visible, first, last);
    }
    /// The point under a pixel in the plane of the wall at z = -10.
    glm::dvec2 on_wall(int x, int y) const {
        return {10 * (2 * (x + 0.5) / size - 1), 10 * (1 - 2 * (y + 0.5) / size)};
    }
};

/// Calls check(x, y, vector) for all pixels and counts those of class `kind`.
template <class Check>
int for_each(const Shown& shown, PixelClass kind, Check check) {
    int count = 0;
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            if (shown.motion.kind.at(x, y) != kind) continue;
            ++count;
            check(x, y, shown.motion.vector.at(x, y));
        }
    return count;
}

/// Where a world point appears with a field of view of 90 degrees at the origin, in double precision.
glm::dvec2 pixel_of(glm::dvec3 p) {
    return {0.5 * size * (1 - p.x / p.z), 0.5 * size * (1 + p.y / p.z)};
}

void expect_vector(glm::vec2 vector, glm::dvec2 expected, int x, int y) {
    EXPECT_NEAR(vector.x, expected.x, 0.01) << x << " " << y;
    EXPECT_NEAR(vector.y, expected.y, 0.01) << x << " " << y;
}

TEST(Motion, IsExactlyZeroWhereNothingMoves) {
    Animation film = wall_film();
    film.nodes[0].rotation = glm::angleAxis(0.3, glm::normalize(glm::dvec3(1, 2, 3)));
    film.nodes[1].rotation = glm::angleAxis(0.1, glm::normalize(glm::dvec3(3, 1, 0)));
    const Shown shown(std::move(film));
    const int surface = for_each(shown, PixelClass::surface, [](int, int, glm::vec2 v) { EXPECT_EQ(v, glm::vec2(0)); });
    const int sky = for_each(shown, PixelClass::sky, [](int, int, glm::vec2 v) { EXPECT_EQ(v, glm::vec2(0)); });
    EXPECT_EQ(surface + sky, size * size);
    EXPECT_GT(surface, size * size / 2);
}

TEST(Motion, OfATurningWallIsTheClosedForm) {
    Animation film = wall_film();
    film.tracks.push_back(turn(0, 0.2, {0, 0, 1}));
    const Shown shown(std::move(film));
    const int count = for_each(shown, PixelClass::surface, [&](int x, int y, glm::vec2 v) {
        const glm::dvec2 p = shown.on_wall(x, y);
        const double c = std::cos(0.2), s = std::sin(0.2);
        const glm::dvec3 to(c * p.x - s * p.y, s * p.x + c * p.y, -10);
        expect_vector(v, pixel_of(to) - glm::dvec2(x + 0.5, y + 0.5), x, y);
    });
    EXPECT_EQ(count, size * size);
}

TEST(Motion, OfACameraThatMovesForwardIsAZoom) {
    Animation film = wall_film();
    film.tracks.push_back(shift(1, {0, 0, 0}, {0, 0, -2}));
    const Shown shown(std::move(film));
    const int count = for_each(shown, PixelClass::surface, [&](int x, int y, glm::vec2 v) {
        const glm::dvec2 from_centre(x + 0.5 - size / 2, y + 0.5 - size / 2);
        expect_vector(v, from_centre * (10.0 / 8.0 - 1), x, y);
        EXPECT_NEAR(shown.motion.depth_in_reference.at(x, y), 8, 1e-5);
    });
    EXPECT_EQ(count, size * size);
}

TEST(Motion, OfALensThatZoomsScalesThePicture) {
    Animation film = wall_film();
    const float narrow = 0.7f;
    film.tracks.push_back({TrackTarget::field_of_view,
                           0,
                           Interpolation::linear,
                           1,
                           {0, 1},
                           {static_cast<float>(glm::half_pi<double>()), narrow}});
    const Shown shown(std::move(film));
    const double scale = 1 / std::tan(0.5 * static_cast<double>(narrow));
    const int count = for_each(shown, PixelClass::surface, [&](int x, int y, glm::vec2 v) {
        expect_vector(v, glm::dvec2(x + 0.5 - size / 2, y + 0.5 - size / 2) * (scale - 1), x, y);
    });
    EXPECT_EQ(count, size * size);
}

TEST(Motion, OfASkinnedWallIsTheClosedForm) {
    // Two joints: the left half stays, the right half turns about z through the wall's middle; between them weights
    // blend the matrices linearly over |x| < 6.
    Animation film = wall_film();
    film.nodes.resize(4);
    film.nodes[2].translation = film.nodes[3].translation = {0, 0, -10};
    film.skins.push_back({{2, 3}, {glm::dmat4(1), glm::dmat4(1)}});
    film.objects[0].skin = 0;
    film.nodes[0].translation = {100, 0, 0};  // of no effect on a skinned mesh
    film.meshes[0].joints.resize(film.meshes[0].positions.size());
    for (std::size_t v = 0; v < film.meshes[0].joints.size(); ++v) {
        const float w = std::clamp((film.meshes[0].positions[v].x + 6) / 12, 0.0f, 1.0f);
        film.meshes[0].joints[v].joint = {0, 1, 0, 0, 0, 0, 0, 0};
        film.meshes[0].joints[v].weight = {1 - w, w, 0, 0, 0, 0, 0, 0};
    }
    film.tracks.push_back(turn(3, 0.3, {0, 0, 1}));
    const Shown shown(std::move(film));
    EXPECT_EQ(shown.film.objects[0].mobility, Mobility::deforming);

    const double c = std::cos(0.3), s = std::sin(0.3);
    const int count = for_each(shown, PixelClass::surface, [&](int x, int y, glm::vec2 v) {
        // The vertices carry the closed form; within a triangle it is interpolated.
        const core::SurfaceAddress& address = shown.visible.address.at(x, y);
        const glm::uvec3 t = shown.film.meshes[0].triangles[address.primitive];
        const double share[3] = {1.0 - static_cast<double>(address.u) - static_cast<double>(address.v), address.u,
                                 address.v};
        glm::dvec3 to(0);
        for (int k = 0; k < 3; ++k) {
            const glm::dvec3 p(shown.film.meshes[0].positions[t[k]]);
            const double w = std::clamp((p.x + 6) / 12, 0.0, 1.0);
            const glm::dvec3 turned(c * p.x - s * p.y, s * p.x + c * p.y, p.z);
            to += share[k] * ((1 - w) * p + w * turned + glm::dvec3(0, 0, -10));
        }
        expect_vector(v, pixel_of(to) - glm::dvec2(x + 0.5, y + 0.5), x, y);
    });
    EXPECT_EQ(count, size * size);
}

TEST(Motion, OfAMorphedWallIsTheWeightedOffset) {
    Animation film = wall_film();
    film.meshes[0].morph_targets.resize(2);
    film.meshes[0].morph_targets[0].positions.assign(film.meshes[0].positions.size(), {1, 0, 0});
    film.meshes[0].morph_targets[1].positions.assign(film.meshes[0].positions.size(), {0, 2, 0});
    film.tracks.push_back({TrackTarget::weights, 0, Interpolation::linear, 2, {0, 1}, {0, 0, 1.5f, -0.5f}});
    const Shown shown(std::move(film));
    // 1.5 to the right and 1 down of 10 units a half picture.
    const int count = for_each(shown, PixelClass::surface, [&](int x, int y, glm::vec2 v) {
        expect_vector(v, {1.5 * size / 20, 1.0 * size / 20}, x, y);
    });
    EXPECT_EQ(count, size * size);
}

TEST(Motion, OfTheSkyIsTheCamerasRotationAlone) {
    Animation film = wall_film();
    film.nodes[0].translation = {0, 0, 10};  // behind the camera
    film.tracks.push_back(turn(1, 0.25, {0, 1, 0}));
    film.tracks.push_back(shift(1, {0, 0, 0}, {5, -3, 2}));
    const Shown shown(std::move(film));
    int gone = 0;
    const int count = for_each(shown, PixelClass::sky, [&](int x, int y, glm::vec2 v) {
        const glm::dvec3 d(2 * (x + 0.5) / size - 1, 1 - 2 * (y + 0.5) / size, -1);
        const double c = std::cos(0.25), s = std::sin(0.25);
        const glm::dvec3 in_last(c * d.x - s * d.z, d.y, s * d.x + c * d.z);
        ASSERT_LT(in_last.z, 0);
        expect_vector(v, pixel_of(in_last) - glm::dvec2(x + 0.5, y + 0.5), x, y);
        EXPECT_TRUE(std::isinf(shown.motion.depth_in_reference.at(x, y)));
        gone += v.x > size;
    });
    EXPECT_EQ(count, size * size);
}

TEST(Motion, IsNoneForWhatIsGoneOrBehindTheReferencesCamera) {
    Animation film = wall_film();
    film.tracks.push_back(turn(1, 3.0, {0, 1, 0}));  // the camera looks away
    const Shown behind(std::move(film));
    EXPECT_EQ(for_each(behind, PixelClass::none, [](int, int, glm::vec2 v) { EXPECT_EQ(v, glm::vec2(0)); }),
              size * size);

    Animation vanishing = wall_film();
    vanishing.tracks.push_back({TrackTarget::scale, 0, Interpolation::linear, 3, {0, 1}, {1, 1, 1, 0, 0, 0}});
    const Shown gone(std::move(vanishing));
    EXPECT_FALSE(gone.last.objects[0].present);
    EXPECT_EQ(for_each(gone, PixelClass::none, [](int, int, glm::vec2) {}), size * size);

    Animation hidden = wall_film();
    hidden.tracks.push_back({TrackTarget::visibility, 0, Interpolation::step, 1, {0, 1}, {1, 0}});
    const Shown switched(std::move(hidden));
    EXPECT_TRUE(switched.first.objects[0].present);
    EXPECT_FALSE(switched.last.objects[0].present);
    EXPECT_EQ(for_each(switched, PixelClass::none, [](int, int, glm::vec2) {}), size * size);
}

TEST(Motion, KeepsTheClassOfReflectingSurfaces) {
    Animation film = wall_film();
    film.tracks.push_back(shift(0, {0, 0, -10}, {1, 0, -10}));
    Shown shown(std::move(film));
    shown.visible.kind.at(5, 6) = PixelClass::reflected;
    const core::MotionField motion = motion_between(shown.visible, shown.first, shown.last);
    EXPECT_EQ(motion.kind.at(5, 6), PixelClass::reflected);
    EXPECT_NEAR(motion.vector.at(5, 6).x, size / 20.0, 0.001);
}

TEST(Motion, InRowsEqualsMotionAtOnce) {
    Animation film = wall_film();
    film.tracks.push_back(turn(0, 0.4, {1, 0, 0}));
    const Shown shown(std::move(film));
    core::MotionField rows = motion_field_for(shown.visible, shown.first, shown.last);
    motion_of_rows(shown.visible, shown.first, shown.last, 13, size, rows);
    motion_of_rows(shown.visible, shown.first, shown.last, 0, 13, rows);
    EXPECT_EQ(rows.vector, shown.motion.vector);
    EXPECT_EQ(rows.kind, shown.motion.kind);
    EXPECT_EQ(rows.depth_in_reference, shown.motion.depth_in_reference);
    EXPECT_EQ(rows.picture, 0);
    EXPECT_EQ(rows.reference, 1);
}

TEST(Carry, AgreesWithTheSeenPositionToATenThousandthOfTheDepth) {
    Animation film = wall_film();
    film.nodes[0].rotation = glm::angleAxis(0.8, glm::normalize(glm::dvec3(1, 1, 0)));
    film.nodes[0].scale = {1, 2, -0.5};
    const Shown shown(std::move(film));
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            if (shown.visible.kind.at(x, y) != PixelClass::surface) continue;
            const Ray ray =
                shown.first.camera.ray_through({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
            const float depth = shown.visible.depth.at(x, y);
            const glm::vec3 seen =
                ray.origin + ray.direction * (depth / glm::dot(ray.direction, shown.first.camera.forward()));
            const auto carried = carry(shown.visible.address.at(x, y), shown.first);
            ASSERT_TRUE(carried);
            EXPECT_LT(glm::length(*carried - seen), 1e-4f * depth);
        }
    EXPECT_FALSE(carry(core::SurfaceAddress{}, shown.first));
}

}  // namespace
}  // namespace render2mpeg::scene
