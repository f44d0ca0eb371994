#include "tests/reference/fog.h"

#include <gtest/gtest.h>

#include <cmath>

#include "renderer/surface/posed_scene.h"
#include "scene/preparation/traits.h"
#include "tests/reference/path_tracer.h"
#include "tests/renderer/film_stage.h"

namespace render2mpeg::renderer {
namespace {

using test::FilmStage;
using test::SceneBuilder;

/// A room with a lamp behind a bar, in fog.
SceneBuilder foggy_room(float falloff, float anisotropy) {
    SceneBuilder b;
    const int grey = b.add_material({0.7f, 0.6f, 0.5f});
    b.add_box({0, 0, 0}, {4, 3, 6}, grey, true);
    b.add_box({1.8f, 0, 2}, {2.2f, 3, 2.3f}, grey);
    b.add_point_light({2.1f, 1.6f, 1}, 5.0f, {1, 0.8f, 0.6f});
    b.add_point_light({0.4f, 2.6f, 4}, 2.0f, {0.3f, 0.6f, 1});
    b.add_camera({2, 1.4f, 5.8f}, {2, 1.3f, 0});
    b.film().fog.visibility = 9;
    b.film().fog.color = {0.9f, 0.8f, 0.7f};
    b.film().fog.falloff = falloff;
    b.film().fog.height = 0.5f;
    b.film().fog.anisotropy = anisotropy;
    return b;
}

constexpr int columns = 8, rows = 6;

class FogSlow : public testing::TestWithParam<int> {};

TEST_P(FogSlow, IsThatOfPaths) {
    const bool layers = GetParam() == 1;
    const SceneBuilder b = foggy_room(layers ? 0.8f : 0.0f, layers ? 0.4f : 0.0f);
    Settings settings = test::small_frame(columns, rows);
    settings.vpls = 0;
    FilmStage stage(b, settings);
    const core::Radiance ours = stage.reference();

    const scene::Animation film = b.build();
    Wanted wanted;
    wanted.indirect = false;
    PosedScene posed(film, core::detect_isa(), make_plan(scene::traits_of(film), wanted));
    const scene::Snapshot world = test::snapshot(film, 0, columns, rows);
    posed.pose(world);
    reference::PathSettings paths;
    paths.bounces = 0;
    const auto truth = reference::PathTracer(posed).picture(columns, rows, paths, 2500, 1);
    double off = 0, sum = 0;
    int beyond = 0;
    for (std::size_t p = 0; p < truth.size(); ++p) {
        const glm::dvec3 ours_here = ours.combined.values()[p];
        for (int c = 0; c < 3; ++c) {
            const double allowed = 4 * truth[p].error[c] + 0.01 * truth[p].mean[c];
            beyond += std::abs(ours_here[c] - truth[p].mean[c]) > allowed ? 1 : 0;
            off += ours_here[c] - truth[p].mean[c];
            sum += truth[p].mean[c];
        }
    }
    // A lattice of rays stands for the pixels: edges of shafts may be off in a few.
    EXPECT_LE(beyond, 1);
    EXPECT_NEAR(off / sum, 0, 0.005);
}

INSTANTIATE_TEST_SUITE_P(EvenAndLayered, FogSlow, testing::Values(0, 1));

}  // namespace
}  // namespace render2mpeg::renderer
