// The films in animations/ contain what they say that they isolate, and hold together as films.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>

#include "core/numeric.h"
#include "core/rational.h"
#include "scene/load.h"
#include "scene/pose/snapshot.h"
#include "scene/preparation/traits.h"
#include "tests/support/places.h"

namespace render2mpeg::scene {
namespace {

namespace fs = std::filesystem;

const fs::path folder = support::source_folder() / "animations";

/// Each film is read once.
const Animation& film(const std::string& name) {
    static std::map<std::string, Animation> films;
    const auto known = films.find(name);
    return known != films.end() ? known->second : films.emplace(name, load(folder / name / "film.json")).first->second;
}

Snapshot frame(const Animation& a, std::int64_t number) {
    return snapshot_at(a, number, core::time_of(number, core::frame_rate_from(*a.frame_rate)),
                       {a.size->x, a.size->y, 1});
}

class Animations : public ::testing::TestWithParam<const char*> {};

TEST_P(Animations, LoadWithoutANoteAndSayTheirFormat) {
    const Animation& a = film(GetParam());
    EXPECT_TRUE(a.notes.empty()) << a.notes.front();
    ASSERT_TRUE(a.size && a.frame_rate && a.last_frame);
    EXPECT_GE(*a.last_frame + 1, 36);
    EXPECT_LE(*a.last_frame + 1, 120);
    EXPECT_EQ(a.size->x % 16, 0);
    EXPECT_GT(a.objects.size(), 0u);
    const Traits traits = traits_of(a);
    EXPECT_TRUE(traits.has_surfaces && traits.has_diffuse_surfaces && traits.has_textures);
    EXPECT_TRUE(traits.has_punctual_lights || traits.has_emissive_surfaces || traits.has_shining_sky);
}

TEST_P(Animations, AreSoundAtEveryFrame) {
    const Animation& a = film(GetParam());
    for (std::int64_t n = 0; n <= *a.last_frame; n += 7) {
        const Snapshot s = frame(a, n);
        EXPECT_TRUE(core::is_finite(s.camera.to_world()));
        for (const ObjectState& object : s.objects) EXPECT_TRUE(core::is_finite(object.to_world));
        for (const LightState& light : s.lights) {
            EXPECT_TRUE(core::is_finite(light.position) && core::is_finite(light.intensity));
            EXPECT_GE(light.intensity.x, 0);
        }
        for (const float factor : s.emission_factor) EXPECT_GE(factor, 0);
        // The camera stands within its scene and sees the middle of what is there in front of it.
        EXPECT_TRUE(core::is_finite(s.camera.position()));
    }
}

TEST_P(Animations, SayInTwoLinesWhatTheyIsolate) {
    std::ifstream in(folder / GetParam() / "README.md");
    std::string line;
    int lines = 0;
    bool isolates = false;
    while (std::getline(in, line)) {
        ++lines;
        isolates = isolates || line.find("isolates") != std::string::npos;
    }
    EXPECT_EQ(lines, 2);
    EXPECT_TRUE(isolates);
}

INSTANTIATE_TEST_SUITE_P(All, Animations,
                         ::testing::Values("cornell", "colonnade", "many_lamps", "mirror_and_glass", "night_street",
                                           "ring_and_lens", "character", "still_room", "flash_cut", "wheel",
                                           "rack_focus", "aimed_reflection", "furry_walk", "all_around"),
                         [](const auto& chosen) { return std::string(chosen.param); });

TEST(AnimationsIsolate, FurryWalkMovesHairUnderASunAndASky) {
    const Traits t = traits_of(film("furry_walk"));
    EXPECT_TRUE(t.has_hair && t.objects_move && t.camera_moves && t.has_punctual_lights && t.has_shining_sky);
    EXPECT_FALSE(t.objects_deform || t.lights_change || t.has_emissive_surfaces || t.has_cuts || t.has_glass);
}

TEST(AnimationsIsolate, AllAroundRollsABallAcrossTheSeamOfAPanorama) {
    const Animation& a = film("all_around");
    EXPECT_TRUE(traits_of(a).objects_move);
    EXPECT_FALSE(traits_of(a).camera_moves);
    ASSERT_TRUE(a.cameras[0].is_panorama());
    const auto ball =
        std::find_if(a.objects.begin(), a.objects.end(), [](const Object& o) { return o.name == "ball"; });
    const auto place = [&](std::int64_t n) {
        const Snapshot s = frame(a, n);
        const glm::mat4& to_world = s.objects[static_cast<std::size_t>(ball - a.objects.begin())].to_world;
        return s.camera.project(glm::vec3(to_world[3]))->position;
    };
    EXPECT_LT(place(0).x, 0.2f * 640);
    EXPECT_GT(place(35).x, 0.8f * 640);
    const Camera camera = frame(a, 0).camera;
    for (std::int64_t n = 1; n <= 35; ++n)
        EXPECT_LT(glm::distance(camera.nearest_turn(place(n), place(n - 1)), place(n - 1)), 12.0f) << n;
}

TEST(AnimationsIsolate, CornellMovesBoxesUnderAPanelBeforeAStillCamera) {
    const Traits t = traits_of(film("cornell"));
    EXPECT_TRUE(t.objects_move && t.has_emissive_surfaces);
    EXPECT_FALSE(t.camera_moves || t.objects_deform || t.lights_change || t.has_punctual_lights || t.has_shining_sky ||
                 t.has_cuts);
    EXPECT_FALSE(t.has_mirrors || t.has_glass || t.has_glossy_surfaces);
    EXPECT_EQ(*film("cornell").size, glm::ivec2(512, 512));
    EXPECT_GE(*film("cornell").last_frame + 1, 48);

    // The boxes never leave the room, nor pass through each other.
    const Animation& a = film("cornell");
    for (std::int64_t n = 0; n <= *a.last_frame; ++n) {
        const Snapshot s = frame(a, n);
        std::vector<glm::vec3> middles;
        for (std::uint32_t o = 0; o < a.objects.size(); ++o) {
            if (a.objects[o].mobility != Mobility::rigid) continue;
            glm::vec3 low(1e9f), high(-1e9f);
            for (std::uint32_t t2 = 0; t2 < a.meshes[static_cast<std::size_t>(a.objects[o].mesh)].triangles.size();
                 ++t2) {
                const Triangle triangle = triangle_of(s, o, t2);
                for (const glm::vec3 p : {triangle.a, triangle.b, triangle.c}) {
                    low = glm::min(low, p);
                    high = glm::max(high, p);
                }
            }
            EXPECT_GT(low.x, -1.0f);
            EXPECT_LT(high.x, 1.0f);
            EXPECT_GE(low.y, -1e-5f);
            EXPECT_GT(low.z, -1.0f);
            middles.push_back(0.5f * (low + high));
        }
        ASSERT_EQ(middles.size(), 2u);
        // Half diagonals of their ground squares: 0.396 and 0.354.
        const glm::vec2 apart(middles[0].x - middles[1].x, middles[0].z - middles[1].z);
        EXPECT_GT(glm::length(apart), 0.6f) << "frame " << n;
    }
}

TEST(AnimationsIsolate, ColonnadeMovesNothingButTheCamera) {
    const Animation& a = film("colonnade");
    const Traits t = traits_of(a);
    EXPECT_TRUE(t.camera_moves && t.has_punctual_lights && t.has_shining_sky);
    EXPECT_FALSE(t.objects_move || t.objects_deform || t.lights_change || t.has_cuts || t.has_mirrors || t.has_glass);
    // The columns are instances: 26 shafts, one mesh.
    std::map<int, int> uses;
    for (const Object& object : a.objects) ++uses[object.mesh];
    int most = 0;
    for (const auto& [mesh, count] : uses) most = std::max(most, count);
    EXPECT_EQ(most, 26);
    // It is a walk: 13 m in 4 s, at eye height.
    const glm::vec3 from = frame(a, 0).camera.position(), to = frame(a, *a.last_frame).camera.position();
    EXPECT_NEAR(glm::length(to - from), 13, 1);
    EXPECT_NEAR(from.y, 1.65, 0.1);
}

TEST(AnimationsIsolate, ManyLampsHasTwoHundredLightsThatChange) {
    const Animation& a = film("many_lamps");
    const Traits t = traits_of(a);
    EXPECT_TRUE(t.has_punctual_lights && t.has_emissive_surfaces && t.lights_change && t.camera_moves);
    EXPECT_FALSE(t.objects_move || t.objects_deform || t.has_cuts);
    std::size_t panels = 0;
    for (const Object& object : a.objects)
        panels += a.materials[static_cast<std::size_t>(object.material)].emits() ? 1 : 0;
    EXPECT_EQ(a.lights.size() + panels, 200u);
}

TEST(AnimationsIsolate, MirrorAndGlassHasBothAndMotion) {
    const Traits t = traits_of(film("mirror_and_glass"));
    EXPECT_TRUE(t.has_mirrors && t.has_glass && t.has_glossy_surfaces && t.camera_moves && t.objects_move);
    EXPECT_FALSE(t.has_cuts || t.lights_change || t.objects_deform);
}

TEST(AnimationsIsolate, CharacterDeformsAndWalksForward) {
    const Animation& a = film("character");
    const Traits t = traits_of(a);
    EXPECT_TRUE(t.objects_deform && t.camera_moves);
    EXPECT_FALSE(t.objects_move || t.has_cuts || t.lights_change);
    ASSERT_EQ(a.skins.size(), 1u);
    EXPECT_EQ(a.skins[0].joints.size(), 16u);

    // The soles stay on the ground within 5 cm, the head at a man's height, and the body goes on by its speed.
    double mean_first = 0, mean_last = 0;
    for (std::int64_t n = 0; n <= *a.last_frame; ++n) {
        const Snapshot s = frame(a, n);
        double low = 1e9, high = -1e9, along = 0, count = 0;
        for (const DeformedMesh& mesh : s.deformed)
            for (const glm::vec3 p : mesh.positions) {
                low = std::min(low, static_cast<double>(p.y));
                high = std::max(high, static_cast<double>(p.y));
                along += p.z;
                count += 1;
            }
        ASSERT_GT(count, 1000);
        EXPECT_NEAR(low, 0, 0.05) << "frame " << n;
        EXPECT_GT(high, 1.45) << "frame " << n;
        EXPECT_LT(high, 1.9) << "frame " << n;
        (n == 0 ? mean_first : mean_last) = along / count;
    }
    EXPECT_NEAR((mean_last - mean_first) / 2.96, 1.25, 0.1);
}

TEST(AnimationsIsolate, InStillRoomNothingMovesAtAll) {
    const Animation& a = film("still_room");
    const Traits t = traits_of(a);
    EXPECT_FALSE(t.anything_moves());
    EXPECT_FALSE(t.has_cuts);
    EXPECT_EQ(a.duration, 0);
    for (const Object& object : a.objects) EXPECT_EQ(object.mobility, Mobility::still);
}

TEST(AnimationsIsolate, WheelTurnsBeforeACameraThatPansWithAnOpenShutter) {
    const Animation& a = film("wheel");
    const Traits t = traits_of(a);
    EXPECT_TRUE(t.shows_motion() && t.camera_moves && t.objects_move);
    EXPECT_FALSE(t.has_aperture);
    EXPECT_EQ(a.shutter.angle, 180);
}

TEST(AnimationsIsolate, AimedReflectionHasMirrorsThatAreToldWhatToShow) {
    const Animation& a = film("aimed_reflection");
    const Traits t = traits_of(a);
    EXPECT_TRUE(t.has_edited_reflections && t.edits_move && t.has_mirrors && t.camera_moves && t.objects_move);
    for (std::int64_t n = 0; n <= *a.last_frame; n += 7) {
        const Snapshot s = frame(a, n);
        for (const Bend& bend : s.bends->middle()) {
            EXPECT_EQ(bend.strength, 1) << n;
            EXPECT_GT(glm::length(bend.turn), 0.1) << n;  // by themselves they show something else
        }
    }
}

TEST(AnimationsIsolate, RackFocusPullsTheFocusOfAStillCamera) {
    const Animation& a = film("rack_focus");
    const Traits t = traits_of(a);
    EXPECT_TRUE(t.has_aperture);
    EXPECT_FALSE(t.anything_moves() || t.has_open_shutter);
    const Camera first = frame(a, 0).camera, last = frame(a, *a.last_frame).camera;
    EXPECT_FLOAT_EQ(first.lens().focus_distance, 1.15f);
    EXPECT_FLOAT_EQ(last.lens().focus_distance, 2.9f);
    // 50 mm at f/1.4.
    EXPECT_NEAR(first.lens().aperture_radius, 0.05f / 2.8f, 1e-4f);
    EXPECT_EQ(first.circle_of_confusion(1.15f), 0);
    EXPECT_GT(first.circle_of_confusion(2.9f), 8);
}

TEST(AnimationsIsolate, FlashCutHasOneCutAndLampsThatGoOnAndOff) {
    const Animation& a = film("flash_cut");
    const Traits t = traits_of(a);
    EXPECT_TRUE(t.has_cuts && t.lights_change);
    int cuts = 0, flashes = 0, dark = 0;
    for (std::int64_t n = 0; n <= *a.last_frame; ++n) {
        const Snapshot s = frame(a, n);
        cuts += s.cut_before ? 1 : 0;
        for (const LightState& light : s.lights)
            flashes += light.kind == LightKind::point && light.intensity.x > 0 ? 1 : 0;
        bool any_lamp_out = false;
        for (const float factor : s.emission_factor) any_lamp_out = any_lamp_out || factor == 0;
        dark += any_lamp_out ? 1 : 0;
    }
    EXPECT_EQ(cuts, 1);
    EXPECT_EQ(flashes, 4);
    EXPECT_EQ(dark, 8 + 2 + 18);  // 12..19, 21..22, 54..71
}

}  // namespace
}  // namespace render2mpeg::scene
