#include "checks/sizes.h"
#include "tests/support/places.h"
#include "tests/support/program.h"

#include <gtest/gtest.h>

#include <iostream>

namespace render2mpeg::checks {
namespace {

std::string lines(int count, const std::string& line = "\n") {
    std::string text;
    for (int i = 0; i < count; ++i) text += line;
    return text;
}

TEST(Files, OfThisTreeHaveOneDutyEach) {
    const auto findings = oversized_files(read_tree(support::source_folder()));
    EXPECT_TRUE(findings.empty()) << list_of(findings);
}

TEST(Files, OfThisTreeAreSmallEnoughForEveryClone) {
    const auto findings = large_files(support::source_folder());
    EXPECT_TRUE(findings.empty()) << list_of(findings);
}

TEST(Functions, OfThisTreeStayOnAPage) {
    const auto findings = oversized_functions(read_tree(support::source_folder()));
    EXPECT_TRUE(findings.empty()) << list_of(findings);
}

TEST(SizeCheck, FindsSourcesAndTestsThatAreTooLong) {
    EXPECT_TRUE(oversized_files({make_file("src/core/a.cpp", lines(500))}).empty());
    EXPECT_EQ(oversized_files({make_file("src/core/a.cpp", lines(501))}).size(), 1u);
    EXPECT_EQ(oversized_files({make_file("encoder/a.h", lines(500) + "last, without its end")}).size(), 1u);
    EXPECT_EQ(oversized_files({make_file("tests/core/a_test.cpp", lines(501))}).size(), 1u);
    EXPECT_TRUE(oversized_files({make_file("docs/model.md", lines(2000))}).empty());
}

TEST(SizeCheck, FindsFilesThatEveryCloneWouldCarry) {
    if (support::run("command -v git").status != 0) GTEST_SKIP() << "git is not installed";
    const support::Folder folder;
    ASSERT_EQ(support::run("git init -q " + folder.path().string()).status, 0);
    const auto write = [&](const std::string& name, std::size_t bytes) {
        std::ofstream(folder / name, std::ios::binary) << std::string(bytes, 'n');
    };
    write(".gitignore", 0);
    write("noise tile.bin", largest_file);
    EXPECT_TRUE(large_files(folder.path()).empty());
    write("noise tile.bin", largest_file + 1);
    const auto added = large_files(folder.path());
    ASSERT_EQ(added.size(), 1u);
    EXPECT_EQ(added[0].path, "noise tile.bin");
    ASSERT_EQ(support::run("git -C " + folder.path().string() + " add .").status, 0);
    EXPECT_EQ(large_files(folder.path()).size(), 1u);
    std::ofstream(folder / ".gitignore") << "*.vdb\n";
    write("cached.vdb", 2 * largest_file);
    EXPECT_EQ(large_files(folder.path()).size(), 1u) << "what git ignores counts for nothing";
}

TEST(SizeCheck, FindsFunctionsThatAreTooLong) {
    const std::string heads[] = {
        "int f(int a) {\n",
        "void Class::f(int a,\n             int b) const {\n",
        "    int inline_member() {\n",
        "C::C(int a)\n    : a_(a),\n      b_(f(a)),\n      c_(g(a)) {\n",
        "C::C(int a)\n    : a_(a),\n      // why\n      b_(f(a,\n           a)),\n      c_(g(a)) {\n",
        "    C(int a,\n      int b)\n        : a_(a),\n          b_(b) {\n"};
    for (const std::string& head : heads) {
        const std::string indent(head.find_first_not_of(' '), ' ');
        const int head_lines = static_cast<int>(lines_of(head).size());
        const auto text = [&](int body) {
            return "namespace n {\n\n" + head + lines(body, indent + "    a();\n") + indent + "}\n\n}\n";
        };
        EXPECT_TRUE(oversized_functions({make_file("src/core/a.cpp", text(59 - head_lines))}).empty()) << head;
        const auto findings = oversized_functions({make_file("src/core/a.cpp", text(60 - head_lines))});
        ASSERT_EQ(findings.size(), 1u) << head;
        EXPECT_EQ(findings[0].line, 3);
    }
}

TEST(SizeCheck, TakesNoScopeForAFunction) {
    const std::string body = lines(100, "    int a;\n");
    for (const char* head :
         {"namespace a {\n", "class A final : public B<decltype(c())> {\n", "struct S {\n", "enum class E {\n"})
        EXPECT_TRUE(oversized_functions({make_file("src/core/a.cpp", head + body + "}\n")}).empty()) << head;
}

}  // namespace
}  // namespace render2mpeg::checks
