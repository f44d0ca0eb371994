#include "perceptual/observer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/color.h"
#include "core/sampling.h"
#include "perceptual/carry.h"

namespace render2mpeg::perceptual {
namespace {

constexpr int width = 72, height = 40;

/// A lit wall: dark to bright from left to right, rough below.
core::Radiance wall(std::int64_t frame, float noise = 0.0f) {
    core::Radiance radiance;
    radiance.frame = frame;
    radiance.combined = core::Plane<glm::vec3>(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const auto pixel = static_cast<std::uint64_t>(y * width + x);
            const float rough = y < height / 2 ? 1.0f : 0.4f + 1.2f * core::uniform(1, pixel);
            const float error =
                1.0f + noise * (2.0f * core::uniform(2, pixel, static_cast<std::uint64_t>(frame)) - 1.0f);
            radiance.combined.at(x, y) =
                glm::vec3(1.0f, 0.8f, 0.5f) * (rough * error * std::exp2(8.0f * static_cast<float>(x) / width - 7.0f));
        }
    return radiance;
}

std::shared_ptr<const core::Visible> seen() {
    core::Visible visible(0, width, height);
    for (std::size_t i = 0; i < visible.kind.size(); ++i) {
        visible.kind.values()[i] = core::PixelClass::surface;
        visible.address.values()[i] = {0, 0, 0.2f, 0.2f};
        visible.material.values()[i] = 0;
        visible.depth.values()[i] = 2.0f;
    }
    return std::make_shared<const core::Visible>(std::move(visible));
}

CodedFacts coded_as(std::int64_t number, const CodingPlan& plan) {
    CodedFacts facts;
    facts.number = number;
    facts.plan = plan;
    facts.intra = core::Plane<std::uint8_t>((width + 15) / 16, (height + 15) / 16, plan.intra ? 1 : 0);
    facts.scale = core::Plane<float>((width + 15) / 16, (height + 15) / 16, plan.scale);
    return facts;
}

CodingPlan plan_of(bool intra, int quantiser) {
    CodingPlan plan;
    plan.intra = intra;
    plan.scale = static_cast<float>(quantiser) / 8.0f;
    return plan;
}

const Display display(0.0f, ColorMatrix::bt709);

Memory memory_of(const Observer& observer, const CodingPlan& plan) {
    const core::Radiance radiance = wall(0);
    return observer.judge(observer.observe(display.develop(radiance), radiance, seen()), coded_as(0, plan));
}

double mean(const core::Plane<float>& plane) {
    return std::accumulate(plane.values().begin(), plane.values().end(), 0.0) / static_cast<double>(plane.size());
}

double mean_absolute(const core::ToleranceMap& map) {
    double sum = 0;
    for (const core::Tolerance& t : map.pixels.values()) sum += static_cast<double>(t.absolute);
    return sum / static_cast<double>(map.pixels.size());
}

class EverySpread : public testing::TestWithParam<Spread> {
  protected:
    Observer observer{display, {Strategy::carried, GetParam()}};
};
INSTANTIATE_TEST_SUITE_P(Spreads, EverySpread, testing::Values(Spread::block, Spread::pixel));

TEST_P(EverySpread, TolerancesGrowWithTheQuantiser) {
    double before = 0;
    for (const int quantiser : {1, 2, 4, 8, 16, 31}) {
        const CodingPlan plan = plan_of(true, quantiser);
        const double now =
            mean_absolute(observer.tolerate(*seen(), plan, memory_of(observer, plan), nullptr, 1.0f).map);
        EXPECT_GT(now, before);
        before = now;
    }
}

TEST_P(EverySpread, AChangeOfQuantiserOrTypeIsNotAFrameLate) {
    for (const CodingPlan& was : {plan_of(true, 4), plan_of(false, 6)})
        for (const CodingPlan& next : {plan_of(true, 16), plan_of(false, 24), plan_of(true, 2)}) {
            const Memory memory = memory_of(observer, was);
            const core::Plane<float> wanted = observer.errors(memory, next);
            const core::Plane<float> carried = observer.tolerate(*seen(), next, memory, nullptr, 1.0f).carried;
            for (std::size_t i = 0; i < wanted.size(); ++i)
                ASSERT_NEAR(carried.values()[i], wanted.values()[i], 1e-4f * wanted.values()[i]) << i;
        }
}

TEST_P(EverySpread, TheShareScalesWhatIsHiddenDownToTheFloors) {
    const CodingPlan plan = plan_of(true, 16);
    const Memory memory = memory_of(observer, plan);
    const core::ToleranceMap full = observer.tolerate(*seen(), plan, memory, nullptr, 1.0f).map,
                             half = observer.tolerate(*seen(), plan, memory, nullptr, 0.5f).map;
    const float floor = observer.light().darkest_step();
    for (std::size_t i = 0; i < full.pixels.size(); ++i) {
        EXPECT_FLOAT_EQ(half.pixels.values()[i].absolute, std::max(0.5f * full.pixels.values()[i].absolute, floor));
        EXPECT_FLOAT_EQ(half.pixels.values()[i].relative, 0.02f);
    }
}

/// The share of its luminance that a quarter of the pixels stay below, by their luma and without those next to black:
/// of all pixels from column `from` on, one by one.
float low_share(const Memory& memory, int from = 0) {
    std::vector<std::pair<float, float>> shares;
    float whole = 0, sum = 0;
    for (int y = 0; y < memory.light.height(); ++y)
        for (int x = from; x < memory.light.width(); ++x) {
            const float share = memory.tolerances.at(x, y) / memory.light.luminance.at(x, y);
            const float above = memory.light.luma.at(x, y) - 16.0f;
            if (share < 0.5f && above >= 16.0f) shares.emplace_back(share, above);
        }
    std::sort(shares.begin(), shares.end());
    for (const auto& [share, weight] : shares) whole += weight;
    for (const auto& [share, weight] : shares)
        if ((sum += weight) >= 0.25f * whole) return share;
    return 0;
}

/// What a pixel that nobody saw before may be off by.
float unseen(const Observer& observer, const Memory& memory) {
    core::Visible other = *memory.visible;
    other.address.at(3, 3).object = 1;
    return observer.tolerate(other, memory.plan, memory, nullptr, 1.0f).map.pixels.at(3, 3).relative;
}

TEST_P(EverySpread, WhatHasNoPartnerGetsALowShareOfThePicture) {
    const CodingPlan plan = plan_of(true, 16);
    const Memory memory = memory_of(observer, plan);
    core::Visible other = *seen();
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width / 2; ++x) other.address.at(x, y).object = 1;
    for (const float share : {1.0f, 0.3f}) {
        const Tolerated tolerated = observer.tolerate(other, plan, memory, nullptr, share);
        EXPECT_EQ(tolerated.carried.at(3, 3), no_partner);
        EXPECT_EQ(tolerated.map.pixels.at(3, 3).absolute, observer.light().darkest_step());
        EXPECT_NEAR(tolerated.map.pixels.at(3, 3).relative / (share * low_share(memory)), 1.0f, 0.02f);
        EXPECT_GT(tolerated.map.pixels.at(width - 3, 3).absolute, observer.light().darkest_step());
        EXPECT_EQ(tolerated.map.pixels.at(width - 3, 3).relative, 0.02f);
    }
    // No less than 2 % in any case.
    EXPECT_EQ(observer.tolerate(other, plan, memory, nullptr, 1e-3f).map.pixels.at(3, 3).relative, 0.02f);
}

/// Rough light of one brightness left of a column, of another right of it.
Memory stage_in_the_dark(const Observer& observer, int quantiser, float dark, float lit, int border) {
    core::Radiance radiance;
    radiance.combined = core::Plane<glm::vec3>(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            radiance.combined.at(x, y) =
                glm::vec3((x < border ? dark : lit) *
                          (0.6f + 0.8f * core::uniform(1, static_cast<std::uint64_t>(y * width + x))));
    const CodingPlan plan = plan_of(true, quantiser);
    return observer.judge(observer.observe(display.develop(radiance), radiance, seen()), coded_as(0, plan));
}

TEST_P(EverySpread, TheDarkDoesNotTellWhatTheLightHides) {
    constexpr int border = 56;  // blocks of both are kept apart; the dark has nearly 80 % of the picture
    for (const int quantiser : {4, 16, 31})
        for (const float dark : {0.0f, 1.0f, 4.0f}) {  // black, a code value or two above it, some more
            const float step = 2 * observer.light().darkest_step();
            const Memory memory = stage_in_the_dark(observer, quantiser, dark * step, 0.3f, border);
            const float told = unseen(observer, memory), lit = low_share(memory, border + 4);
            EXPECT_GE(told, 0.02f) << quantiser << " " << dark;
            EXPECT_LE(told, 1.5f * lit) << quantiser << " " << dark;
            EXPECT_GE(told, 0.5f * lit) << quantiser << " " << dark;
        }
}

TEST_P(EverySpread, APictureNextToBlackTellsNothingOfWhatIsNotSeenInIt) {
    const float step = 2 * observer.light().darkest_step();
    for (const int quantiser : {1, 4, 16, 31}) {
        EXPECT_EQ(unseen(observer, stage_in_the_dark(observer, quantiser, step, step, 0)), 0.02f) << quantiser;
        // A few lit pixels make no difference.
        EXPECT_EQ(unseen(observer, stage_in_the_dark(observer, quantiser, 0.0f, 0.3f, width - 1)), 0.02f) << quantiser;
    }
}

TEST(Unseen, IsToldByNoPatternOfThePictureInStep) {
    // Bright columns at every `period`-th place, in a width that many a stride divides.
    const Observer observer(display, {});
    constexpr int wide = 16 * 61, high = 68;
    const auto visible = std::make_shared<const core::Visible>(0, wide, high);
    for (const int period : {16, 61}) {
        core::Radiance radiance;
        radiance.combined = core::Plane<glm::vec3>(wide, high);
        for (int y = 0; y < high; ++y)
            for (int x = 0; x < wide; ++x)
                radiance.combined.at(x, y) =
                    glm::vec3((x % period == 0 ? 0.9f : 0.1f) +
                              0.05f * core::uniform(1, static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y)));
        Memory memory =
            observer.presume(observer.observe(display.develop(radiance), radiance, visible), plan_of(true, 8));
        const float all = low_share(memory);
        EXPECT_NEAR(observer.restate(memory, memory.plan).low_share / all, 1.0f, 0.05f) << period;
    }
}

TEST_P(EverySpread, BlackAndWhitePicturesHaveFiniteTolerances) {
    for (const float light : {0.0f, 1e-20f, 1e6f}) {
        core::Radiance radiance;
        radiance.combined = core::Plane<glm::vec3>(width, height, glm::vec3(light));
        const CodingPlan plan = plan_of(true, 31);
        const Memory memory =
            observer.judge(observer.observe(display.develop(radiance), radiance, seen()), coded_as(0, plan));
        const core::ToleranceMap map = observer.tolerate(*seen(), plan, memory, nullptr, 1.0f).map;
        for (const core::Tolerance& t : map.pixels.values()) {
            EXPECT_TRUE(std::isfinite(t.absolute));
            EXPECT_GT(t.absolute, 0.0f);
        }
    }
}

TEST_P(EverySpread, MacroblocksThatWereIntraInAPredictedPictureStayIntra) {
    const CodingPlan plan = plan_of(false, 31);
    const core::Radiance radiance = wall(0);
    CodedFacts facts = coded_as(0, plan);
    facts.intra.at(3, 1) = 1;
    const Observation observation = observer.observe(display.develop(radiance), radiance, seen());
    const Memory mixed = observer.judge(observation, facts), inter = observer.judge(observation, coded_as(0, plan));
    int different = 0;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            if (mixed.errors.at(x, y) == inter.errors.at(x, y)) continue;
            ++different;
            // Interpolation between blocks reaches half a block further.
            EXPECT_TRUE(x >= 48 - 4 && x < 64 + 4 && y >= 16 - 4 && y < 32 + 4) << x << " " << y;
        }
    EXPECT_GE(different, 16 * 16 / 2);
}

