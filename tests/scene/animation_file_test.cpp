#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <glm/gtc/constants.hpp>
#include <string>

#include "core/error.h"
#include "scene/load.h"
#include "scene/pose/snapshot.h"
#include "scene/preparation/complete.h"

namespace render2mpeg::scene {
namespace {

namespace fs = std::filesystem;

/// A folder of its own with a film in it.
class AnimationFile : public ::testing::Test {
  protected:
    AnimationFile() {
        const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
        folder_ = fs::path(::testing::TempDir()) / (std::string("r2m_film_") + test->name());
        fs::remove_all(folder_);
        fs::create_directories(folder_);
    }
    ~AnimationFile() override { fs::remove_all(folder_); }

    fs::path write(const std::string& text, const std::string& name = "film.json") const {
        std::ofstream(folder_ / name) << text;
        return folder_ / name;
    }
    Animation film(const std::string& text) const { return load_as_is(write(text), {}); }

    /// The message of the error that this film ends in; empty if it is accepted.
    std::string complaint(const std::string& text) const {
        try {
            Animation animation = film(text);
            complete(animation);
        } catch (const core::Error& e) {
            return e.what();
        }
        return "";
    }
    void expect_complaint(const std::string& text, std::initializer_list<const char*> parts) const {
        const std::string said = complaint(text);
        for (const char* part : parts)
            EXPECT_NE(said.find(part), std::string::npos) << text << "\n  said: " << said << "\n  without: " << part;
        EXPECT_EQ(said.find('\n'), std::string::npos) << said;
        EXPECT_NE(said.find("film.json"), std::string::npos) << said;
    }

