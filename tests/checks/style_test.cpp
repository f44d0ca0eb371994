#include "checks/style.h"
#include "tests/support/places.h"

#include <gtest/gtest.h>

namespace render2mpeg::checks {
namespace {

TEST(Leftovers, AreNotInThisTree) {
    const auto findings = leftovers(read_tree(support::source_folder()));
    EXPECT_TRUE(findings.empty()) << list_of(findings);
}

TEST(Names, OfThisTreeAreTheHouses) {
    const auto findings = unhouselike_names(read_tree(support::source_folder()));
    EXPECT_TRUE(findings.empty()) << list_of(findings);
}

TEST(Parts, OfThisTreeNeitherPrintNorExitNorRollDice) {
    const auto findings = forbidden_calls(read_tree(support::source_folder()));
    EXPECT_TRUE(findings.empty()) << list_of(findings);
}

TEST(LeftoverCheck, FindsEachKind) {
    const char* bad[] = {"// TODO: more\n", "// FIXME\n",    "\tint a;\n",     "int a;\r\n", "int a; \n",
                         "int a;",          "int a;\n\n",    "<<<<<<< ours\n", "=======\n",  ">>>>>>> b\n",
                         "a /home/me/x\n",  "see /work/a\n", "// XXX here\n"};
    for (const char* text : bad) {
        EXPECT_EQ(leftovers({make_file("src/core/a.cpp", text)}).size(), 1u) << text;
        EXPECT_EQ(leftovers({make_file("scripts/demo", text)}).size(), 1u) << text;
    }
}

TEST(LeftoverCheck, LetsInnocentTextPass) {
    const char* good[] = {"int todo = XXX_count;\n",   "// a == b, a => b\n", "",
                          "\n// ======= not a mark\n", "$build/work/a\n",     "${x}/work/a, ../work/b\n"};
    for (const char* text : good)
        EXPECT_TRUE(leftovers({make_file("src/core/a.cpp", text)}).empty() || std::string(text) == "\n") << text;
    EXPECT_TRUE(leftovers({make_file("animations/a/a.gltf", "{\"uri\": \"AAA/home/XXX\"}\n")}).empty());
}

TEST(NameCheck, FindsEachKind) {
    const char* bad[] = {"class TextureManager {};\n", "struct FrameData {\n", "enum class MeshInfo { a };\n",
                         "int get_width() const;\n", "std::format(x);\n"};
    for (const char* text : bad) EXPECT_EQ(unhouselike_names({make_file("src/core/a.cpp", text)}).size(), 1u) << text;
    EXPECT_EQ(unhouselike_names({make_file("src/core/a.h", "int a;\n")}).size(), 1u);
}

TEST(NameCheck, LetsOtherPeoplesNamesPass) {
    const char* good[] = {"std::get_if<int>(&v);\n", "av_get_pix_fmt(x);\n", "object.get_ptr();\n",
                          "json->get_to(x);\n",      "// get_width\n",       "const ALInfo& x = theirs();\n",
                          "class Dataset {};\n"};
    for (const char* text : good) EXPECT_TRUE(unhouselike_names({make_file("src/core/a.cpp", text)}).empty()) << text;
}

TEST(CallCheck, FindsPartsThatPrintExitOrRollDice) {
    const char* bad[] = {"std::cerr << 1;\n", "std::printf(\"a\");\n", "fmt::print(\"a\");\n", "std::exit(1);\n",
                         "abort();\n",        "std::mt19937 g;\n"};
    for (const char* text : bad) {
        EXPECT_FALSE(forbidden_calls({make_file("src/scene/a.cpp", text)}).empty()) << text;
        EXPECT_TRUE(forbidden_calls({make_file("tests/scene/a_test.cpp", text)}).empty()) << text;
    }
    EXPECT_TRUE(forbidden_calls({make_file("src/app/main.cpp", "std::cerr << 1;\n")}).empty());
    EXPECT_FALSE(forbidden_calls({make_file("src/app/main.cpp", "std::random_device d;\n")}).empty());
    EXPECT_TRUE(
        forbidden_calls({make_file("src/scene/a.cpp", "std::snprintf(b, 3, \"x\"); // exit, abort\n")}).empty());
}

}  // namespace
}  // namespace render2mpeg::checks