TEST_P(EverySpread, WhatMacroblocksReallyGotIsWhatCounts) {
    const CodingPlan nominal = plan_of(true, 8);
    CodedFacts facts = coded_as(0, nominal);
    for (int x = 0; x < facts.scale.width(); ++x)
        for (int y = 0; y < facts.scale.height(); ++y) facts.scale.at(x, y) = 16 / 8.0f;
    const core::Radiance radiance = wall(0);
    const Observation observation = observer.observe(display.develop(radiance), radiance, seen());
    const Memory really = observer.judge(observation, facts),
                 coarser = observer.judge(observation, coded_as(0, plan_of(true, 16)));
    EXPECT_EQ(really.errors, coarser.errors);
}

TEST(FeedbackOfCoding, QuantisersOtherThanPlannedDoNotAddUp) {
    // The encoder takes half the planned quantiser everywhere, picture after picture.
    const Observer observer(display, {});
    const CodingPlan plan = plan_of(false, 8);
    CodedFacts facts = coded_as(0, plan);
    for (float& scale : facts.scale.values()) scale *= 0.5f;
    const core::Radiance radiance = wall(0);
    Memory memory = observer.judge(observer.observe(display.develop(radiance), radiance, seen()), facts);
    const double first = mean(memory.tolerances);
    for (int frame = 1; frame <= 30; ++frame) {
        Tolerated tolerated = observer.tolerate(*seen(), plan, memory, nullptr, 1.0f);
        memory = observer.judge(
            observer.observe(display.develop(radiance), radiance, seen(), std::move(tolerated.carried)), facts);
        ASSERT_NEAR(mean(memory.tolerances) / first, 1.0, 1e-3) << frame;
    }
}

