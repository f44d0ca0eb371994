#include "perceptual/visibility_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/color.h"
#include "perceptual/warp.h"
#include "tests/perceptual/lit_wall.h"

namespace render2mpeg::perceptual {
namespace {

class WarpedMasking : public testing::Test {
  protected:
    VisibilityModel model{display};
};

TEST_F(WarpedMasking, TolerancesGrowWithTheQuantiser) {
    double before = 0;
    for (const int quantiser : {1, 2, 4, 8, 16, 31}) {
        const CodingPlan plan = plan_of(true, quantiser);
        const double now = mean_absolute(model.tolerate(*seen(), plan, state_of(model, plan), nullptr, 1.0f).map);
        EXPECT_GT(now, before);
        before = now;
    }
}

TEST_F(WarpedMasking, AChangeOfQuantiserOrTypeIsNotAFrameLate) {
    for (const CodingPlan& was : {plan_of(true, 4), plan_of(false, 6)})
        for (const CodingPlan& next : {plan_of(true, 16), plan_of(false, 24), plan_of(true, 2)}) {
            const TemporalState state = state_of(model, was);
            const core::Plane<float> wanted = model.errors(state, next);
            const MaskedErrors warped = model.tolerate(*seen(), next, state, nullptr, 1.0f).warped;
            for (std::size_t i = 0; i < wanted.size(); ++i)
                ASSERT_NEAR(warped.values()[i].x, wanted.values()[i], 1e-4f * wanted.values()[i]) << i;
        }
}

TEST_F(WarpedMasking, TheShareScalesWhatIsHiddenDownToTheFloors) {
    const CodingPlan plan = plan_of(true, 16);
    const TemporalState state = state_of(model, plan);
    const core::ToleranceMap full = model.tolerate(*seen(), plan, state, nullptr, 1.0f).map,
                             half = model.tolerate(*seen(), plan, state, nullptr, 0.5f).map;
    const float floor = model.light().darkest_step();
    for (std::size_t i = 0; i < full.pixels.size(); ++i) {
        EXPECT_FLOAT_EQ(half.pixels.values()[i].absolute, std::max(0.5f * full.pixels.values()[i].absolute, floor));
        EXPECT_FLOAT_EQ(half.pixels.values()[i].relative, 0.02f);
    }
}

TEST_F(WarpedMasking, WhatIsHiddenIsToldForTheLightThatHidIt) {
    const CodingPlan plan = plan_of(true, 16);
    const TemporalState state = state_of(model, plan);
    const core::ToleranceMap map = model.tolerate(*seen(), plan, state, nullptr, 0.5f).map;
    const float floor = model.light().darkest_step();
    int bound = 0;
    for (std::size_t i = 0; i < map.pixels.size(); ++i) {
        const core::Tolerance& t = map.pixels.values()[i];
        const float background = state.light.luminance.values()[i];
        EXPECT_LE(t.background, background);
        // As much light as it had: all of it. Next to none: at least half a code value.
        EXPECT_FLOAT_EQ(t.allows(background), std::max(t.absolute, t.relative * background));
        EXPECT_GE(t.allows(0), 0.999f * floor);
        if (t.absolute > 4 * floor && t.background == background && background > 4 * t.absolute) {
            EXPECT_FLOAT_EQ(t.allows(0.5f * background), 0.5f * t.absolute);
            ++bound;
        }
    }
    EXPECT_GT(bound, static_cast<int>(map.pixels.size() / 10));
}

TEST_F(WarpedMasking, WhatIsCarriedToAPictureIsWhatItsLightHides) {
    const CodingPlan plan = plan_of(true, 4);
    const TemporalState state = state_of(model, plan);
    const MaskedErrors warped = model.tolerate(*seen(), plan, state, nullptr, 1.0f).warped;
    const core::Radiance radiance = wall(0);
    const auto carried_to = [&](float light) {
        core::Radiance dimmed = radiance;
        for (glm::vec3& c : dimmed.combined.values()) c *= light;
        return model.observe(display.develop(dimmed), dimmed, seen(), warped).warped;
    };
    const core::Plane<float> same = carried_to(1.0f), dimmer = carried_to(0.6f), dark = carried_to(0.25f);
    int bound = 0;
    for (std::size_t i = 0; i < same.size(); ++i) {
        const glm::vec2 masked = warped.values()[i];
        EXPECT_FLOAT_EQ(same.values()[i], masked.x);
        EXPECT_FLOAT_EQ(dimmer.values()[i], masked.x);
        if (masked.x > 0.2f * masked.y) continue;
        EXPECT_NEAR(dark.values()[i], 0.5f * masked.x, 1e-4f * masked.x);
        ++bound;
    }
    EXPECT_GT(bound, static_cast<int>(same.size() / 10));
}

/// The share of its luminance that a quarter of the pixels stay below, by their luma and without those next to black:
/// of all pixels from column `from` on, one by one.
float low_fraction(const TemporalState& state, int from = 0) {
    std::vector<std::pair<float, float>> shares;
    float whole = 0, sum = 0;
    for (int y = 0; y < state.light.height(); ++y)
        for (int x = from; x < state.light.width(); ++x) {
            const float share = state.tolerances.at(x, y) / state.light.luminance.at(x, y);
            const float above = state.light.luma.at(x, y) - 16.0f;
            if (above >= 16.0f) shares.emplace_back(std::min(share, 0.5f), above);
        }
    std::sort(shares.begin(), shares.end());
    for (const auto& [share, weight] : shares) whole += weight;
    for (const auto& [share, weight] : shares)
        if ((sum += weight) >= 0.25f * whole) return share;
    return 0;
}

/// What a pixel that nobody saw before may be off by.
float unseen(const VisibilityModel& model, const TemporalState& state) {
    core::Visible other = *state.visible;
    other.address.at(3, 3).object = 1;
    return model.tolerate(other, state.plan, state, nullptr, 1.0f).map.pixels.at(3, 3).relative;
}

TEST_F(WarpedMasking, WhatHasNoPartnerGetsALowShareOfThePicture) {
    const CodingPlan plan = plan_of(true, 16);
    const TemporalState state = state_of(model, plan);
    core::Visible other = *seen();
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width / 2; ++x) other.address.at(x, y).object = 1;
    for (const float share : {1.0f, 0.3f}) {
        const Tolerated tolerated = model.tolerate(other, plan, state, nullptr, share);
        EXPECT_EQ(tolerated.warped.at(3, 3).x, no_partner);
        EXPECT_EQ(tolerated.map.pixels.at(3, 3).absolute, model.light().darkest_step());
        EXPECT_NEAR(tolerated.map.pixels.at(3, 3).relative / (share * low_fraction(state)), 1.0f, 0.02f);
        EXPECT_GT(tolerated.map.pixels.at(width - 3, 3).absolute, model.light().darkest_step());
        EXPECT_EQ(tolerated.map.pixels.at(width - 3, 3).relative, 0.02f);
    }
    // No less than 2 % in any case.
    EXPECT_EQ(model.tolerate(other, plan, state, nullptr, 1e-3f).map.pixels.at(3, 3).relative, 0.02f);
}

/// Rough light of one brightness left of a column, of another right of it.
TemporalState stage_in_the_dark(const VisibilityModel& model, int quantiser, float dark, float lit, int border) {
    core::Radiance radiance;
    radiance.combined = core::Plane<glm::vec3>(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            radiance.combined.at(x, y) =
                glm::vec3((x < border ? dark : lit) *
                          (0.6f + 0.8f * core::uniform(1, static_cast<std::uint64_t>(y * width + x))));
    const CodingPlan plan = plan_of(true, quantiser);
    return model.judge(model.observe(display.develop(radiance), radiance, seen()), coded_as(0, plan));
}

TEST_F(WarpedMasking, TheDarkDoesNotTellWhatTheLightHides) {
    constexpr int border = 56;  // blocks of both are kept apart; the dark has nearly 80 % of the picture
    for (const int quantiser : {4, 16, 31})
        for (const float dark : {0.0f, 1.0f, 4.0f}) {  // black, a code value or two above it, some more
            const float step = 2 * model.light().darkest_step();
            const TemporalState state = stage_in_the_dark(model, quantiser, dark * step, 0.3f, border);
            const float told = unseen(model, state), lit = low_fraction(state, border + 4);
            EXPECT_GE(told, 0.02f) << quantiser << " " << dark;
            EXPECT_LE(told, 1.5f * lit) << quantiser << " " << dark;
            EXPECT_GE(told, 0.5f * lit) << quantiser << " " << dark;
        }
}

TEST_F(WarpedMasking, APictureNextToBlackTellsNothingOfWhatIsNotSeenInIt) {
    const float step = 2 * model.light().darkest_step();
    for (const int quantiser : {1, 4, 16, 31}) {
        EXPECT_EQ(unseen(model, stage_in_the_dark(model, quantiser, step, step, 0)), 0.02f) << quantiser;
        // A few lit pixels make no difference.
        EXPECT_EQ(unseen(model, stage_in_the_dark(model, quantiser, 0.0f, 0.3f, width - 1)), 0.02f) << quantiser;
    }
}

TEST(Unseen, IsToldByNoPatternOfThePictureInStep) {
    // Bright columns at every `period`-th place, in a width that many a stride divides.
    const VisibilityModel model(display);
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
        TemporalState state =
            model.assume_coded(model.observe(display.develop(radiance), radiance, visible), plan_of(true, 8));
        const float all = low_fraction(state);
        EXPECT_NEAR(model.requantise(state, state.plan).low_fraction / all, 1.0f, 0.05f) << period;
    }
}

TEST_F(WarpedMasking, BlackAndWhitePicturesHaveFiniteTolerances) {
    for (const float light : {0.0f, 1e-20f, 1e6f}) {
        core::Radiance radiance;
        radiance.combined = core::Plane<glm::vec3>(width, height, glm::vec3(light));
        const CodingPlan plan = plan_of(true, 31);
        const TemporalState state =
            model.judge(model.observe(display.develop(radiance), radiance, seen()), coded_as(0, plan));
        const core::ToleranceMap map = model.tolerate(*seen(), plan, state, nullptr, 1.0f).map;
        for (const core::Tolerance& t : map.pixels.values()) {
            EXPECT_TRUE(std::isfinite(t.absolute));
            EXPECT_GT(t.absolute, 0.0f);
        }
    }
}

TEST_F(WarpedMasking, MacroblocksThatWereIntraInAPredictedPictureStayIntra) {
    const CodingPlan plan = plan_of(false, 31);
    const core::Radiance radiance = wall(0);
    CodedFacts facts = coded_as(0, plan);
    facts.intra.at(3, 1) = 1;
    const Observation observation = model.observe(display.develop(radiance), radiance, seen());
    const TemporalState mixed = model.judge(observation, facts), inter = model.judge(observation, coded_as(0, plan));
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

TEST_F(WarpedMasking, WhatMacroblocksReallyGotIsWhatCounts) {
    const CodingPlan nominal = plan_of(true, 8);
    CodedFacts facts = coded_as(0, nominal);
    for (int x = 0; x < facts.scale.width(); ++x)
        for (int y = 0; y < facts.scale.height(); ++y) facts.scale.at(x, y) = 16 / 8.0f;
    const core::Radiance radiance = wall(0);
    const Observation observation = model.observe(display.develop(radiance), radiance, seen());
    const TemporalState really = model.judge(observation, facts),
                        coarser = model.judge(observation, coded_as(0, plan_of(true, 16)));
    EXPECT_EQ(really.errors, coarser.errors);
}

TEST(QuantisedMasking, SeesCodingErrors) {
    const VisibilityModel model(display, Strategy::quantised);
    const CodingPlan plan = plan_of(true, 16);
    const core::Radiance radiance = wall(0);
    CodedFacts facts = coded_as(0, plan);
    facts.reconstruction = core::Plane<std::uint8_t>(width, height, 100);
    const Observation observation = model.observe(display.develop(radiance), radiance, seen());
    const TemporalState flat = model.judge(observation, facts);
    facts.reconstruction = display.develop(radiance).y;
    const TemporalState true_to_life = model.judge(observation, facts);
    EXPECT_NE(flat.thresholds.blocks, true_to_life.thresholds.blocks);
    EXPECT_GT(mean(true_to_life.errors), 0.0);
}

}  // namespace
}  // namespace render2mpeg::perceptual