    fs::path folder_;
};

Snapshot frame_at(const Animation& film, double seconds) {
    return snapshot_at(film, std::llround(seconds * 25), {std::llround(seconds * 1000), 1000}, {320, 240, 1});
}

void expect_near(glm::vec3 a, glm::vec3 b, float tolerance) {
    EXPECT_NEAR(a.x, b.x, tolerance);
    EXPECT_NEAR(a.y, b.y, tolerance);
    EXPECT_NEAR(a.z, b.z, tolerance);
}

TEST_F(AnimationFile, NamesAnUnknownKeyItsPlaceAndTheNearestKnownOne) {
    expect_complaint(R"({"camra": {}})", {"\"camra\"", "did you mean \"camera\""});
    expect_complaint(R"({"camera": {"postion": [0,0,0]}})", {"camera:", "\"postion\"", "\"position\""});
    expect_complaint(R"({"camera": {"keys": [{"at": 0}, {"at": 1, "lookat": [0,0,0]}]}})",
                     {"camera.keys[1]", "\"lookat\"", "\"look_at\""});
    expect_complaint(R"({"objects": [{"shape": "boxx"}]})", {"objects[0].shape", "\"boxx\"", "\"box\""});
    expect_complaint(R"({"objects": [{"shape": "box", "radius": 1}]})", {"objects[0].radius", "box", "size"});
    expect_complaint(R"({"materials": {"a": {"roughnes": 1}}})", {"materials.a", "\"roughness\""});
    expect_complaint(R"({"lights": [{"kind": "point", "angle": 3}]})", {"lights[0].angle", "point"});
}

TEST_F(AnimationFile, NamesThePlaceOfWrongTypesAndRanges) {
    expect_complaint(R"({"camera": {"keys": [{"at": 0}, {"at": 1}, {"at": 2}, {"at": 3, "position": [1, 2]}]}})",
                     {"camera.keys[3].position", "a list of 3", "a list of 2"});
    expect_complaint(R"({"camera": {"position": [0, "one", 2]}})", {"camera.position[1]", "number", "\"one\""});
    expect_complaint(R"({"camera": {"fov": 190}})", {"camera.fov", "175", "190"});
    expect_complaint(R"({"camera": {"projection": "mercator"}})", {"camera.projection", "equirectangular", "vr180"});
    expect_complaint(R"({"camera": {"projection": "vr180", "f_stop": 2, "focus": 1}})", {"camera.f_stop", "no lens"});
    expect_complaint(R"({"camera": {"projection": "vr180", "height": 2}})", {"camera", "panorama"});
    expect_complaint(R"({"camera": {"projection": "equirectangular", "fov": 60}})",
                     {"camera", "`fov`", "`projection`"});
    expect_complaint(R"({"camera": {"projection": "equirectangular", "latitudes": [30, -30]}})",
                     {"camera.latitudes", "lower"});
    expect_complaint(R"({"camera": {"longitudes": [-90, 90]}})", {"camera.longitudes", "`projection`"});
    expect_complaint(R"({"camera": {"projection": "vr180", "longitudes": [-90, 90]}})",
                     {"camera.longitudes", "`equirectangular`"});
    expect_complaint(R"({"frames": 2.5})", {"frames", "whole number", "2.5"});
    expect_complaint(R"({"frames": [5, 2]})", {"frames[1]", "from 5"});
    expect_complaint(R"({"frame_rate": 260})", {"frame_rate", "29.97"});
    expect_complaint(R"({"materials": {"a": {"base_color": [1, 2, 0]}}})",
                     {"materials.a.base_color[1]", "from 0 to 1"});
    expect_complaint(R"({"materials": {"a": {"base_color": "#12345"}}})", {"materials.a.base_color", "#ff8000"});
    expect_complaint(R"({"objects": {}})", {"objects", "a list"});
    expect_complaint(R"([1])", {"an object in braces"});
    expect_complaint(R"({"exposure": "bright"})", {"exposure", "auto"});
    expect_complaint(R"({"objects": [{"shape": "sphere", "radius": 0}]})", {"objects[0].radius", "0"});
}

TEST_F(AnimationFile, RefusesWhatContradictsItself) {
    expect_complaint(R"({"camera": {"look_at": [0,0,0], "rotate": 3}})", {"camera", "look_at", "rotate"});
    expect_complaint(R"({"camera": {"position": [0,0,0], "keys": [{"at": 0, "position": [1,0,0]}]}})",
                     {"camera.position", "twice"});
    expect_complaint(R"({"camera": {"keys": [{"at": 1}, {"at": 1}]}})", {"camera.keys[1].at", "later"});
    expect_complaint(R"({"camera": {}, "cameras": {}})", {"camera"});
    expect_complaint(R"({"frames": 3, "seconds": 2})", {"seconds", "frames"});
    expect_complaint(R"({"frames": 3, "frames": 4})", {"\"frames\" twice"});
    expect_complaint(R"({"cameras": {"side": {}}, "shots": [{"at": 0, "camera": "sdie"}]})",
                     {"shots[0].camera", "\"sdie\"", "did you mean \"side\""});
    expect_complaint(R"({"cameras": {"a": {}}, "shots": [{"at": 1, "camera": "a"}]})", {"shots[0].at", "0"});
    expect_complaint(R"({"objects": [{"shape": "box", "material": "wite"}], "materials": {"white": {}}})",
                     {"objects[0].material", "\"wite\"", "\"white\""});
    expect_complaint(R"({"objects": [{"shape": "box"}], "materials": {"white": {}}})",
                     {"materials.white", "nothing has this material"});
    expect_complaint(R"({"change": {"chair": {"visible": false}}})", {"change.chair", "no object"});
    expect_complaint(
        R"({"objects": [{"shape": "box", "loop": true, "keys": [{"at": 0, "rotate": 0}, {"at": 1, "rotate": 9}]}]})",
        {"loop", "frames"});
    expect_complaint(R"({"objects": [{"shape": "torus", "radius": 1, "tube_radius": 1}]})",
                     {"objects[0]", "tube_radius"});
    expect_complaint(R"({"objects": [{"shape": "arch", "size": 0.5}]})", {"objects[0]", "opening"});
    expect_complaint(R"({"materials": {"a": {"hair": {"redness": 1}}}})", {"materials.a.hair.redness", "melanin"});
    for (const char* more : {R"("color": 0.5)", R"("melanin": 0.5)"})
        expect_complaint(R"({"materials": {"a": {"hair": {"absorption": 1, )" + std::string(more) + "}}}}",
                         {"materials.a.hair", "absorption", "color", "melanin"});
    expect_complaint(R"({"materials": {"a": {"subsurface": {"free_path": "#ff8000"}}}})",
                     {"materials.a.subsurface.free_path", "three"});
}

TEST_F(AnimationFile, RefusesFilesThatAreNoJsonOrTooLargeOrTooDeep) {
    expect_complaint("{\"frames\": ", {"line"});
    expect_complaint("", {"line"});
    expect_complaint("{\"exposure\": 1e999}", {"overflow", "1e999"});
    std::string deep = R"({"objects": )";
    for (int i = 0; i < 100000; ++i) deep += "[";
    expect_complaint(deep, {"deeper than 32"});
    expect_complaint("{\"title\": \"" + std::string(17 << 20, 'x') + "\"}", {"16 MiB"});
    EXPECT_THROW(load_as_is(folder_ / "missing.json", {}), core::Error);
}

TEST_F(AnimationFile, NeverLooksOutsideOfItsFolder) {
    fs::create_directories(folder_ / "inner");
    std::ofstream(folder_ / "outside.png") << "x";
    write(R"({"materials": {"a": {"texture": "../outside.png"}}, "objects": [{"shape": "box", "material": "a"}]})",
          "inner/film.json");
    try {
        load_as_is(folder_ / "inner" / "film.json", {});
        ADD_FAILURE() << "was accepted";
    } catch (const core::Error& e) {
        EXPECT_NE(std::string(e.what()).find("materials.a.texture"), std::string::npos) << e.what();
        EXPECT_NE(std::string(e.what()).find("outside of the film's own folder"), std::string::npos) << e.what();
    }
    expect_complaint(R"({"scene": "/etc/passwd"})", {"scene", "outside"});
    fs::create_symlink(folder_ / "outside.png", folder_ / "inner" / "link.png");
    write(R"({"sky": {"image": "link.png"}})", "inner/film.json");
    EXPECT_THROW(load_as_is(folder_ / "inner" / "film.json", {}), core::Error);
    expect_complaint(R"({"scene": "nothing.gltf"})", {"scene", "no file \"nothing.gltf\""});
}

TEST_F(AnimationFile, AcceptsItsFolderForTheFile) {
    write(R"({"frames": 3, "objects": [{"shape": "box"}]})");
    EXPECT_EQ(load_as_is(folder_, {}).last_frame, 2);
}

TEST_F(AnimationFile, AllowsCommentsAndSaysFormatRangeAndExposure) {
    const Animation a = film(R"({ // a comment
        "size": [320, 200], "frame_rate": "30000/1001", "frames": [10, 19], "exposure": 1.5 /* EV */,
        "display_aspect": "32:18" })");
    EXPECT_EQ(a.display_aspect, (core::Rational{16, 9}));
    EXPECT_EQ(a.size, glm::ivec2(320, 200));
    EXPECT_EQ(a.frame_rate, "29.97");
    EXPECT_EQ(a.first_frame, 10);
    EXPECT_EQ(a.last_frame, 19);
    EXPECT_EQ(a.exposure, 1.5f);
    EXPECT_FALSE(a.view);
    EXPECT_EQ(film(R"({"view": "filmic-high-contrast"})").view, (core::View{core::ViewName::filmic_high_contrast, 1}));
    EXPECT_EQ(film(R"({"view": {"name": "agx", "gamma": 1.5}})").view, (core::View{core::ViewName::agx, 1.5f}));
    expect_complaint(R"({"view": "filmc"})", {"view", "filmic"});
    EXPECT_FALSE(a.glare.shows());
    EXPECT_FALSE(a.fog.shows());
    EXPECT_FALSE(film(R"({"fog": "off"})").fog.shows());
    EXPECT_EQ(film(R"({"fog": 40})").fog, (core::Fog{40, glm::vec3(1), 0, 0, 0}));
    EXPECT_EQ(film(R"({"fog": {"visibility": 8, "color": 0, "anisotropy": 0.5, "height": -1, "falloff": 3}})").fog,
              (core::Fog{8, glm::vec3(0), 0.5f, -1, 3}));
    EXPECT_FALSE(film(R"({"fog": {"visibility": 8, "bounces": false}})").fog.bounces);
    expect_complaint(R"({"fog": {"visibility": 8, "color": [1, 1, 2]}})", {"color", "1"});
    expect_complaint(R"({"fog": {"visibility": 8, "height": 2}})", {"height", "falloff"});
    EXPECT_EQ(film(R"({"glare": "static"})").glare, (core::Glare{core::GlareKind::still, 0.1f, 0.5f, 0}));
    EXPECT_EQ(film(R"({"glare": {"kind": "temporal", "strength": 0.25, "size": 1, "seed": 3}})").glare,
              (core::Glare{core::GlareKind::temporal, 0.25f, 1, 3}));
    EXPECT_FALSE(film(R"({"glare": {"kind": "static", "strength": 0}})").glare.shows());
    expect_complaint(R"({"glare": {"kind": "static", "strength": -0.1}})", {"strength", "0.5"});
    EXPECT_EQ(film(R"({"grain": 0})").grain, 0);
    EXPECT_EQ(film(R"({"grain": 6400})").grain, 6400);
    expect_complaint(R"({"grain": 49})", {"grain", "50"});
    expect_complaint(R"({"grain": "fine"})", {"grain"});
    expect_complaint(R"({"view": {"name": "neutral", "gamma": 1.5}})", {"gamma", "Blender"});
    const Animation b = film(R"({"seconds": 2.4, "exposure": "auto"})");
    EXPECT_EQ(b.frame_rate, "25");
    EXPECT_EQ(b.last_frame, 59);
    EXPECT_FALSE(b.exposure);
    EXPECT_FALSE(b.display_aspect);
    expect_complaint(R"({"display_aspect": "16:0"})", {"display_aspect", "16:0", "16:9"});
}

TEST_F(AnimationFile, SaysWhetherGlassIsSolidWhereItIsClosed) {
    const auto thickness = [&](const std::string& key, const std::string& look) {
        return film("{" + key + R"("objects": [{"shape": "box", "material": {)" + look + "}}]}")
            .materials.front()
            .thickness;
    };
    const std::string closed = R"("closed_glass_is_solid": true, )", glass = R"("transmission": 1)";
    EXPECT_EQ(thickness(closed, glass), Thickness::solid_where_closed);
    EXPECT_EQ(thickness("", glass), Thickness::thin);
    EXPECT_EQ(thickness(R"("closed_glass_is_solid": false, )", glass), Thickness::thin);
    EXPECT_EQ(thickness(closed, glass + R"(, "solid": true)"), Thickness::solid);
    EXPECT_EQ(thickness(closed, R"("roughness": 0.5)"), Thickness::thin) << "it is no glass";
}

TEST_F(AnimationFile, MaterialsMayChangeWithTheAngleAndBeLookedThrough) {
    const Animation read = film(R"({
      "materials": { "m": { "base_color": 1, "emission": 2, "seen": false, "by_angle": {
        "base_color": { "other": [0.5, 0, 0], "share": [1, [0, 0.5, 1]] }, "coat": { "other": 0.25, "share": [0, 1, 1] },
        "emission": { "other": 9, "share": [0, 1] } } } },
      "objects": [{ "shape": "box", "material": "m" }] })");
    ASSERT_EQ(read.materials.size(), 1u);
    const Material& m = read.materials[0];
    EXPECT_FALSE(m.seen);
    ASSERT_EQ(m.by_angle.size(), 3u);
    ASSERT_NE(m.curve_of(AngledInput::coat), nullptr);
    EXPECT_EQ(m.curve_of(AngledInput::gloss), nullptr);
    EXPECT_EQ(m.curve_of(AngledInput::coat)->other.x, 0.25f);
    EXPECT_EQ(m.curve_of(AngledInput::base_color)->share_at(0), glm::vec3(1));
    EXPECT_EQ(m.curve_of(AngledInput::base_color)->share_at(1), glm::vec3(0, 0.5f, 1));
    EXPECT_EQ(m.curve_of(AngledInput::emission)->other, glm::vec3(9));
    expect_complaint(
        R"({ "materials": { "m": { "by_angle": { "coat": { "share": [0, 1] } } } }, "objects": [{ "shape": "box", "material": "m" }] })",
        {"by_angle.coat", "other"});
    expect_complaint(
        R"({ "materials": { "m": { "by_angle": { "coat": { "other": 0, "share": [1] } } } }, "objects": [{ "shape": "box", "material": "m" }] })",
        {"share"});
}

TEST_F(AnimationFile, CameraPathsHitTheirKeys) {
    for (const char* passage : {"smooth", "ease", "linear", "step"}) {
        Animation a = film(std::string(R"({"objects": [{"shape": "box"}], "camera": {"interpolation": ")") + passage +
                           R"(", "keys": [
            {"at": 0, "position": [0, 1, 5], "look_at": [0, 0, 0], "fov": 30}, {"at": 0.5, "position": [2, 1.5, 4], "look_at": [1, 0, 0], "fov": 60},
            {"at": 2, "position": [4, 1, -3], "look_at": [0, 1, 0], "fov": 45}]}})");
        complete(a);
        const glm::vec3 position[] = {{0, 1, 5}, {2, 1.5, 4}, {4, 1, -3}}, target[] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
        const double time[] = {0, 0.5, 2}, fov[] = {30, 60, 45};
        for (int k = 0; k < 3; ++k) {
            const Snapshot s = frame_at(a, time[k]);
            expect_near(s.camera.position(), position[k], 1e-5f);
            expect_near(s.camera.forward(), glm::normalize(target[k] - position[k]), 1e-5f);
            EXPECT_NEAR(s.camera.lens().vertical_fov, glm::radians(fov[k]), 1e-5);
        }
    }
}