TEST(FeedbackOfCoding, CodingFinerThanPlannedPictureAfterPictureDoesNotAddUp) {
    // Lit for quantiser 2 and coded by 1, as rate control may: what is carried halves with it.
    const Observer observer(display, {});
    const CodingPlan planned = plan_of(true, 2);
    CodedFacts facts = coded_as(0, plan_of(true, 1));
    facts.lit_for = planned;
    const core::Radiance radiance = wall(0);
    Memory memory = observer.judge(observer.observe(display.develop(radiance), radiance, seen()), facts);
    const double first = mean(memory.tolerances);
    for (int frame = 1; frame <= 50; ++frame) {
        Tolerated tolerated = observer.tolerate(*seen(), planned, memory, nullptr, 1.0f);
        memory = observer.judge(
            observer.observe(display.develop(radiance), radiance, seen(), std::move(tolerated.carried)), facts);
        ASSERT_NEAR(mean(memory.tolerances) / first, 1.0, 0.01) << frame;
    }
}

TEST(Observer, MaskingByTheDecodedPictureSeesItsErrors) {
    const Observer observer(display, {Strategy::quantised, Spread::block});
    const CodingPlan plan = plan_of(true, 16);
    const core::Radiance radiance = wall(0);
    CodedFacts facts = coded_as(0, plan);
    facts.reconstruction = core::Plane<std::uint8_t>(width, height, 100);
    const Observation observation = observer.observe(display.develop(radiance), radiance, seen());
    const Memory flat = observer.judge(observation, facts);
    facts.reconstruction = display.develop(radiance).y;
    const Memory true_to_life = observer.judge(observation, facts);
    EXPECT_NE(flat.thresholds.blocks, true_to_life.thresholds.blocks);
    EXPECT_GT(mean(true_to_life.errors), 0.0);
}

