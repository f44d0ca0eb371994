#include "renderer/view/edited_mirror.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/motion_field.h"
#include "renderer/truth/pixel_truth.h"
#include "renderer/view/eye_path.h"
#include "scene/pose/bent_reflections.h"
#include "scene/pose/motion.h"
#include "tests/renderer/stage.h"

namespace render2mpeg::test {
namespace {

using scene::TrackTarget;

/// A mirror in which a board is seen that by the law of reflection is not there. All of it may move.
struct EditedFilm {
    SceneBuilder b;
    int mirror = -1, board = -1;

    explicit EditedFilm(bool curved, bool moves = true, float roughness = 0) {
        const int silver = b.add_material({1, 1, 1});
        b.material(silver).metallic = 1;
        b.material(silver).roughness = roughness;
        mirror = curved ? b.add_sphere({0, 0, 0}, 1, silver, 64)
                        : b.add_object(b.add_mesh(SceneBuilder::quad({-2, -2, 1}, {4, 0, 0}, {0, 4, 0})), silver);
        board = b.add_object(b.add_mesh(SceneBuilder::quad({-2, -2, 0}, {4, 0, 0}, {0, 4, 0})),
                             b.add_emitter({1, 0.5f, 0.25f}), {3, 1, 4}, SceneBuilder::looking_along({1, 0.2, 1}));
        scene::Animation& film = b.film();
        scene::Node point, seen;
        point.parent = film.objects[static_cast<std::size_t>(mirror)].node;
        point.translation = curved ? glm::dvec3(0.15, 0.2, 0.968) : glm::dvec3(0.3, 0.2, 1);
        seen.parent = film.objects[static_cast<std::size_t>(board)].node;
        film.nodes.push_back(point);
        film.nodes.push_back(seen);
        const int last = static_cast<int>(film.nodes.size()) - 1;
        film.reflections.push_back({point.parent, last - 1, last, 0.3f, 0.3f});
        const int camera = b.add_camera({0.4f, 0.5f, 6}, {0, 0, 0}, 0.5f);
        b.add_point_light({0, 4, 6}, 20);
        if (!moves) return;
        b.move_object(mirror, {{0, 0, 0}, {0.1, 0.1, -0.2}, {0.2, 0, 0.1}, {0.1, -0.1, 0}});
        b.move_object(board, {{3, 1, 4}, {2.5, 1.5, 4}, {1.5, 2, 4}, {0.5, 2.5, 3.5}});
        b.add_track(TrackTarget::translation, film.cameras[static_cast<std::size_t>(camera)].node, 3, {0, 3},
                    {0.4f, 0.5f, 6, -0.6f, 0.2f, 5});
    }
};

/// What a ray through a place of the picture sees mirrored, and where that is.
std::optional<glm::vec3> mirrored_place(const Stage& stage, glm::vec2 place, std::uint32_t& object) {
    renderer::SeeSettings settings;
    settings.format = {64, 64, 1.0f};
    const renderer::EyePaths paths(stage.posed_scene(), settings, stage.plan());
    float far = 0;
    const renderer::EyeRay ray = renderer::eye_ray(stage.world().camera, place, 1, far);
    renderer::EyeSample sample;
    renderer::SeeCounts counts;
    paths.look(ray, far, stage.tracer().nearest(ray.origin, ray.direction, far), sample, counts);
    object = sample.main.imaged.object;
    return scene::carry(sample.main.imaged, stage.world());
}

TEST(EditedMirror, ShowsItsTargetWithinHalfAPixelWhileAllMoves) {
    for (const bool curved : {false, true}) {
        const EditedFilm film(curved);
        Stage stage(film.b, 64, 64);
        for (int second = 0; second < 4; ++second) {
            stage.pose(second);
            const scene::Bend& bend = stage.world().bends->middle().front();
            EXPECT_GT(glm::length(bend.turn), 0.15);
            const glm::vec2 pixel = stage.world().camera.project_exact(bend.at)->position;
            const scene::Snapshot& world = stage.world();
            const glm::vec3 target(world.objects[static_cast<std::size_t>(film.board)].to_world[3]);
            std::uint32_t object = 0, beside = 0;
            const auto seen = mirrored_place(stage, pixel, object);
            ASSERT_TRUE(seen && object == static_cast<std::uint32_t>(film.board)) << curved << second;
            float half = 1e9f;
            for (const glm::vec2 off :
                 {glm::vec2(0.5f, 0), glm::vec2(-0.5f, 0), glm::vec2(0, 0.5f), glm::vec2(0, -0.5f)})
                if (const auto there = mirrored_place(stage, pixel + off, beside))
                    half = std::min(half, glm::length(*there - *seen));
            EXPECT_LT(glm::length(*seen - target), 0.05f * half) << curved << " " << second;
        }
    }
}

TEST(EditedMirror, MovesItsImageAsTheBentRayGoes) {
    for (const bool curved : {false, true}) {
        const EditedFilm film(curved);
        Stage stage(film.b, 64, 64);
        const renderer::Frame seen = stage.see(1);
        const scene::Snapshot here = stage.world(), later = snapshot(stage.film(), 1, 64, 64);
        const core::MotionField field = scene::motion_between(seen.visible, here, later, &seen.imaged),
                                still = scene::motion_between(seen.visible, here, here, &seen.imaged);
        Stage next(film.b, 64, 64, 1);
        int compared = 0, close = 0, moved = 0;
        for (int y = 8; y < 56; ++y)
            for (int x = 8; x < 56; ++x) {
                const core::SurfaceAddress& image = seen.imaged.at(x, y);
                if (!image.is_surface() || image.object != static_cast<std::uint32_t>(film.board)) continue;
                EXPECT_EQ(still.vector.at(x, y), glm::vec2(0));
                // What is seen in the next frame where the vector leads is the same point of the board.
                const glm::vec2 at = glm::vec2(x + 0.5f, y + 0.5f) + field.vector.at(x, y);
                std::uint32_t object = 0, beside = 0;
                const auto there = mirrored_place(next, at, object),
                           step = mirrored_place(next, at + glm::vec2(1, 0), beside);
                if (!there || !step || object != image.object || beside != object) continue;
                ++compared;
                const float off =
                    glm::length(*there - *scene::carry(image, next.world())) / glm::length(*step - *there);
                close += off < 0.1f;
                moved += glm::length(field.vector.at(x, y)) > 1;
            }
        EXPECT_GT(compared, 40) << curved;
        EXPECT_GT(moved, 20) << curved;
        EXPECT_GT(close, 0.95 * compared) << curved << " " << compared;
    }
}

TEST(EditedMirror, IsTheSameForPathsOfTheTruth) {
    EditedFilm film(true, false);
    Stage stage(film.b, 64, 64);
    const glm::ivec2 pixel(stage.world().camera.project_exact(stage.world().bends->middle().front().at)->position);
    const renderer::Frame seen = stage.see(4);
    const std::size_t tile =
        static_cast<std::size_t>(pixel.y / renderer::tile_size * seen.tiles_across() + pixel.x / renderer::tile_size);
    renderer::GatherTile points;
    for (const renderer::GatherPoint& p : seen.tiles[tile])
        if (p.pixel == (pixel.y % renderer::tile_size) * renderer::tile_size + pixel.x % renderer::tile_size)
            points.push_back(p);
    renderer::SeeSettings settings;
    settings.format = {64, 64, 1.0f};
    settings.samples = 4;
    const renderer::TruthRequest request{pixel, points, 1.0f};
    const auto truth = renderer::pixel_truth(stage.posed_scene(), settings, stage.plan(), {&request, 1}).front();
    // The board shines.
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(seen.emitted.at(pixel.x, pixel.y)[c], (glm::vec3(1, 0.5f, 0.25f))[c], 0.02);
        EXPECT_NEAR(truth.whole.mean()[c], (glm::vec3(1, 0.5f, 0.25f))[c], 0.02);
    }
}

TEST(EditedMirror, BendsLobesWithIt) {
    // The gather points of a rough mirror look where a smooth one would.
    const EditedFilm smooth(true, false), rough(true, false, 0.3f);
    Stage a(smooth.b, 64, 64), b(rough.b, 64, 64);
    const glm::dvec3 at = b.world().bends->middle().front().at;
    const glm::dvec3 target(b.world().objects[static_cast<std::size_t>(rough.board)].to_world[3]);
    float best = 1;
    for (const renderer::GatherTile& tile : b.see(1).tiles)
        for (const renderer::GatherPoint& p : tile)
            if (glm::length(glm::dvec3(p.point.position) - at) < 0.03) {
                const glm::vec3 n = p.point.shading_normal,
                                r = 2 * glm::dot(n, p.point.outgoing) * n - p.point.outgoing;
                best = std::min(best, glm::length(r - glm::vec3(glm::normalize(target - at))));
            }
    EXPECT_LT(best, 0.06f);
}

TEST(EditedMirror, CostsNothingWhereThereIsNone) {
    EditedFilm edited(true, false), plain(true, false);
    plain.b.film().reflections.clear();
    Stage a(plain.b, 64, 64);
    EXPECT_EQ(a.world().bends, nullptr);
    EXPECT_FALSE(a.plan().runs(renderer::Pass::edited_reflections));
    // An edit that shows what is seen anyway, and one that reaches nobody, change no point.
    const renderer::Frame before = a.see(4);
    edited.b.film().nodes[static_cast<std::size_t>(edited.b.film().reflections.front().mirror)].translation = {0, 0, 0};
    edited.b.film().objects[static_cast<std::size_t>(edited.mirror)].name = "mirror";
    scene::Reflection& edit = edited.b.film().reflections.front();
    edited.b.film().nodes[static_cast<std::size_t>(edit.at)].translation = {0, 0, -1};  // behind
    Stage c(edited.b, 64, 64);
    EXPECT_TRUE(c.plan().runs(renderer::Pass::edited_reflections));
    const renderer::Frame after = c.see(4);
    EXPECT_TRUE(
        std::equal(before.emitted.values().begin(), before.emitted.values().end(), after.emitted.values().begin()));
    EXPECT_EQ(a.counts().specular_rays, c.counts().specular_rays);
}

}  // namespace
}  // namespace render2mpeg::test
