#include "renderer/base/plan.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "stage.h"

namespace render2mpeg::test {
namespace {

using renderer::make_plan;
using renderer::Pass;
using renderer::Plan;
using renderer::Wanted;
using scene::Traits;

/// Everything at once.
Traits all_traits() {
    Traits t;
    t.has_surfaces = t.has_punctual_lights = t.has_emissive_surfaces = t.has_shining_sky = true;
    t.has_even_lamps = t.has_bodies = t.casts_caustics = true;
    t.has_diffuse_surfaces = t.has_glossy_surfaces = t.has_narrow_lobes = t.has_mirrors = t.has_glass = true;
    t.has_alpha_mask = t.has_alpha_blend = t.has_normal_maps = t.has_textures = true;
    t.camera_moves = t.objects_move = t.objects_deform = t.lights_change = t.has_cuts = true;
    t.has_open_shutter = t.has_aperture = t.has_glare = t.has_fog = t.has_hair = t.has_subsurface = true;
    t.has_edited_reflections = t.has_volumes = true;
    return t;
}

std::set<std::string> running(const Plan& plan) {
    std::set<std::string> names;
    for (const auto& row : plan.rows())
        if (row.runs) names.insert(row.name);
    return names;
}

TEST(Plan, RunsEverythingThatHasACauseAndAReader) {
    Wanted wanted;
    wanted.layers = true;
    const Plan plan = make_plan(all_traits(), wanted);
    EXPECT_EQ(running(plan).size(), static_cast<std::size_t>(Pass::count));
}

TEST(Plan, GivesEveryRowANameAReasonAndItsProduct) {
    for (const Traits& traits : {Traits{}, all_traits()}) {
        const Plan plan = make_plan(traits, {});
        std::set<std::string> names;
        for (std::size_t i = 0; i < plan.rows().size(); ++i) {
            const auto& row = plan.rows()[i];
            EXPECT_EQ(row.pass, static_cast<Pass>(i));
            EXPECT_TRUE(names.insert(row.name).second);
            EXPECT_FALSE(row.reason.empty());
            EXPECT_GT(std::string(row.writes).size(), 3u);
            EXPECT_GT(std::string(row.reads).size(), 3u);
        }
    }
}

TEST(Plan, OfAnEmptyStillSceneHasNothingToDoButLook) {
    const Plan plan = make_plan(Traits{}, {});
    EXPECT_EQ(running(plan), (std::set<std::string>{"see", "shade", "develop", "encode"}));
    EXPECT_EQ(plan.rows()[static_cast<std::size_t>(Pass::glass)].reason, "no cause: nothing is transparent");
}

TEST(Plan, SkipsWhatNobodyReads) {
    // Only pictures in files of scene-linear light: nobody codes, so nobody wants motion or Y'CbCr.
    Wanted wanted;
    wanted.film = false;
    const Plan plan = make_plan(all_traits(), wanted);
    for (const Pass pass : {Pass::motion, Pass::develop, Pass::encode, Pass::layers}) {
        EXPECT_FALSE(plan.runs(pass));
        EXPECT_EQ(plan.rows()[static_cast<std::size_t>(pass)].reason, "nobody reads it");
    }
    EXPECT_TRUE(plan.runs(Pass::shade));

    wanted.developed = true;
    EXPECT_TRUE(make_plan(all_traits(), wanted).runs(Pass::develop));
    EXPECT_FALSE(make_plan(all_traits(), wanted).runs(Pass::encode));
}

TEST(Plan, OfLayersWithoutPicturesStillKnowsMotion) {
    Wanted wanted;
    wanted.film = wanted.picture = false;
    wanted.layers = true;
    const Plan plan = make_plan(all_traits(), wanted);
    EXPECT_TRUE(plan.runs(Pass::motion));
    EXPECT_TRUE(plan.runs(Pass::see));
    EXPECT_FALSE(plan.runs(Pass::encode));
}

TEST(Plan, WithoutIndirectLightTracesNoPhotons) {
    Wanted wanted;
    wanted.indirect = false;
    const Plan plan = make_plan(all_traits(), wanted);
    EXPECT_FALSE(plan.runs(Pass::photons));
    EXPECT_FALSE(plan.runs(Pass::indirect_tree));
    EXPECT_TRUE(plan.runs(Pass::direct_tree));
    EXPECT_EQ(plan.rows()[static_cast<std::size_t>(Pass::photons)].reason, "not wanted");
}

TEST(Plan, LeavesOutEachEffectByItself) {
    const Plan whole = make_plan(all_traits(), {});
    int effects = 0;
    for (const auto& row : whole.rows()) {
        if (std::string(row.effect).empty()) continue;
        ++effects;
        Wanted wanted;
        wanted.without = row.pass;
        const Plan plan = make_plan(all_traits(), wanted);
        EXPECT_FALSE(plan.runs(row.pass));
        EXPECT_EQ(plan.rows()[static_cast<std::size_t>(row.pass)].reason, "not wanted");
        // Beside it only what nobody else reads.
        for (const auto& other : plan.rows())
            if (!other.runs && whole.runs(other.pass) && other.pass != row.pass) {
                EXPECT_EQ(other.reason, "nobody reads it") << row.name << " takes " << other.name << " along";
            }
    }
    EXPECT_GE(effects, 13);
}

TEST(Plan, WithoutCausticsThrowsNoLight) {
    Wanted wanted;
    wanted.caustics = false;
    const Plan plan = make_plan(all_traits(), wanted);
    EXPECT_FALSE(plan.runs(Pass::caustics));
    EXPECT_TRUE(plan.runs(Pass::refraction));
    EXPECT_EQ(plan.rows()[static_cast<std::size_t>(Pass::caustics)].reason, "not wanted");
}

TEST(Plan, FollowsEachCauseAlone) {
    const auto changes = [](auto set) {
        Traits without = all_traits(), with = all_traits();
        set(without, false);
        set(with, true);
        const auto a = running(make_plan(with, {})), b = running(make_plan(without, {}));
        std::set<std::string> lost;
        for (const std::string& name : a)
            if (!b.contains(name)) lost.insert(name);
        EXPECT_EQ(a.size(), b.size() + lost.size());
        return lost;
    };
    using Names = std::set<std::string>;
    EXPECT_EQ(changes([](Traits& t, bool on) { t.has_glass = on; }), (Names{"glass"}));
    EXPECT_EQ(changes([](Traits& t, bool on) { t.has_mirrors = on; }), (Names{"mirrors"}));
    EXPECT_EQ(changes([](Traits& t, bool on) { t.has_edited_reflections = on; }), (Names{"edited reflections"}));
    EXPECT_EQ(changes([](Traits& t, bool on) { t.has_hair = on; }), (Names{"hair"}));
    EXPECT_EQ(changes([](Traits& t, bool on) { t.has_subsurface = on; }), (Names{"subsurface"}));
    EXPECT_EQ(changes([](Traits& t, bool on) { t.has_bodies = on; }), (Names{"refraction"}));
    EXPECT_EQ(changes([](Traits& t, bool on) { t.casts_caustics = on; }), (Names{"caustics"}));
    EXPECT_EQ(changes([](Traits& t, bool on) { t.has_narrow_lobes = on; }), (Names{"lobe rays"}));
    EXPECT_EQ(changes([](Traits& t, bool on) { t.has_textures = on; }), (Names{"textures"}));
    EXPECT_EQ(changes([](Traits& t, bool on) { t.has_normal_maps = on; }), (Names{"normal maps"}));
    EXPECT_EQ(changes([](Traits& t, bool on) { t.has_alpha_mask = t.has_alpha_blend = on; }), (Names{"alpha"}));
    EXPECT_EQ(changes([](Traits& t, bool on) { t.has_shining_sky = on; }), (Names{"sky background", "sky light"}));
    EXPECT_EQ(changes([](Traits& t, bool on) { t.has_punctual_lights = on; }), (Names{"punctual lights"}));
    EXPECT_EQ(changes([](Traits& t, bool on) { t.has_emissive_surfaces = on; }), (Names{"emissive surfaces"}));
    EXPECT_EQ(changes([](Traits& t, bool on) { t.has_glossy_surfaces = on; }), (Names{"glossy lobes"}));
    EXPECT_EQ(changes([](Traits& t, bool on) {
                  t.camera_moves = t.objects_move = t.objects_deform = t.lights_change = t.has_cuts = on;
              }),
              (Names{"shutter", "motion"}));
    EXPECT_EQ(changes([](Traits& t, bool on) { t.has_open_shutter = on; }), (Names{"shutter"}));
    EXPECT_EQ(changes([](Traits& t, bool on) { t.has_aperture = on; }), (Names{"lens"}));
}

}  // namespace
}  // namespace render2mpeg::test
