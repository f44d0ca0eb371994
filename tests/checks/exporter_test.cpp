#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "support/places.h"

/// What Blender's exporter says of materials is what the renderer knows.
namespace render2mpeg::checks {
namespace {

std::string text_of(const std::string& path) {
    std::ifstream file(support::source_folder() / path);
    return {std::istreambuf_iterator<char>(file), {}};
}

std::set<std::string> found_in(const std::string& text, const char* form) {
    const std::regex pattern(form);
    std::set<std::string> names;
    for (std::sregex_iterator it(text.begin(), text.end(), pattern), end; it != end; ++it) names.insert((*it)[1]);
    return names;
}

TEST(Exporter, KnowsEveryFieldOfTheRenderersMaterials) {
    const std::string header = text_of("src/scene/model/material.h"),
                      exporter = text_of("blender/film_export/materials.py");
    const std::size_t begin = header.find("struct Material {"), end = header.find("bool changes_specular", begin);
    ASSERT_NE(end, std::string::npos);
    std::string fields = header.substr(begin, end - begin);
    // One declaration may have two names.
    fields = std::regex_replace(fields, std::regex("///?[^\n]*"), "");
    std::set<std::string> wanted = found_in(
        fields,
        R"((?:std::string|glm::vec[34]|TextureUse|float|bool|AlphaMode|Thickness|SurfaceModel|std::(?:optional|vector)<[A-Za-z]+>|, ) ?([a-z_]+)\s*(?=[;{=,]))");
    for (const std::string& second : found_in(fields, R"(=\s*[0-9.f]+,\s*([a-z_]+)\s*=)")) wanted.insert(second);
    const std::size_t table = exporter.find("FIELDS = {"), close = exporter.find("\n}\n", table);
    const std::set<std::string> told = found_in(exporter.substr(table, close - table), R"re("([a-z_]+)":)re");
    EXPECT_GE(wanted.size(), 50u);
    EXPECT_EQ(told, wanted);
}

std::vector<std::vector<std::string>> node_rows() {
    const std::string text = text_of("blender/film_export/kept.py");
    const std::regex row(R"re(\(("[A-Z_]+"|None), "([^"]+)", (KEPT|NEAR|LOST),\s+"([^"]*)"\))re");
    std::vector<std::vector<std::string>> rows;
    for (std::sregex_iterator it(text.begin(), text.end(), row), end; it != end; ++it)
        rows.push_back({(*it)[1], (*it)[2], (*it)[3], (*it)[4]});
    return rows;
}

TEST(Exporter, SaysInTheDocumentsWhatBecomesOfEachNode) {
    const std::string page = text_of("docs/scenes.md");
    const auto rows = node_rows();
    EXPECT_GE(rows.size(), 25u);
    for (const auto& row : rows) {
        std::string fate = row[2] == "KEPT" ? "" : row[2];
        std::transform(fate.begin(), fate.end(), fate.begin(), [](unsigned char c) { return std::tolower(c); });
        EXPECT_NE(page.find("| " + row[1] + " | " + fate + " | " + row[3] + " |\n"), std::string::npos)
            << row[1] << ": `python3 blender/film_export/kept.py` prints the table";
    }
}

TEST(Exporter, ReadsTheShadersOfItsTableThatItKeepsAndNoOthers) {
    std::set<std::string> kept, lost;
    for (const auto& row : node_rows())
        if (row[0] != "None") (row[2] == "LOST" ? lost : kept).insert(row[0].substr(1, row[0].size() - 2));
    std::set<std::string> read;
    const std::string looks = text_of("blender/film_export/looks.py");
    for (std::string name : found_in(looks, R"(\bread_([a-z_]+)(?:\(self, node\)| = ))")) {
        std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::toupper(c); });
        EXPECT_FALSE(lost.contains(name)) << name;
        if (name != "LAYERS") read.insert(name);
    }
    for (const std::string& name : read) EXPECT_TRUE(kept.contains(name)) << name << " has no row";
    EXPECT_GE(read.size(), 17u);
}

TEST(Exporter, WritesEveryExtensionThatBlenderHasMaterialsFor) {
    const std::set<std::string> read = found_in(text_of("src/scene/gltf/extensions.cpp"), "KHR_materials_([a-z_]+)\\b");
    const std::string exporter = text_of("blender/film_export/materials.py");
    // Blender has no materials without light, of older workflows, in variants, that disperse, or that scatter.
    const std::set<std::string> none{"unlit", "variants", "dispersion", "volume_scatter"};
    EXPECT_GE(read.size(), 10u);
    for (const std::string& extension : read)
        if (!none.contains(extension)) {
            EXPECT_TRUE(exporter.find("KHR_materials_" + extension) != std::string::npos ||
                        exporter.find("(\"" + extension + "\"") != std::string::npos)
                << extension;
        }
}

}  // namespace
}  // namespace render2mpeg::checks