/// A film that renders with errors as large as it is allowed: tolerances of frame n steer the noise of frame n.
struct Kind {
    const char* name;
    CodingPlan plan;
    float brightness;  ///< of the wall
    int speed;         ///< pixels a frame, to the left
};

struct Film {
    const Observer& observer;
    Kind kind;
    Memory memory = judged(0, wall_at(0), {});

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
    Memory judged(std::int64_t frame, const core::Radiance& radiance, core::Plane<float> carried) const {
        CodedFacts facts = coded_as(frame, kind.plan);
        // Predicted pictures quantise what exact motion leaves of the frame before: errors of both.
        if (!kind.plan.intra && frame > 0) facts.prediction = display.develop(wall_at(frame)).y;
        core::Picture picture = display.develop(radiance);
        picture.number = frame;
        return observer.judge(observer.observe(picture, radiance, seen(), std::move(carried)), facts);
    }

    /// Renders, codes and judges the next frame; gives the mean tolerance that it was lit by.
    double step(std::int64_t frame) {
        core::MotionField motion;
        motion.picture = frame;
        motion.reference = memory.number;
        motion.vector = core::Plane<glm::vec2>(width, height, glm::vec2(static_cast<float>(kind.speed), 0.0f));
        motion.depth_in_reference = core::Plane<float>(width, height, 2.0f);
        motion.kind = core::Plane<core::PixelClass>(width, height, core::PixelClass::surface);
        Tolerated tolerated = observer.tolerate(*seen(), kind.plan, memory, &motion, 1.0f);
        core::Radiance radiance = wall_at(frame);
        for (std::size_t i = 0; i < radiance.combined.size(); ++i) {
            glm::vec3& c = radiance.combined.values()[i];
            const core::Tolerance t = tolerated.map.pixels.values()[i];
            const float y = core::luminance(c), error = std::max(t.absolute, t.relative * y);
            const float sign = 2.0f * core::uniform(7, i, static_cast<std::uint64_t>(frame)) - 1.0f;
            // A third of the tolerance, as a calibrated stop leaves it.
            c *= std::max(0.0f, 1.0f + sign * error / (3.0f * y));
        }
        const double now = mean_absolute(tolerated.map);
        memory = judged(frame, radiance, std::move(tolerated.carried));
        return now;
    }
};

class Feedback : public testing::TestWithParam<Kind> {
  protected:
    Observer observer{display, {}};
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
    Film film{observer, GetParam()};
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
        Film film{observer, GetParam()}, undisturbed{observer, GetParam()};
        for (float& t : film.memory.tolerances.values()) t *= factor;
        double disturbed = 0, quiet = 0;
        for (int frame = 1; frame <= 6; ++frame) disturbed = film.step(frame), quiet = undisturbed.step(frame);
        EXPECT_NEAR(disturbed / quiet, 1.0, 0.1) << factor;
    }
}

TEST_P(Feedback, DoesNotDriftInTwoHundredFrames) {
    Film film{observer, GetParam()};
    for (int frame = 1; frame <= 200; ++frame) film.step(frame);
    // Against what the reference frames themselves would say, over a round of places on the blocks.
    double last = 0, reference = 0;
    for (int frame = 201; frame <= 208; ++frame) {
        last += film.step(frame);
        reference += mean(observer.errors(film.judged(frame, film.wall_at(frame), {}), film.kind.plan));
    }
    EXPECT_NEAR(last / reference, 1.0, 0.05);
}

}  // namespace
}  // namespace render2mpeg::perceptual
