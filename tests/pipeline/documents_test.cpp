#include <gtest/gtest.h>

#include <regex>
#include <string>

#include "pipeline/fixture.h"

/// The pages about the files that we write name every key of them.
namespace render2mpeg::test {
namespace {

/// Expects every key of an object, and of the objects in it, to stand as a word in the text. Keys of `names` are names
/// of passes or types, not ours to list.
void expect_keys(const json& object, const std::string& text, const std::string& names) {
    for (const auto& [key, value] : object.items()) {
        EXPECT_TRUE(std::regex_search(text, std::regex("\\b" + key + "\\b"))) << key;
        if (key == names) continue;
        if (value.is_object()) expect_keys(value, text, names);
        if (value.is_array() && !value.empty() && value.front().is_object()) expect_keys(value.front(), text, names);
    }
}

std::string page(const char* name) {
    return contents(support::source_folder() / "docs" / name);
}

TEST(Documents, NameEveryKeyOfStatisticsReportsAndInformationSlow) {
    const Folder folder;
    const std::string tiny = " --size 16x16 --samples 1 --exposure 0 --frames 0:2 --quiet ";
    ASSERT_EQ(run(program() + " render -y --hold " + support::plain_film() + tiny +
                  "--tolerance coupled=4 --audit 2 --bitrate 300k -o " + path(folder, "f.mpg") + " --report " +
                  path(folder, "r.html"))
                  .status,
              0);
    const json report = json::parse(contents(folder / "r.report.json"));
    expect_keys(report, page("json.md"), "passes");

    test::write_frames(path(folder, "in.y4m"), 64, 48, "25:1", "1:1", 3);
    ASSERT_EQ(run(program() + " encode -y " + path(folder, "in.y4m") + " --quiet -o " + path(folder, "e.mpg") +
                  " --stats " + path(folder, "e.json"))
                  .status,
              0);
    expect_keys(json::parse(contents(folder / "e.json")), page("json.md"), "passes");

    const auto told = run(program() + " info --json " + path(folder, "f.mpg"));
    ASSERT_EQ(told.status, 0) << told.output;
    expect_keys(json::parse(told.output), page("json.md"), "types");

    const auto tried = run(program() + " cost " + support::plain_film() +
                           " --size 16x16 --samples 1 --exposure 0 --sample 1x1 "
                           "--tolerances 20" +
                           " --quiet --json " + path(folder, "c.json"));
    ASSERT_EQ(tried.status, 0) << tried.output;
    expect_keys(json::parse(contents(folder / "c.json")), page("json.md"), "");
}

}  // namespace
}  // namespace render2mpeg::test