TEST_F(AnimationFile, CamerasLookAtTheirTargetBetweenKeysToo) {
    Animation a = film(R"({"objects": [{"shape": "box"}], "camera": {"look_at": [0, 0.5, 0], "keys": [
        {"at": 0, "position": [5, 1, 0]}, {"at": 1, "position": [0, 2, 5]}, {"at": 2, "position": [-5, 1, 0]}, {"at": 3, "position": [0, 4, -5]}]}})");
    complete(a);
    double worst = 0;
    for (int k = 0; k <= 300; ++k) {
        const Snapshot s = frame_at(a, k / 100.0);
        const glm::vec3 wanted = glm::normalize(glm::vec3(0, 0.5f, 0) - s.camera.position());
        worst = std::max(worst, static_cast<double>(glm::length(s.camera.forward() - wanted)));
        // The horizon stays level.
        EXPECT_NEAR(s.camera.to_world()[0].y, 0, 1e-4);
    }
    EXPECT_LT(worst, 5e-5);
    EXPECT_GT(worst, 0.0);  // the keys of the rotation are finitely many
}

TEST_F(AnimationFile, SmoothPathsHaveNoKinkAndEasedOnesRestAtTheirKeys) {
    const auto speed = [&](const char* passage, double seconds) {
        Animation a =
            film(std::string(R"({"objects": [{"shape": "box", "interpolation": ")") + passage + R"(", "keys": [
            {"at": 0, "position": [0, 0, 0]}, {"at": 1, "position": [3, 0, 0]}, {"at": 2, "position": [4, 0, 0]}]}]})");
        complete(a);
        const auto x = [&](double t) { return static_cast<double>(frame_at(a, t).objects[0].to_world[3].x); };
        return (x(seconds + 0.005) - x(seconds - 0.005)) / 0.01;
    };
    EXPECT_NEAR(speed("smooth", 0.99), speed("smooth", 1.01), 0.15);
    EXPECT_NEAR(speed("smooth", 1), 2, 0.05);  // the mean of 3 and 1
    EXPECT_NEAR(speed("ease", 1), 0, 0.1);
    EXPECT_NEAR(speed("ease", 0.5), 4.5, 0.05);  // one and a half of the mean
    EXPECT_NEAR(speed("linear", 0.9), 3, 1e-3);
    EXPECT_NEAR(speed("linear", 1.1), 1, 1e-3);
    EXPECT_EQ(speed("step", 0.5), 0);
}

