#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "scene/gltf_file.h"
#include "scene/load.h"
#include "support/program.h"

/// What Blender's exporter does and leaves out, and what keys tell of frames.
namespace render2mpeg::scene {
namespace {

using test::GltfFile;

constexpr const char* blender_34 = "Khronos glTF Blender I/O v3.4.50";

/// A triangle with a sun and a point of these intensities.
GltfFile lit(const std::string& generator, double sun, double point) {
    GltfFile file = GltfFile::triangle();
    file.json["asset"]["generator"] = generator;
    file.json["extensionsUsed"] = {"KHR_lights_punctual"};
    file.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "directional"}, {"intensity", sun}},
                                                                {{"type", "point"}, {"intensity", point}}};
    for (int light : {0, 1}) {
        const int node = file.append("nodes", {{"extensions", {{"KHR_lights_punctual", {{"light", light}}}}}});
        file.json["scenes"][0]["nodes"].push_back(node);
    }
    return file;
}

Animation loaded(const GltfFile& file) {
    const support::Folder folder;
    return load(file.write(folder / "film.gltf"));
}

bool notes_say(const Animation& animation, const std::string& words) {
    return std::any_of(animation.notes.begin(), animation.notes.end(),
                       [&](const std::string& note) { return note.find(words) != std::string::npos; });
}

TEST(BlendersExporter, LampsInCandelaComeInWattsAgain) {
    const Animation film = loaded(lit(blender_34, 2 * 683, 5435.141306588225));
    ASSERT_EQ(film.lights.size(), 2u);
    EXPECT_FLOAT_EQ(film.lights[0].intensity, 2);
    EXPECT_NEAR(film.lights[1].intensity, 100 / (4 * 3.14159265), 1e-4) << "a lamp of 100 W";
    EXPECT_TRUE(notes_say(film, "divided by 683"));
}

TEST(BlendersExporter, LampsInOtherUnitsStayAsTheyAre) {
    for (const Animation& film :
         {loaded(lit(blender_34, 2, 7.957747)), loaded(lit("Khronos glTF Blender I/O v3.3.27", 1366, 5435)),
          loaded(lit("another program", 1366, 5435))}) {
        EXPECT_FALSE(notes_say(film, "683"));
        EXPECT_GE(film.lights[0].intensity, 2);
    }
}

TEST(BlendersExporter, TellsWhichBoxesWereNotTicked) {
    GltfFile file = GltfFile::triangle();
    EXPECT_FALSE(notes_say(loaded(file), "ticked"));
    file.json["asset"]["generator"] = blender_34;
    EXPECT_TRUE(notes_say(loaded(file), "Include > Cameras"));
    EXPECT_TRUE(notes_say(loaded(file), "Include > Punctual Lights"));
    EXPECT_FALSE(notes_say(loaded(lit(blender_34, 2, 8)), "Punctual Lights"));
}

Animation moving(const std::vector<float>& times) {
    GltfFile file = GltfFile::triangle();
    std::vector<float> places;
    for (const float time : times) places.insert(places.end(), {time, 0, 0});
    const int input = file.add_floats(times, "SCALAR"), output = file.add_floats(places, "VEC3");
    file.json["animations"] = {{{"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}},
                                {"samplers", {{{"input", input}, {"output", output}}}}}};
    return loaded(file);
}

std::vector<float> frames(double rate, int first, int count, int step = 1) {
    std::vector<float> times;
    for (int k = 0; k < count; ++k) times.push_back(static_cast<float>((first + step * k) / rate));
    return times;
}

TEST(KeysOfGltf, SuggestTheFilmsRate) {
    EXPECT_EQ(moving(frames(24, 1, 250)).frame_rate, "24");
    EXPECT_EQ(moving(frames(30, 0, 10000)).frame_rate, "30");
    EXPECT_EQ(moving(frames(60, 0, 100)).frame_rate, "60");
    EXPECT_EQ(moving(frames(24000.0 / 1001, 0, 500)).frame_rate, "23.976");
}

TEST(KeysOfGltf, SuggestNothingWhereTheyLieOnNoRateOrOnMany) {
    EXPECT_FALSE(moving({0, 1, 2, 3, 4}).frame_rate) << "whole seconds";
    EXPECT_FALSE(moving(frames(6, 0, 30)).frame_rate) << "of 24 or of 30";
    EXPECT_FALSE(moving({0, 0.123f, 0.271f, 0.314f, 0.99f}).frame_rate);
    EXPECT_FALSE(moving(frames(25, 0, 30)).frame_rate) << "25 is the default";
    EXPECT_FALSE(moving({0, 1.0f / 24}).frame_rate) << "too few";
}

}  // namespace
}  // namespace render2mpeg::scene
