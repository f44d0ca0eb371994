#include "checks/layers.h"
#include "tests/support/places.h"

#include <gtest/gtest.h>

namespace render2mpeg::checks {
namespace {

std::vector<Finding> breaches_in(const std::string& path, const std::string& text) {
    return layer_breaches({make_file(path, text)});
}

TEST(Layers, HoldInThisTree) {
    const auto files = read_tree(support::source_folder());
    ASSERT_GT(files.size(), 50u);
    const auto findings = layer_breaches(files);
    EXPECT_TRUE(findings.empty()) << list_of(findings);
}

TEST(LayerCheck, FindsEachOfTheThreeThatMayNotKnowEachOther) {
    const std::pair<const char*, const char*> arrows[] = {
        {"src/renderer/a.cpp", "perceptual/display.h"}, {"src/renderer/a.cpp", "encoder/encoder.h"},
        {"perceptual/a.cpp", "renderer/renderer.h"},    {"perceptual/a.h", "encoder/encoder.h"},
        {"encoder/mpeg2/a.cpp", "renderer/renderer.h"}, {"encoder/av/a.cpp", "perceptual/metrics.h"},
    };
    for (const auto& [path, header] : arrows) {
        const auto findings = breaches_in(path, "#pragma once\n#include \"" + std::string(header) + "\"\n");
        ASSERT_EQ(findings.size(), 1u) << path << " " << header;
        EXPECT_EQ(findings[0].line, 2);
    }
}

TEST(LayerCheck, FindsWhatLowerPartsMayNotKnow) {
    EXPECT_EQ(breaches_in("src/scene/a.cpp", "#include \"image/image.h\"\n").size(), 1u);
    EXPECT_EQ(breaches_in("src/image/a.cpp", "#include \"parallel/loops.h\"\n").size(), 1u);
    EXPECT_EQ(breaches_in("src/core/a.h", "#include \"scene/mesh.h\"\n").size(), 1u);
    EXPECT_EQ(breaches_in("src/renderer/a.cpp", "#include \"app/options.h\"\n").size(), 1u);
    EXPECT_EQ(breaches_in("src/core/a.h", "#include <fmt/core.h>\n").size(), 1u);
}

TEST(LayerCheck, FindsHeadersNotSpelledFromARoot) {
    EXPECT_EQ(breaches_in("src/core/a.cpp", "#include \"plane.h\"\n").size(), 1u);
    EXPECT_EQ(breaches_in("src/core/a.cpp", "#include \"../scene/mesh.h\"\n").size(), 1u);
}

TEST(LayerCheck, FindsLibrariesOutsideTheirFolder) {
    const std::pair<const char*, const char*> strays[] = {
        {"src/app/a.cpp", "embree3/rtcore.h"},        {"src/scene/a.cpp", "OpenImageIO/imageio.h"},
        {"src/app/a.cpp", "OpenEXR/ImfHeader.h"},     {"encoder/mpeg2/a.cpp", "libavcodec/avcodec.h"},
        {"src/renderer/a.cpp", "tbb/parallel_for.h"}, {"src/image/a.cpp", "tiny_gltf.h"},
        {"src/app/a.cpp", "assimp/scene.h"},          {"src/scene/a.cpp", "CLI/CLI.hpp"},
        {"src/scene/a.cpp", "boost/optional.hpp"},
    };
    for (const auto& [path, header] : strays)
        EXPECT_EQ(breaches_in(path, "#include <" + std::string(header) + ">\n").size(), 1u) << path << " " << header;
}

TEST(LayerCheck, FindsALibraryInMoreFilesThanItMayBe) {
    std::vector<File> files;
    for (const char* path : {"src/parallel/a.cpp", "src/parallel/b.cpp"})
        files.push_back(make_file(path, "#include <tbb/tbb.h>\n"));
    EXPECT_TRUE(layer_breaches(files).empty());
    files.push_back(make_file("src/parallel/c.cpp", "#include <tbb/tbb.h>\n"));
    EXPECT_EQ(layer_breaches(files).size(), 3u);
}

TEST(LayerCheck, FindsSourcesThatLieInNoPart) {
    EXPECT_EQ(breaches_in("src/misc/a.cpp", "").size(), 1u);
}

TEST(LayerCheck, LetsTheHouseBeBuiltAsItIsMeant) {
    EXPECT_TRUE(breaches_in("src/app/a.cpp", "#include \"encoder/av/av.h\"\n#include \"renderer/plan.h\"\n").empty());
    EXPECT_TRUE(
        breaches_in("src/renderer/a.cpp", "#include <vector>\n#include <glm/glm.hpp>\n#include \"scene/mesh.h\"\n")
            .empty());
    EXPECT_TRUE(breaches_in("encoder/a.cpp", "// #include \"renderer/plan.h\"\n#include \"core/plane.h\"\n").empty());
    EXPECT_TRUE(
        breaches_in("tests/pipeline/a.cpp", "#include \"renderer/plan.h\"\n#include \"encoder/encoder.h\"\n").empty());
}

}  // namespace
}  // namespace render2mpeg::checks