TEST_F(AnimationFile, SwitchesAreThrownAtTheirFrame) {
    Animation a = film(R"({"times": "frames", "frames": 300, "objects": [{"shape": "box", "loop": true, "keys":
        [{"at": 0, "visible": true}, {"at": 1, "visible": false}, {"at": 2, "visible": true}]}]})");
    complete(a);
    for (std::int64_t n = 0; n < 300; ++n)
        EXPECT_EQ(snapshot_at(a, n, {n, 25}, {64, 64, 1}).objects[0].present, n % 2 == 0) << n;
}

TEST_F(AnimationFile, WhatRestsBetweenTwoKeysDoesNotSwing) {
    Animation a = film(
        R"({"objects": [{"shape": "box", "keys": [{"at": 0, "position": [0, 0, 0]}, {"at": 1, "position": [1, 0, 0]},
        {"at": 1.5, "position": [2, 3, 0]}, {"at": 2, "position": [3, 0, 0]}, {"at": 3, "position": [4, 0, 0]}]}]})");
    complete(a);
    for (int k = 0; k <= 300; ++k) EXPECT_GE(frame_at(a, k / 100.0).objects[0].to_world[3].y, -1e-6);
    EXPECT_NEAR(frame_at(a, 1.25).objects[0].to_world[3].y, 1.5, 0.01);
}

