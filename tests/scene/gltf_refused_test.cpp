#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <limits>

#include "core/error.h"
#include "scene/gltf_file.h"
#include "scene/load.h"
#include "support/program.h"

// Every way in which a file can be wrong ends in one line that names file, object and cause.
namespace render2mpeg::scene {
namespace {

using test::GltfFile;

class GltfRefused : public ::testing::Test {
  protected:
    /// What loading the file says; empty where it does not throw.
    std::string message(const std::filesystem::path& file) {
        try {
            load(file);
            return "";
        } catch (const core::Error& error) {
            return error.what();
        }
    }
    std::string message(const GltfFile& file) { return message(file.write(folder_ / "film.gltf")); }

    /// Breaks a good file and expects one line with the file's name and each of the words.
    void expect_refused(const std::function<void(GltfFile&)>& breaking, const std::vector<std::string>& words) {
        GltfFile file = GltfFile::triangle();
        breaking(file);
        expect_words(message(file), words);
    }
    static void expect_words(const std::string& line, const std::vector<std::string>& words) {
        EXPECT_EQ(line.find('\n'), std::string::npos) << line;
        EXPECT_NE(line.find("film.gl"), std::string::npos) << line;
        EXPECT_LT(line.size(), 500u) << line;
        for (const std::string& word : words)
            EXPECT_NE(line.find(word), std::string::npos) << line << "\nlacks: " << word;
    }
    static void add_animation(GltfFile& file, const std::vector<float>& times, const std::vector<float>& values,
                              const char* path = "translation", const char* type = "VEC3") {
        const int input = file.add_floats(times, "SCALAR"), output = file.add_floats(values, type);
        file.json["animations"] = {{{"samplers", {{{"input", input}, {"output", output}}}},
                                    {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", path}}}}}}}};
    }

    support::Folder folder_;
    static constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    static constexpr float inf = std::numeric_limits<float>::infinity();
};

TEST_F(GltfRefused, MissingEmptyAndForeignFiles) {
    EXPECT_NE(message(folder_ / "none.gltf").find("no such file"), std::string::npos);
    EXPECT_NE(message(folder_.path()).find("folder"), std::string::npos);
    expect_words(message(GltfFile::write_text(folder_ / "film.gltf", "")), {"empty"});
    expect_words(message(GltfFile::write_text(folder_ / "film.gltf", "hello")), {"not JSON"});
    expect_words(message(GltfFile::write_text(folder_ / "film.gltf", "[1]")), {"not an object"});
    expect_words(message(GltfFile::write_text(folder_ / "film.gltf", "{}")), {"no asset"});
    expect_words(message(GltfFile::write_text(folder_ / "film.gltf", "{\"a\": 1e999}")), {"not JSON"});
}

TEST_F(GltfRefused, OtherVersions) {
    expect_refused([](GltfFile& f) { f.json["asset"]["version"] = "1.0"; }, {"1.0", "2.0"});
    expect_refused([](GltfFile& f) { f.json["asset"]["minVersion"] = "2.1"; }, {"2.1"});
    expect_refused([](GltfFile& f) { f.json["asset"]["version"] = 2; }, {"not a string"});
}

TEST_F(GltfRefused, BinaryFilesCutAnywhere) {
    const GltfFile file = GltfFile::triangle();
    const std::string whole = support::contents(file.write_binary(folder_ / "film.glb"));
    for (std::size_t length = 1; length < whole.size(); length += 3)
        EXPECT_NE(message(GltfFile::write_text(folder_ / "film.glb", whole.substr(0, length))), "") << length;
    EXPECT_EQ(message(GltfFile::write_text(folder_ / "film.glb", whole)), "");
}

TEST_F(GltfRefused, TextFilesCutAnywhere) {
    const std::string whole = GltfFile::triangle().text();
    for (std::size_t length = 0; length < whole.size(); length += 7)
        EXPECT_NE(message(GltfFile::write_text(folder_ / "film.gltf", whole.substr(0, length))), "") << length;
}

TEST_F(GltfRefused, BracketsNestedBeyondAnyStack) {
    const std::size_t depth = 300000;
    const std::string text =
        "{\"asset\":{\"version\":\"2.0\"},\"extras\":" + std::string(depth, '[') + std::string(depth, ']') + "}";
    // Legal, and of no meaning: what matters is that the program survives.
    EXPECT_EQ(message(GltfFile::write_text(folder_ / "film.gltf", text)), "");
}

TEST_F(GltfRefused, RequiredExtensionsThatAreMissingHere) {
    expect_refused([](GltfFile& f) { f.json["extensionsRequired"] = {"KHR_draco_mesh_compression"}; },
                   {"KHR_draco_mesh_compression"});
}

TEST_F(GltfRefused, CountsThatTheBufferDoesNotHold) {
    for (const double count : {4.0, 1e9, 4e9, 4503599627370496.0, 9e15}) {
        const auto start = std::chrono::steady_clock::now();
        expect_refused([&](GltfFile& f) { f.json["accessors"][0]["count"] = static_cast<std::int64_t>(count); },
                       {"accessor 0", "mesh 0", "POSITION"});
        expect_refused(
            [&](GltfFile& f) {
                f.json["accessors"][0]["count"] = static_cast<std::int64_t>(count);
                if (count > 4) f.json["accessors"][0].erase("bufferView");
            },
            {"accessor 0"});
        // Nothing of that size is touched; a second would be a thousand times as long.
        EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
    }
    expect_refused([](GltfFile& f) { f.json["accessors"][0]["count"] = 0; }, {"accessor 0", "no elements"});
    expect_refused([](GltfFile& f) { f.json["accessors"][0]["count"] = -3; }, {"accessor 0", "count"});
    expect_refused([](GltfFile& f) { f.json["accessors"][0]["count"] = 1.5; }, {"count"});
    expect_refused([](GltfFile& f) { f.json["accessors"][0]["count"] = "3"; }, {"count", "not a number"});
}

TEST_F(GltfRefused, AccessorsThatLeaveTheirViewAndViewsThatLeaveTheirBuffer) {
    expect_refused([](GltfFile& f) { f.json["accessors"][0]["byteOffset"] = 4; }, {"accessor 0"});
    expect_refused([](GltfFile& f) { f.json["accessors"][0]["byteOffset"] = 9007199254740991; }, {"accessor 0"});
    expect_refused([](GltfFile& f) { f.json["accessors"][0]["bufferView"] = 1; }, {"buffer view 1", "there is 1"});
    expect_refused([](GltfFile& f) { f.json["bufferViews"][0]["byteOffset"] = 8; },
                   {"buffer view 0", "leaves its buffer"});
    expect_refused([](GltfFile& f) { f.json["bufferViews"][0]["byteLength"] = 9007199254740991; },
                   {"leaves its buffer"});
    expect_refused([](GltfFile& f) { f.json["bufferViews"][0]["byteStride"] = 8; }, {"overlap"});
    expect_refused([](GltfFile& f) { f.json["bufferViews"][0]["byteStride"] = 1000; }, {"stride"});
    expect_refused([](GltfFile& f) { f.json["bufferViews"][0]["buffer"] = 7; }, {"buffer 7"});
    expect_refused(
        [](GltfFile& f) {
            f.json["buffers"] = {{{"byteLength", 100}, {"uri", "data:;base64,AAAA"}}};
        },
        {"100 bytes and has 3"});
    expect_refused(
        [](GltfFile& f) {
            f.json["buffers"] = {{{"byteLength", 36}, {"uri", "data:;base64,A*=="}}};
        },
        {"base64"});
    expect_refused([](GltfFile& f) { f.json["buffers"] = {{{"byteLength", 36}}}; }, {"buffer 0", "no URI"});
    expect_refused([](GltfFile& f) { f.json["buffers"] = {{{"byteLength", 36}, {"uri", "gone.bin"}}}; }, {});
}

TEST_F(GltfRefused, AccessorsOfTheWrongType) {
    expect_refused([](GltfFile& f) { f.json["accessors"][0]["type"] = "VEC2"; }, {"accessor 0", "VEC2"});
    expect_refused([](GltfFile& f) { f.json["accessors"][0]["type"] = "VEC9"; }, {"VEC9"});
    expect_refused([](GltfFile& f) { f.json["accessors"][0]["componentType"] = 5124; }, {"5124"});
    expect_refused([](GltfFile& f) { f.json["accessors"][0]["normalized"] = true; }, {"normalised"});
    expect_refused([](GltfFile& f) { f.primitive()["indices"] = 0; }, {"indices"});
    expect_refused([](GltfFile& f) { f.primitive()["indices"] = f.add_floats({0, 1, 2}, "SCALAR"); }, {"unsigned"});
}

TEST_F(GltfRefused, IndicesOutOfRange) {
    expect_refused(
        [](GltfFile& f) {
            f.primitive()["indices"] = f.add_accessor(std::vector<std::uint16_t>{0, 1, 3}, GltfFile::uint16, "SCALAR");
        },
        {"mesh 0, primitive 0", "index 3 at position 2", "3 vertices"});
    expect_refused(
        [](GltfFile& f) {
            f.primitive()["indices"] =
                f.add_accessor(std::vector<std::uint32_t>{0, 1, 0xffffffffu}, GltfFile::uint32, "SCALAR");
        },
        {"4294967295"});
    expect_refused(
        [](GltfFile& f) {
            f.primitive()["indices"] = f.add_accessor(std::vector<std::uint8_t>{0, 1, 2, 0}, GltfFile::uint8, "SCALAR");
        },
        {"4 corners"});
    expect_refused([](GltfFile& f) { f.primitive()["attributes"]["POSITION"] = 9; }, {"accessor 9", "mesh 0"});
    expect_refused([](GltfFile& f) { f.primitive()["material"] = 0; }, {"material 0", "there are 0"});
    expect_refused([](GltfFile& f) { f.primitive()["mode"] = 7; }, {"mode 7"});
    expect_refused([](GltfFile& f) { f.json["nodes"][0]["mesh"] = 1; }, {"node 0 \"thing\"", "mesh 1"});
    expect_refused([](GltfFile& f) { f.json["nodes"][0]["mesh"] = -1; }, {"not an index"});
    expect_refused([](GltfFile& f) { f.json["scene"] = 3; }, {"scene 3"});
    expect_refused([](GltfFile& f) { f.json["scenes"][0]["nodes"] = {5}; }, {"node 5"});
}

TEST_F(GltfRefused, SparseAccessorsThatReplaceWhatIsNotThere) {
    const auto sparse = [](GltfFile& f, std::uint16_t index, int count) {
        const int indices = f.add_view(std::vector<std::uint16_t>{index, index}),
                  values = f.add_view(std::vector<float>(6));
        f.json["accessors"][0]["sparse"] = {{"count", count},
                                            {"indices", {{"bufferView", indices}, {"componentType", GltfFile::uint16}}},
                                            {"values", {{"bufferView", values}}}};
    };
    expect_refused([&](GltfFile& f) { sparse(f, 3, 1); }, {"index 3", "3 elements"});
    expect_refused([&](GltfFile& f) { sparse(f, 0, 3); }, {"sparse"});
    expect_refused([&](GltfFile& f) { sparse(f, 0, 1000000000); }, {"1000000000"});
}

TEST_F(GltfRefused, NodeGraphsThatAreNoForest) {
    expect_refused(
        [](GltfFile& f) {
            f.json["nodes"] = {{{"children", {1}}}, {{"children", {2}}}, {{"children", {1}}}};
        },
        {"two parents"});
    expect_refused(
        [](GltfFile& f) {
            f.json["nodes"] = {{{"children", {1}}, {"name", "a"}}, {{"children", {0}}}};
        },
        {"cycle", "node"});
    expect_refused([](GltfFile& f) { f.json["nodes"][0]["children"] = {0}; }, {"cycle", "own child"});
    expect_refused([](GltfFile& f) { f.json["nodes"][0]["children"] = {1}; }, {"node 1", "there is 1"});
    expect_refused([](GltfFile& f) { f.json["nodes"][0]["children"] = 1; }, {"not an array"});
}

TEST_F(GltfRefused, TransformsWithoutMeaning) {
    expect_refused([](GltfFile& f) { f.json["nodes"][0]["translation"] = {1, 2}; }, {"2 numbers instead of 3"});
    expect_refused([](GltfFile& f) { f.json["nodes"][0]["matrix"] = {1, 2, 3}; }, {"16"});
    expect_refused([](GltfFile& f) { f.json["nodes"][0]["scale"] = {1, "x", 1}; }, {"not a number"});
    expect_refused([](GltfFile& f) { f.json["nodes"][0]["scale"] = {1, 1e300, 1}; }, {"too large"});
}

TEST_F(GltfRefused, KeysThatAreNotFiniteOrFall) {
    expect_refused(
        [](GltfFile& f) {
            add_animation(f, {0, 1}, {0, 0, 0, nan, 0, 0});
        },
        {"output", "element 1", "not finite"});
    expect_refused(
        [](GltfFile& f) {
            add_animation(f, {0, inf}, {0, 0, 0, 1, 0, 0});
        },
        {"input", "element 1", "not finite"});
    expect_refused(
        [](GltfFile& f) {
            add_animation(f, {0, 2, 1}, {0, 0, 0, 1, 0, 0, 2, 0, 0});
        },
        {"node 0 \"thing\"", "key 2", "before"});
    expect_refused([](GltfFile& f) { add_animation(f, {0, 1}, {0, 0, 0}); }, {"output", "1 element where 2"});
    expect_refused([](GltfFile& f) { add_animation(f, {0, 1}, {0, 0, 0, 1, 0, 0}, "rotation"); }, {"VEC3"});
    expect_refused(
        [](GltfFile& f) {
            add_animation(f, {0, 1}, {0, 0, 0, 1, 0, 0});
            f.json["animations"][0]["channels"][0]["sampler"] = 1;
        },
        {"sampler 1"});
    expect_refused(
        [](GltfFile& f) {
            add_animation(f, {0, 1}, {0, 0, 0, 1, 0, 0});
            f.json["animations"][0]["channels"][0]["target"]["node"] = 4;
        },
        {"node 4"});
    expect_refused(
        [](GltfFile& f) {
            f.json["nodes"][0]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
            add_animation(f, {0, 1}, {0, 0, 0, 1, 0, 0});
        },
        {"matrix"});
}

TEST_F(GltfRefused, SkinsThatDoNotFit) {
    const auto skinned = [](GltfFile& f, std::uint8_t joint) {
        f.primitive()["attributes"]["JOINTS_0"] =
            f.add_accessor(std::vector<std::uint8_t>(12, joint), GltfFile::uint8, "VEC4");
        f.primitive()["attributes"]["WEIGHTS_0"] = f.add_floats({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4");
        f.json["skins"] = {{{"joints", {0}}}};
        f.json["nodes"][0]["skin"] = 0;
    };
    expect_refused([&](GltfFile& f) { skinned(f, 1); }, {"joint 1", "there is 1"});
    expect_refused(
        [&](GltfFile& f) {
            skinned(f, 0);
            f.json["skins"][0]["inverseBindMatrices"] = f.add_floats(std::vector<float>(16, nan), "MAT4");
        },
        {"inverseBindMatrices", "not finite"});
    expect_refused(
        [&](GltfFile& f) {
            skinned(f, 0);
            f.json["skins"][0]["joints"] = {0, 0};
            f.json["skins"][0]["inverseBindMatrices"] = f.add_floats(std::vector<float>(16, 1), "MAT4");
        },
        {"1 inverse bind matrices for 2 joints"});
    expect_refused(
        [&](GltfFile& f) {
            skinned(f, 0);
            f.primitive()["attributes"].erase("WEIGHTS_0");
        },
        {"joints without weights"});
}

TEST_F(GltfRefused, UrisThatLeaveTheScenesFolder) {
    for (const char* uri : {"../film.bin", "a/../../film.bin", "%2e%2e/film.bin", "/etc/passwd", "file:///etc/passwd",
                            "http://example.org/a.bin", "C:/film.bin", "..\\film.bin", "\\film.bin"}) {
        expect_refused(
            [&](GltfFile& f) {
                f.json["buffers"] = {{{"byteLength", 36}, {"uri", uri}}};
            },
            {"buffer 0", "URI"});
        expect_refused(
            [&](GltfFile& f) {
                f.json["images"] = {{{"uri", uri}}};
                f.json["textures"] = {{{"source", 0}}};
                f.json["materials"] = {{{"emissiveTexture", {{"index", 0}}}}};
            },
            {"image 0", "URI"});
    }
    // A link within the folder can lead out of it, too.
    std::filesystem::create_symlink("/etc", folder_ / "out");
    expect_refused(
        [&](GltfFile& f) {
            f.json["buffers"] = {{{"byteLength", 36}, {"uri", "out/passwd"}}};
        },
        {"leaves the scene's folder"});
}

TEST_F(GltfRefused, CamerasAndLightsWithoutMeaning) {
    const auto camera = [](GltfFile& f, const nlohmann::json& json) {
        f.json["cameras"] = {json};
        f.json["nodes"][0]["camera"] = 0;
    };
    expect_refused(
        [&](GltfFile& f) {
            camera(f, {{"type", "perspective"}, {"perspective", {{"yfov", 0}, {"znear", 1}}}});
        },
        {"camera 0", "field of view"});
    expect_refused(
        [&](GltfFile& f) {
            camera(f, {{"type", "perspective"}, {"perspective", {{"yfov", 3.2}, {"znear", 1}}}});
        },
        {"field of view"});
    expect_refused(
        [&](GltfFile& f) {
            camera(f,
                   {{"type", "orthographic"}, {"orthographic", {{"ymag", 0}, {"xmag", 0}, {"zfar", 9}, {"znear", 0}}}});
        },
        {"magnification"});
    expect_refused(
        [&](GltfFile& f) {
            camera(f, {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 5}, {"zfar", 2}}}});
        },
        {"far"});
    expect_refused([&](GltfFile& f) { camera(f, {{"type", "fisheye"}}); }, {"fisheye"});
    expect_refused([&](GltfFile& f) { camera(f, {{"type", "perspective"}}); }, {"perspective"});
    const auto light = [](GltfFile& f, const nlohmann::json& json) {
        f.json["extensions"] = {{"KHR_lights_punctual", {{"lights", {json}}}}};
        f.json["nodes"][0]["extensions"] = {{"KHR_lights_punctual", {{"light", 0}}}};
    };
    expect_refused([&](GltfFile& f) { light(f, {{"type", "point"}, {"intensity", -1}}); }, {"light 0", "intensity"});
    expect_refused(
        [&](GltfFile& f) {
            light(f, {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.6}, {"outerConeAngle", 0.5}}}});
        },
        {"cone"});
    expect_refused([&](GltfFile& f) { light(f, {{"type", "area"}}); }, {"area"});
    expect_refused(
        [&](GltfFile& f) {
            light(f, {{"type", "point"}});
            f.json["nodes"][0]["extensions"] = {{"KHR_lights_punctual", {{"light", 1}}}};
        },
        {"light 1"});
}

TEST_F(GltfRefused, NamesWithLineEndsStayOnOneLine) {
    expect_refused(
        [](GltfFile& f) {
            f.json["nodes"][0]["name"] = "a\nb\x1b[31m" + std::string(500, 'x');
            f.json["nodes"][0]["mesh"] = 1;
        },
        {"node 0 \"a?b?[31m"});
}

}  // namespace
}  // namespace render2mpeg::scene
