#include "scene/gltf_refused.h"

// What is wrong beyond the bytes: graphs, keys, skins, references to other files, cameras, lights.
namespace render2mpeg::scene {
namespace {

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
