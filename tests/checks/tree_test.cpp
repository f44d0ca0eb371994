#include "checks/tree.h"
#include "tests/support/places.h"

#include <gtest/gtest.h>

namespace render2mpeg::checks {
namespace {

std::string squeezed(const std::string& text) {
    std::string result;
    for (const char c : text)
        if (c != ' ') result += c;
    return result;
}

TEST(Splitter, PartsCodeFromCommentsWithoutMovingEither) {
    const File file = make_file("a.cpp", "int a; // one\nint /* two */ b;\n");
    EXPECT_EQ(squeezed(file.code), "inta;\nintb;\n");
    EXPECT_EQ(squeezed(file.comments), "one\ntwo\n");
    EXPECT_EQ(file.code.size(), file.text.size());
    EXPECT_EQ(file.comments.find("two"), file.text.find("two"));
}

TEST(Splitter, TakesNoCommentFromALiteralAndNoLiteralFromAComment) {
    const File file = make_file(
        "a.cpp", "f(\"// \\\" no\", '\"', 'x'); // isn't \"it\nint b = 1'000'000; g(R\"x(// )\" no)x\");\nint c;\n");
    EXPECT_EQ(squeezed(file.comments), "isn't\"it\n\n\n");
    EXPECT_EQ(squeezed(file.code), "f(\"\",'','');\nintb=1'000'000;g();\nintc;\n");
}

TEST(Splitter, SurvivesTextThatEndsEarly) {
    for (const char* text : {"/* open", "\"open", "'", "R\"(open", "R\"", "//", "\"\\", "#include \"open"}) {
        const File file = make_file("a.cpp", text);
        EXPECT_EQ(file.code.size(), file.text.size()) << text;
    }
}

TEST(Includes, AreFoundWithTheirLines) {
    const auto found = includes_of(
        make_file("a.cpp", "#pragma once\n#include <vector>\n  #  include \"core/plane.h\"\n// #include <no>\n"));
    ASSERT_EQ(found.size(), 2u);
    EXPECT_EQ(found[0].name, "vector");
    EXPECT_FALSE(found[0].quoted);
    EXPECT_EQ(found[0].line, 2);
    EXPECT_EQ(found[1].name, "core/plane.h");
    EXPECT_TRUE(found[1].quoted);
    EXPECT_EQ(found[1].line, 3);
}

TEST(Words, AreFoundWhole) {
    EXPECT_EQ(find_word("exit exits _exit exit(1) std::exit", "exit").size(), 3u);
    EXPECT_TRUE(find_word("", "exit").empty());
}

TEST(Tree, HoldsTheProjectsFilesAndNoBuilds) {
    bool readme = false, setup = false, main_header = false;
    for (const File& file : read_tree(support::source_folder())) {
        readme = readme || file.path == "README.md";
        setup = setup || file.path == "scripts/setup";
        main_header = main_header || file.path == "src/core/plane.h";
        EXPECT_FALSE(file.begins_with("build")) << file.path;
        EXPECT_FALSE(file.begins_with(".git/")) << file.path;
    }
    EXPECT_TRUE(readme);
    EXPECT_TRUE(setup);
    EXPECT_TRUE(main_header);
}

}  // namespace
}  // namespace render2mpeg::checks