TEST_F(AnimationFile, TurnsAreCountedNotTakenByTheShortWay) {
    Animation a = film(
        R"({"objects": [{"shape": "box", "interpolation": "linear", "keys": [{"at": 0, "rotate": 0}, {"at": 1, "rotate": 720}]}]})");
    complete(a);
    for (int k = 0; k <= 20; ++k) {
        const double turn = glm::two_pi<double>() * 2 * k / 20;
        const glm::vec3 x(frame_at(a, k / 20.0).objects[0].to_world[0]);
        expect_near(x, {std::cos(turn), 0, -std::sin(turn)}, 1e-4f);
    }
}

TEST_F(AnimationFile, RotationsArePitchYawAndRoll) {
    const Animation a =
        film(R"({"cameras": {"up": {"rotate": [90, 0, 0]}, "left": {"rotate": 90}, "rolled": {"rotate": [0, 0, 90]},
                                 "tilted": {"look_at": [0, 0, -1], "roll": 90}}})");
    const auto turned = [&](int camera, glm::dvec3 v) {
        return glm::vec3(a.nodes[static_cast<std::size_t>(a.cameras[static_cast<std::size_t>(camera)].node)].rotation *
                         v);
    };
    expect_near(turned(0, {0, 0, -1}), {0, 1, 0}, 1e-6f);
    expect_near(turned(1, {0, 0, -1}), {-1, 0, 0}, 1e-6f);
    expect_near(turned(2, {1, 0, 0}), {0, 1, 0}, 1e-6f);
    expect_near(turned(3, {0, 1, 0}), {1, 0, 0}, 1e-6f);  // clockwise as its holder sees it
}

