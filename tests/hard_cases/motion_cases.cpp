#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/hard_cases/hard_case.h"

namespace render2mpeg::test {
namespace {

/// A lit floor with a block that moves through these places, one a frame.
SceneBuilder block_through(const std::vector<glm::vec3>& places) {
    SceneBuilder b = floor_from_above();
    const int block = b.add_box({-0.3f, 0, -0.3f}, {0.3f, 0.3f, 0.3f}, b.add_material({0.2f, 0.4f, 0.6f}));
    b.move_object(block, places);
    b.add_point_light({0.5f, 1.9f, 0.5f}, 1);
    return b;
}

SceneBuilder block_at(glm::vec3 place) {
    return block_through({place, place, place});
}

/// Track of the block's node.
void add_track(SceneBuilder& b, scene::TrackTarget target, int width, std::vector<float> times,
               std::vector<float> values) {
    b.add_track(target, b.film().objects.back().node, width, std::move(times), std::move(values));
}

SceneBuilder block_with(scene::TrackTarget target, int width, std::vector<float> times, std::vector<float> values) {
    SceneBuilder b = floor_from_above();
    b.add_box({-0.3f, 0, -0.3f}, {0.3f, 0.3f, 0.3f}, b.add_material({0.2f, 0.4f, 0.6f}));
    add_track(b, target, width, std::move(times), std::move(values));
    b.add_point_light({0.5f, 1.9f, 0.5f}, 1);
    return b;
}

/// A block with two shapes, each a tenth higher: 3 of one and -1 of the other are as high as 1 of each.
SceneBuilder morphed_block(float rise, float sink) {
    SceneBuilder b = floor_from_above();
    const int block = b.add_box({-0.3f, 0, -0.3f}, {0.3f, 0.3f, 0.3f}, b.add_material({0.2f, 0.4f, 0.6f}));
    scene::Object& object = b.film().objects.at(static_cast<std::size_t>(block));
    scene::Mesh& mesh = b.film().meshes.at(static_cast<std::size_t>(object.mesh));
    for (const float by : {0.1f, 0.1f}) {
        scene::MorphTarget& shape = mesh.morph_targets.emplace_back();
        for (const glm::vec3& corner : mesh.positions) shape.positions.push_back({0, corner.y > 0 ? by : 0.0f, 0});
    }
    object.morph_weights = {rise, sink};
    b.add_point_light({0.5f, 1.9f, 0.5f}, 1);
    return b;
}

/// The last frame is what a film is that was never otherwise.
void expect_ends_as(const Lit& film, const SceneBuilder& other) {
    const HardCase plain;
    const Lit expected = lit(plain, other, film.way);
    EXPECT_NEAR(film.mean(2) / expected.mean(2), 1.0, 0.02);
}

}  // namespace

std::vector<HardCase> motion_cases() {
    using scene::TrackTarget;
    return {
        of_side({"nothing moves", "light or antialiasing that changes with the frame's number",
                 "with fixed tolerances all frames are the same, bit for bit", [] { return small_room(); },
                 [](const Lit& film) {
                     if (film.way == Way::coupled) return;
                     EXPECT_TRUE(same_values(film.frames[0].combined, film.frames[1].combined));
                     EXPECT_TRUE(same_values(film.frames[0].combined, film.frames[2].combined));
                 }},
                16),
        {"a film of one frame",
         "differences of frames, rates and durations are 0/0",
         "an I picture",
         [] { return small_room(); },
         {},
         INFINITY,
         "",
         {16, 16},
         1},
        {"an object that leaps a thousand times the picture",
         "vectors beyond what any f_code can say, false matches in the past",
         "where it ends it looks as if it had always been there",
         [] {
             return block_through({{-1000, 0, 0}, {1000, 0, 0}, {0.2f, 0, 0}});
         },
         [](const Lit& film) {
             expect_ends_as(film, block_at({0.2f, 0, 0}));
         }},
        of_side({"an object that flies through the eye", "division by a distance of 0 or less in its motion",
                 "finite vectors, a whole film",
                 [] {
                     return block_through({{0, 1.2f, 0}, {0, 1.85f, 0}, {0, 2.5f, 0}});
                 }},
                16),
        {"an object that shrinks to nothing", "a matrix without inverse", "in the frame of scale 0 it is not there",
         [] {
             return block_with(TrackTarget::scale, 3, {0, 1, 2}, {1, 1, 1, 0.5f, 0.5f, 0.5f, 0, 0, 0});
         },
         [](const Lit& film) {
             SceneBuilder bare = floor_from_above();
             bare.add_point_light({0.5f, 1.9f, 0.5f}, 1);
             expect_ends_as(film, bare);
         }},
        {"an object that appears", "it has no past to take vectors and tolerances from",
         "as if it had always been there",
         [] {
             return block_with(TrackTarget::visibility, 1, {0, 1, 2}, {0, 0, 1});
         },
         [](const Lit& film) {
             expect_ends_as(film, block_at({0, 0, 0}));
         }},
        {"a turn between opposite quaternions of one rotation", "the long way round, or a sum of 0", "it does not turn",
         [] {
             return block_with(TrackTarget::rotation, 4, {0, 2}, {0, 0, 0, 1, 0, 0, 0, -1});
         },
         [](const Lit& film) { EXPECT_NEAR(film.mean(1) / film.mean(0), 1.0, 0.02); }},
        {"a rotation of quaternion 0", "normalising it", "taken as none, with a note",
         [] {
             return block_with(TrackTarget::rotation, 4, {0, 1}, {0, 0, 0, 0, 0, 0, 0, 1});
         },
         [](const Lit& film) { EXPECT_FALSE(film.notes.empty()); }},
        {"weights of shapes below 0 and above 1", "weights that are clamped or scaled to 1",
         "applied as they are: the block as if its corners lay there", [] { return morphed_block(3, -1); },
         [](const Lit& film) { expect_ends_as(film, morphed_block(1, 1)); }},
        {"two keys at one time", "division by their distance", "the later of them",
         [] {
             return block_with(TrackTarget::translation, 3, {0, 1, 1, 2}, {0, 0, 0, 5, 0, 0, 0.2f, 0, 0, 0.2f, 0, 0});
         },
         [](const Lit& film) {
             expect_ends_as(film, block_at({0.2f, 0, 0}));
         }},
        {"keys that go back in time",
         "a search that never ends, or finds the wrong pair",
         "a line that names the track",
         [] {
             return block_with(TrackTarget::translation, 3, {0, 2, 1}, {0, 0, 0, 1, 0, 0, 2, 0, 0});
         },
         {},
         {},
         "before that of the key"},
        {"a key that is no number",
         "rays that are NaN end the process in Embree",
         "a line that names the track",
         [] {
             return block_with(TrackTarget::translation, 3, {0, 1}, {0, 0, 0, NAN, 0, 0});
         },
         {},
         {},
         "is not finite"},
        {"a spline with tangents of 1e20", "it overshoots to where single precision ends",
         "far away between its keys, and a whole film",
         [] {
             SceneBuilder b = block_with(TrackTarget::translation, 3, {0, 2},
                                         {0, 0, 0, 0, 0, 0, 1e20f, 0, 0, 0, 1e20f, 0, 0.2f, 0, 0, 0, 0, 0});
             b.film().tracks.back().interpolation = scene::Interpolation::cubic_spline;
             return b;
         },
         [](const Lit& film) {
             expect_ends_as(film, block_at({0.2f, 0, 0}));
         }},
        of_side({"a cut in every frame", "nothing has a past", "every frame is as in a film of its own",
                 [] {
                     SceneBuilder b = small_room();
                     b.add_camera({1, 1.5f, 3}, {2, 1, 0});
                     b.film().shots = {{0, 0}, {1, 1}, {2, 0}};
                     return b;
                 },
                 [](const Lit& film) {
                     // Records and tolerances remember the first frame.
                     if (film.way != Way::coupled && film.way != Way::records) {
                         EXPECT_TRUE(same_values(film.frames[0].combined, film.frames[2].combined));
                     }
                     EXPECT_FALSE(same_values(film.frames[0].combined, film.frames[1].combined));
                 }},
                16),
        {"a lamp that goes out", "ratios of its powers are x/0", "black at once, and lit as before when it comes back",
         [] {
             SceneBuilder b = floor_from_above();
             b.add_point_light({0, 2, 0}, 1);
             b.add_track(TrackTarget::light_intensity, 0, 1, {0, 1, 2}, {1, 0, 1});
             return b;
         },
         [](const Lit& film) {
             EXPECT_LT(film.mean(1), 1e-6 * film.mean(0));
             EXPECT_NEAR(film.mean(2) / film.mean(0), 1.0, 0.02);
         }},
        {"a lamp that grows by 1e12 between frames", "updated sums lose what was there, or overflow",
         "each frame has its own light",
         [] {
             SceneBuilder b = floor_from_above();
             b.add_point_light({0, 2, 0}, 1);
             b.add_track(TrackTarget::light_intensity, 0, 1, {0, 1, 2}, {1, 1e12f, 1});
             return b;
         },
         [](const Lit& film) {
             EXPECT_NEAR(film.mean(1) / film.mean(0) / 1e12, 1.0, 0.02);
             EXPECT_NEAR(film.mean(2) / film.mean(0), 1.0, 0.02);
         }},
        {"a block that moves through a lamp", "points inside the lamp, distance 0",
         "finite; the lamp is dark while it is inside",
         [] {
             SceneBuilder b = floor_from_above();
             b.move_object(b.add_box({-0.3f, 0, -0.3f}, {0.3f, 0.3f, 0.3f}, b.add_material({0.2f, 0.4f, 0.6f})),
                           {{-1, 1, 0}, {0, 1, 0}, {1, 1, 0}});
             b.add_point_light({0, 1.15f, 0}, 1);
             return b;
         },
         [](const Lit& film) {
             EXPECT_GT(film.mean(0), 0.0);
             // Records of the frame before may leave what their tolerance hides.
             const bool records = film.way == Way::records || film.way == Way::coupled;
             EXPECT_LE(film.mean(1), records ? 1e-3 * film.mean(0) : 0.0);
             EXPECT_GT(film.mean(2), 0.0);
         }},
    };
}

}  // namespace render2mpeg::test
