#include <gtest/gtest.h>

#include "tests/renderer/film_stage.h"

namespace render2mpeg::renderer {
namespace {

TEST(Clamping, LosesLittleAndLessWithMoreLightPointsSlow) {
    double lost[2];
    for (const int more : {0, 1}) {
        Settings settings = test::lightcuts_frame(16, 16);
        settings.vpls = more != 0 ? 8000 : 500;
        settings.direct_points = more != 0 ? 2048 : 128;
        test::FilmStage stage(test::furnished_room(), settings);
        stage.reference();
        lost[more] = stage.statistics().clamped_energy;
    }
    EXPECT_GT(lost[0], 0.0);
    EXPECT_LT(lost[0], 0.25);
    EXPECT_LT(lost[1], 0.6 * lost[0]);
    Settings none = test::lightcuts_frame();
    none.clamp = Clamp::none;
    test::FilmStage stage(test::furnished_room(), none);
    stage.reference();
    EXPECT_EQ(stage.statistics().clamped_energy, 0.0);
}

}  // namespace
}  // namespace render2mpeg::renderer
