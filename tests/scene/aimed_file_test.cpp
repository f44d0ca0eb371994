// `reflections` of animation files: what is read, and what is refused at the door.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "core/error.h"
#include "scene/load.h"
#include "scene/pose/pose.h"
#include "scene/pose/snapshot.h"
#include "scene/preparation/traits.h"

namespace render2mpeg::scene {
namespace {

namespace fs = std::filesystem;

/// A film of a mirror with these words beside its shape, and a box.
Animation aimed_film(const std::string& mirror, const std::string& more = "") {
    const fs::path file = fs::path(::testing::TempDir()) / "r2m_aimed_film.json";
    std::ofstream(file) << R"({"seconds": 2, "camera": {"position": [0, 0, 5]}, "sky": 1, "objects": [
        {"name": "box", "shape": "box", "size": 2, "position": [3, 0, 0], "keys": [{"at": 0, "rotate": 0}, {"at": 2, "rotate": 90}]},
        {"name": "mirror", "shape": "quad", "size": 2, "material": {"metallic": 1, "roughness": 0}, )"
                        << mirror << "}]" << more << "}";
    return load(file);
}

std::string refusal(const std::string& mirror, const std::string& more = "") {
    try {
        aimed_film(mirror, more);
        return "nothing";
    } catch (const core::Error& e) {
        return e.what();
    }
}

glm::dvec3 place_of(const Animation& film, int node, double seconds) {
    return glm::dvec3(pose_at(film, seconds).world_of(node)[3]);
}

TEST(AimedFile, SaysWhereMirrorsAreEditedAndHowThatMoves) {
    const Animation film = aimed_film(
        R"("interpolation": "linear", "position": [0, 1, 0], "reflections": [{"at": [0.5, 0, 0], "see": "box", "radius": 0.4}, {"see": [0, 9, 9], "border": 0.1}],
           "keys": [{"at": 0, "reflections": [{}, {"at": [-0.5, 0, 0], "radius": 0.2}]}, {"at": 2, "reflections": [{}, {"at": [-0.5, 0.5, 0], "radius": 0.4}]}])");
    ASSERT_EQ(film.reflections.size(), 2u);
    const Reflection &a = film.reflections[0], &b = film.reflections[1];
    EXPECT_EQ(place_of(film, a.at, 0), glm::dvec3(0.5, 1, 0));  // in the mirror's space
    EXPECT_EQ(place_of(film, a.see, 0), glm::dvec3(3, 1, 0));   // in the middle of the box, with which it turns
    EXPECT_EQ(a.border, 0.4f);                                  // as wide as the radius
    EXPECT_EQ(place_of(film, b.at, 1), glm::dvec3(-0.5, 1.25, 0));
    EXPECT_EQ(place_of(film, b.see, 1), glm::dvec3(0, 9, 9));
    EXPECT_NEAR(pose_at(film, 1).reflection_radius[1], 0.3f, 1e-6);
    const Traits traits = traits_of(film);
    EXPECT_TRUE(traits.has_edited_reflections && traits.edits_move && traits.anything_moves());
    EXPECT_FALSE(traits_of(aimed_film(R"("visible": true)")).has_edited_reflections);
    // Every copy has its own.
    EXPECT_EQ(
        aimed_film(
            R"("reflections": [{"at": [0, 0, 0], "see": [1, 2, 3], "radius": 1}], "repeat": {"count": [3, 1, 1], "step": [3, 0, 0]})")
            .reflections.size(),
        3u);
    // What a scene or the film has is changed by name.
    EXPECT_EQ(aimed_film(R"("visible": true)", R"(, "change": {})").reflections.size(), 0u);
}

TEST(AimedFile, IsRefusedInOneLineThatNamesObjectAndCause) {
    const auto edit = [](const std::string& words) { return R"("reflections": [)" + words + "]"; };
    const std::pair<std::string, std::string> all[] = {
        {edit(R"({"at": [0, 0, 0], "see": [1, 1, 1], "radius": 0})"), "objects[1].reflections[0].radius"},
        {edit(R"({"at": [0, 0, 0], "see": [1, 1, 1]})"), R"(objects[1].reflections[0]: lacks "radius")"},
        {edit(R"({"see": [1, 1, 1], "radius": 1})"), R"(lacks "at")"},
        {edit(R"({"at": [0, 0, 0], "radius": 1})"), R"(lacks "see")"},
        {edit(R"({"at": [0, 0, 0], "see": "bax", "radius": 1})"), R"(no object "bax"; did you mean "box"?)"},
        {edit(R"({"at": [0, 0, 0], "look": 1})"), "objects[1].reflections[0]"},
        {edit(R"({"at": [0, 0, 0], "see": [0, 0, 0], "radius": 1})"),
         R"(reflection 0 of "mirror": what is to be seen lies on the point of the mirror itself)"},
        {edit(R"({"at": [0, 0, 7], "see": [0, 1, 2], "radius": 1})"),
         R"(reflection 0 of "mirror": its point lies 7 from the surface, farther than its radius of 1)"},
        {edit(R"({"at": [0, 0, 0], "see": [0, 1, 2], "radius": 1}, {"at": [0, 0, 0], "see": [0, 2, 1], "radius": 1})"),
         R"(reflection 1 of "mirror": its point is that of reflection 0)"},
    };
    for (const auto& [words, cause] : all) {
        const std::string said = refusal(words);
        EXPECT_NE(said.find(cause), std::string::npos) << words << "\n" << said;
        EXPECT_NE(said.find("r2m_aimed_film.json"), std::string::npos) << said;
        EXPECT_EQ(said.find('\n'), std::string::npos) << said;
    }
    EXPECT_NE(
        refusal(R"("visible": true}, {"shape": "group", "parts": [{"shape": "box"}], "reflections": [])").find("parts"),
        std::string::npos);
    for (const char* thing :
         {R"("shape": "quad")",
          R"("shape": "strands", "strands": [[[0, 0, 0], [0, 1, 0]]], "material": {"metallic": 1})"})
        EXPECT_NE(
            refusal(
                R"("visible": true}, {"name": "wall", "reflections": [{"at": [0, 0, 0], "see": "box", "radius": 1}], )" +
                std::string(thing))
                .find(R"(reflection 0 of "wall": nothing there has a surface that mirrors)"),
            std::string::npos)
            << thing;
    std::string many;
    for (int k = 0; k < 65; ++k)
        many += std::string(k > 0 ? "," : "") + R"({"at": [0, 0, 0], "see": [1, 1, 1], "radius": 1})";
    EXPECT_NE(refusal(edit(many)).find("reflections"), std::string::npos);
}

}  // namespace
}  // namespace render2mpeg::scene
