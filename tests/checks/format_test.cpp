// Every C++ file is as clang-format 14 has it with the tree's .clang-format; Python reads every .py.
#include "tests/support/places.h"
#include "tests/support/program.h"

#include <gtest/gtest.h>

namespace render2mpeg::checks {
namespace {

using support::run;

/// Those of the files that `list` prints, with zeros between them, that clang-format would change.
std::string unformatted(const std::string& folder, const std::string& list) {
    return run("cd " + folder + " && " + list +
               " | xargs -0 -r -P 2 -n 40 clang-format-14 --dry-run --Werror --ferror-limit=1 2>&1 | grep 'error:' | "
               "sort")
        .output;
}

std::string all_below(const std::string& places) {
    return "find " + places + " -name '*.cpp' -print0 -o -name '*.h' -print0";
}

TEST(Format, OfThisTreeIsWhatClangFormatMakesSlow) {
    if (run("clang-format-14 --version").status != 0) GTEST_SKIP() << "clang-format-14 is not installed";
    EXPECT_EQ(unformatted(support::source_folder().string(), all_below("src encoder perceptual tests bench")), "");
}

TEST(Format, OfTheLastChangeIsWhatClangFormatMakes) {
    if (run("clang-format-14 --version").status != 0) GTEST_SKIP() << "clang-format-14 is not installed";
    const std::string tree = support::source_folder().string();
    if (run("git -C " + tree + " rev-parse HEAD~1").status != 0) GTEST_SKIP() << "there is no history";
    EXPECT_EQ(unformatted(tree,
                          "{ git diff -z --name-only --diff-filter=d HEAD~1 -- '*.cpp' '*.h'; "
                          "git ls-files -z --others --exclude-standard '*.cpp' '*.h'; }"),
              "");
}

TEST(Format, OfAFileThatClangFormatWouldChangeIsFound) {
    if (run("clang-format-14 --version").status != 0) GTEST_SKIP() << "clang-format-14 is not installed";
    const support::Folder folder;
    std::ofstream(folder / ".clang-format") << "BasedOnStyle: Google\n";
    std::ofstream(folder / "good.cpp") << "int a;\n";
    std::ofstream(folder / "bad.cpp") << "int  a ;\n";
    const std::string found = unformatted(folder.path().string(), all_below("."));
    EXPECT_NE(found.find("bad.cpp"), std::string::npos) << found;
    EXPECT_EQ(found.find("good.cpp"), std::string::npos) << found;
}

/// Where Python stumbles over the scripts below `places`; empty where it reads all.
std::string unreadable_scripts(const std::string& folder, const std::string& places) {
    return run("cd '" + folder + "' && find " + places +
               " -name '*.py' -print0 | xargs -0 python3 -c \"import ast, sys; [ast.parse(open(f).read(), f) for f in "
               "sys.argv[1:]]\" 2>&1")
        .output;
}

TEST(Scripts, OfThisTreeAreReadByThisPython) {
    EXPECT_EQ(unreadable_scripts(support::source_folder().string(), "animations bench blender docs src tests"), "");
}

TEST(Scripts, ThatPythonDoesNotReadAreFound) {
    const support::Folder folder;
    std::ofstream(folder / "good.py") << "a = 1\n";
    EXPECT_EQ(unreadable_scripts(folder.path().string(), "."), "");
    std::ofstream(folder / "bad.py") << "a = (\n";
    EXPECT_NE(unreadable_scripts(folder.path().string(), ".").find("bad.py"), std::string::npos);
}

}  // namespace
}  // namespace render2mpeg::checks
