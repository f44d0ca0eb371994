#include <gtest/gtest.h>

#include "tests/renderer/film_stage.h"

namespace render2mpeg::renderer {
namespace {

using test::FilmStage;

TEST(PhotonRays, CountWhatAnAuditFollowsNowhereSlow) {
    test::SceneBuilder b = test::furnished_room();
    b.move_object(2, {{1.2f, 0.6f, 1.5f}, {2.0f, 0.6f, 1.5f}});
    FilmStage stage(b);
    const core::ToleranceMap tolerance = core::ToleranceMap::uniform(24, 24, {0.0f, 0.05f});
    const scene::Snapshot first = stage.at(0);
    const Lit lit = stage.renderer().light(first, stage.renderer().look(first), {tolerance});
    const std::uint64_t one = stage.statistics().photon_rays;
    stage.shade(1, tolerance);
    const std::uint64_t two = stage.statistics().photon_rays;
    EXPECT_GT(one, 0u);
    EXPECT_GT(two, one);
    // The first frame's light has to be made again.
    EXPECT_FALSE(stage.renderer().audit(first, lit, tolerance, 20).empty());
    EXPECT_EQ(stage.statistics().photon_rays, two);
}

}  // namespace
}  // namespace render2mpeg::renderer
