#include <gtest/gtest.h>

#include <algorithm>

#include "core/color.h"
#include "core/motion_field.h"
#include "perceptual/visibility_model.h"
#include "tests/perceptual/lit_wall.h"

/// What comes of tolerances over many frames: they neither drift nor add up.
namespace render2mpeg::perceptual {
namespace {

TEST(FeedbackOfCoding, QuantisersOtherThanPlannedDoNotAddUp) {
    // The encoder takes half the planned quantiser everywhere, picture after picture.
    const VisibilityModel model(display);
    const CodingPlan plan = plan_of(false, 8);
    CodedFacts facts = coded_as(0, plan);
    for (float& scale : facts.scale.values()) scale *= 0.5f;
    const core::Radiance radiance = wall(0);
    TemporalState state = model.judge(model.observe(display.develop(radiance), radiance, seen()), facts);
    const double first = mean(state.tolerances);
    for (int frame = 1; frame <= 30; ++frame) {
        Tolerated tolerated = model.tolerate(*seen(), plan, state, nullptr, 1.0f);
        state =
            model.judge(model.observe(display.develop(radiance), radiance, seen(), std::move(tolerated.warped)), facts);
        ASSERT_NEAR(mean(state.tolerances) / first, 1.0, 1e-3) << frame;
    }
}

TEST(FeedbackOfCoding, CodingFinerThanPlannedPictureAfterPictureDoesNotAddUp) {
    // Lit for quantiser 2 and coded by 1, as rate control may: what is warped halves with it.
    const VisibilityModel model(display);
    const CodingPlan planned = plan_of(true, 2);
    CodedFacts facts = coded_as(0, plan_of(true, 1));
    facts.lit_for = planned;
    const core::Radiance radiance = wall(0);
    TemporalState state = model.judge(model.observe(display.develop(radiance), radiance, seen()), facts);
    const double first = mean(state.tolerances);
    for (int frame = 1; frame <= 50; ++frame) {
        Tolerated tolerated = model.tolerate(*seen(), planned, state, nullptr, 1.0f);
        state =
            model.judge(model.observe(display.develop(radiance), radiance, seen(), std::move(tolerated.warped)), facts);
        ASSERT_NEAR(mean(state.tolerances) / first, 1.0, 0.01) << frame;
    }
}

/// A film that renders with errors as large as it is allowed: tolerances of frame n steer the noise of frame n.
struct Kind {
    const char* name;
    CodingPlan plan;
    float brightness;  ///< of the wall
    int speed;         ///< pixels a frame, to the left
};

struct Film {
    const VisibilityModel& model;
    Kind kind;
    TemporalState state = judged(0, wall_at(0), {});

    /// The wall as frame `frame` shows it, without errors; it repeats beyond its sides.
    core::Radiance wall_at(std::int64_t frame) const {
        const core::Radiance whole = wall(0);
        core::Radiance radiance = whole;
        radiance.frame = frame;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                radiance.combined.at(x, y) =
                    kind.brightness * whole.combined.at(static_cast<int>((x + frame * kind.speed) % width), y);
        return radiance;
    }
    TemporalState judged(std::int64_t frame, const core::Radiance& radiance, const MaskedErrors& warped) const {
        CodedFacts facts = coded_as(frame, kind.plan);
        // Predicted pictures quantise what exact motion leaves of the frame before: errors of both.
        if (!kind.plan.intra && frame > 0) facts.prediction = display.develop(wall_at(frame)).y;
        core::Picture picture = display.develop(radiance);
        picture.number = frame;
        return model.judge(model.observe(picture, radiance, seen(), warped), facts);
    }

    /// Renders, codes and judges the next frame; gives the mean tolerance that it was lit by.
    double step(std::int64_t frame) {
        core::MotionField motion;
        motion.picture = frame;
        motion.reference = state.number;
        motion.vector = core::Plane<glm::vec2>(width, height, glm::vec2(static_cast<float>(kind.speed), 0.0f));
        motion.depth_in_reference = core::Plane<float>(width, height, 2.0f);
        motion.kind = core::Plane<core::PixelClass>(width, height, core::PixelClass::surface);
        Tolerated tolerated = model.tolerate(*seen(), kind.plan, state, &motion, 1.0f);
        core::Radiance radiance = wall_at(frame);
        for (std::size_t i = 0; i < radiance.combined.size(); ++i) {
            glm::vec3& c = radiance.combined.values()[i];
            const core::Tolerance t = tolerated.map.pixels.values()[i];
            const float y = core::luminance(c), error = t.allows(y);
            const float sign = 2.0f * core::uniform(7, i, static_cast<std::uint64_t>(frame)) - 1.0f;
            // A third of the tolerance, as a calibrated stop leaves it.
            c *= std::max(0.0f, 1.0f + sign * error / (3.0f * y));
        }
        const double now = mean_absolute(tolerated.map);
        state = judged(frame, radiance, std::move(tolerated.warped));
        return now;
    }
};

class Feedback : public testing::TestWithParam<Kind> {
  protected:
    VisibilityModel model{display};
};
INSTANTIATE_TEST_SUITE_P(Films, Feedback,
                         testing::Values(Kind{"Still", plan_of(true, 8), 1.0f, 0},
                                         Kind{"Moving", plan_of(true, 8), 1.0f, 1},
                                         Kind{"Predicted", plan_of(false, 8), 1.0f, 0},
                                         Kind{"PredictedMoving", plan_of(false, 24), 1.0f, 2},
                                         Kind{"Dark", plan_of(true, 16), 0.02f, 0},
                                         Kind{"DarkPredictedMoving", plan_of(false, 8), 0.02f, 1}),
                         [](const auto& kind) { return std::string(kind.param.name); });

TEST_P(Feedback, SettlesWithinTenFrames) {
    Film film{model, GetParam()};
    std::vector<double> means;
    for (int frame = 1; frame <= 20; ++frame) means.push_back(film.step(frame));
    // What moves falls on the blocks otherwise in every frame: eight of them are one round. What stands scatters, too,
    // in a picture of 45 blocks whose errors are drawn anew for every frame: two are taken together.
    const int round = GetParam().speed == 0 ? 2 : 8;
    const auto mean_from = [&](int frame) {
        return std::accumulate(means.begin() + frame, means.begin() + frame + round, 0.0) / round;
    };
    for (int frame = 10; frame + round < 20; ++frame)
        EXPECT_NEAR(mean_from(frame + 1) / mean_from(frame), 1.0, 0.01) << frame;
}

TEST_P(Feedback, ReturnsFromAPerturbation) {
    for (const float factor : {0.5f, 2.0f}) {
        Film film{model, GetParam()}, undisturbed{model, GetParam()};
        for (float& t : film.state.tolerances.values()) t *= factor;
        double disturbed = 0, quiet = 0;
        for (int frame = 1; frame <= 6; ++frame) disturbed = film.step(frame), quiet = undisturbed.step(frame);
        EXPECT_NEAR(disturbed / quiet, 1.0, 0.1) << factor;
    }
}

TEST_P(Feedback, DoesNotDriftInTwoHundredFramesSlow) {
    Film film{model, GetParam()};
    for (int frame = 1; frame <= 200; ++frame) film.step(frame);
    // Against what the reference frames themselves would say, over a round of places on the blocks.
    double last = 0, reference = 0;
    for (int frame = 201; frame <= 208; ++frame) {
        last += film.step(frame);
        reference += mean(model.errors(film.judged(frame, film.wall_at(frame), {}), film.kind.plan));
    }
    EXPECT_NEAR(last / reference, 1.0, 0.05);
}

}  // namespace
}  // namespace render2mpeg::perceptual
