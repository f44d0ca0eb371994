// Each shader node of Blender beside Cycles, and what is told of those that differ (tests/blender/walk_nodes.py).
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include "pipeline/fixture.h"

namespace render2mpeg::test {
namespace {

using support::Outcome;

Outcome walk(const Folder& folder, const std::string& how) {
    return support::blender("-P " + support::blender_script("walk_nodes.py") + " -- " + folder.path().string() + how);
}

/// Lines that begin with a word, without it.
std::vector<std::string> lines_of(const std::string& text, const std::string& begin) {
    std::istringstream in(text);
    std::vector<std::string> found;
    for (std::string line; std::getline(in, line);)
        if (line.starts_with(begin + " ")) found.push_back(line.substr(begin.size() + 1));
    return found;
}

TEST(BlendNodesSlow, ThatFilmsShowOtherwiseThanCyclesAreTold) {
    if (!support::blender_is_there()) GTEST_SKIP() << "Blender is not installed";
    const Folder folder;
    ASSERT_EQ(walk(folder, "").status, 0);
    const std::string blend = path(folder, "nodes.blend"), at = folder.path().string();
    const Outcome said = run(program() + " plan --within 0 " + blend);
    ASSERT_EQ(said.status, 0) << said.output;
    const Outcome ours = run(program() + " render -y --hold " + blend + " -o " + path(folder, "ours%04d.exr") +
                             " --frames 0:0 --exposure 0 --quiet --samples 16 --tolerance fixed=3%");
    ASSERT_EQ(ours.status, 0) << ours.output;
    const Outcome cycles =
        support::blender(blend + " -P " + support::blender_script("cycles.py") + " -- " + at + " 0 --samples 64");
    ASSERT_EQ(cycles.status, 0) << cycles.output;
    const Outcome compared = walk(folder, " --compare");
    ASSERT_EQ(compared.status, 0) << compared.output;

    int alike = 0;
    for (const std::string& line : lines_of(compared.output, "OFF")) {
        std::istringstream words(line);
        double mean = 0, off = 0;
        std::string name;
        words >> mean >> off >> std::ws;
        std::getline(words, name);
        const bool told = said.output.find("not kept: " + name + ": ") != std::string::npos;
        // Cycles' own noise in air is larger.
        const double most = name.starts_with("Volume") ? 0.12 : 0.06;
        EXPECT_TRUE(told || mean < 0.02) << name << " is off by " << mean << " on the whole, and nothing is told";
        EXPECT_TRUE(told || off < most) << name << " is off by " << off << ", and nothing is told";
        alike += off < most ? 1 : 0;
    }
    EXPECT_GE(alike, 100) << compared.output;

    // The rows of the documents say the same.
    for (const auto& entry : std::filesystem::directory_iterator(blend + ".export"))
        std::filesystem::copy_file(entry.path() / "export.json", folder / "export.json");
    const std::string page = contents(support::source_folder() / "docs/scenes.md");
    const auto rows = lines_of(walk(folder, " --table").output, "ROW");
    ASSERT_EQ(rows.size(), 2u);
    for (const std::string& row : rows) EXPECT_NE(page.find(row + "\n"), std::string::npos) << row;
}

}  // namespace
}  // namespace render2mpeg::test
