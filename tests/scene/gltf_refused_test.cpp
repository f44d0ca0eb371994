#include "scene/gltf_refused.h"

#include <ctime>

namespace render2mpeg::scene {
namespace {

TEST_F(GltfRefused, MissingEmptyAndForeignFiles) {
    EXPECT_NE(message(folder_ / "none.gltf").find("no such file"), std::string::npos);
    EXPECT_NE(message(folder_.path()), "");  // a folder that holds no film
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
    expect_refused([](GltfFile& f) { f.json["extensionsRequired"] = {"KHR_texture_basisu"}; }, {"KHR_texture_basisu"});
}

TEST_F(GltfRefused, CountsThatTheBufferDoesNotHold) {
    for (const double count : {4.0, 1e9, 4e9, 4503599627370496.0, 9e15}) {
        const std::clock_t start = std::clock();
        expect_refused([&](GltfFile& f) { f.json["accessors"][0]["count"] = static_cast<std::int64_t>(count); },
                       {"accessor 0", "mesh 0", "POSITION"});
        expect_refused(
            [&](GltfFile& f) {
                f.json["accessors"][0]["count"] = static_cast<std::int64_t>(count);
                if (count > 4) f.json["accessors"][0].erase("bufferView");
            },
            {"accessor 0"});
        // Nothing of that size is touched; a second of the processor would be a thousand times as long.
        EXPECT_LT(std::clock() - start, 10 * CLOCKS_PER_SEC);
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

}  // namespace
}  // namespace render2mpeg::scene