TEST_F(AnimationFile, LoopsGoOnUntilTheFilmEndsAndBeginWhereTheyEnded) {
    Animation a = film(R"({"seconds": 4, "objects": [{"shape": "box", "loop": true, "interpolation": "linear",
        "keys": [{"at": 0, "position": [0, 0, 0], "rotate": 0}, {"at": 1, "position": [2, 0, 0], "rotate": 90}]}]})");
    complete(a);
    for (const double t : {0.5, 1.5, 2.25, 3.75}) {
        const glm::mat4 m = frame_at(a, t).objects[0].to_world;
        EXPECT_NEAR(m[3].x, 2 * t, 1e-4);
        EXPECT_NEAR(m[0].x, std::cos(glm::half_pi<double>() * t), 1e-4);
    }
    EXPECT_GE(a.duration, 4.0);
    EXPECT_LE(a.duration, 5.0);
}

TEST_F(AnimationFile, CutsShowAnotherCameraFromTheirFrameOn) {
    Animation a = film(R"({"times": "frames", "frames": 40, "objects": [{"shape": "box"}],
        "cameras": {"b": {"position": [0, 0, 9]}, "a": {"position": [0, 0, 5]}}, "shots": [{"at": 0, "camera": "a"}, {"at": 20, "camera": "b"}]})");
    complete(a);
    const auto shown = [&](std::int64_t frame) { return snapshot_at(a, frame, {frame, 25}, {320, 240, 1}); };
    EXPECT_EQ(shown(19).camera.position().z, 5);
    EXPECT_FALSE(shown(19).cut_before);
    EXPECT_EQ(shown(20).camera.position().z, 9);
    EXPECT_TRUE(shown(20).cut_before);
    EXPECT_EQ(a.cameras[0].name, "b");  // in the order of the file
}

TEST_F(AnimationFile, ChaptersBeginAtTheirFrames) {
    const Animation a = film(R"({"objects": [{"shape": "box"}], "seconds": 2, "frame_rate": "25",
        "chapters": [{"at": 0.4, "title": "One"}, {"at": 1, "title": "Two"}]})");
    ASSERT_EQ(a.chapters.size(), 2u);
    EXPECT_EQ(a.chapters[0].frame, 10);
    EXPECT_EQ(a.chapters[1].title, "Two");
    expect_complaint(R"({"chapters": [{"at": 1, "title": "One"}, {"at": 1, "title": "Two"}]})",
                     {"chapters[1].at", "a frame later"});
}

TEST_F(AnimationFile, ThingsAppearAndVanish) {
    Animation a = film(
        R"({"objects": [{"shape": "box", "keys": [{"at": 0, "visible": false}, {"at": 1, "visible": true}, {"at": 2, "visible": false}]},
                                       {"shape": "box", "visible": false}, {"shape": "box"}]})");
    complete(a);
    EXPECT_FALSE(frame_at(a, 0.96).objects[0].present);
    EXPECT_TRUE(frame_at(a, 1.0).objects[0].present);
    EXPECT_FALSE(frame_at(a, 2.0).objects[0].present);
    EXPECT_FALSE(frame_at(a, 0.5).objects[1].present);
    EXPECT_TRUE(frame_at(a, 0.5).objects[2].present);
}

}  // namespace
}  // namespace render2mpeg::scene
