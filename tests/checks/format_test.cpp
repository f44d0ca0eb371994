// Every C++ file is as clang-format 14 has it with the tree's .clang-format.
#include "tests/support/places.h"
#include "tests/support/program.h"

#include <gtest/gtest.h>

namespace render2mpeg::checks {
namespace {

using support::run;

/// Names of the files below `folder` that clang-format would change.
support::Outcome unformatted(const std::string& folder, const std::string& places) {
    return run("cd " + folder + " && find " + places +
               " -name '*.cpp' -print0 -o -name '*.h' -print0 | xargs -0 -P 2 -n 40 clang-format-14 --dry-run --Werror "
               "--ferror-limit=1 2>&1 | grep 'error:' | sort");
}

TEST(Format, OfThisTreeIsWhatClangFormatMakes) {
    if (run("clang-format-14 --version").status != 0) GTEST_SKIP() << "clang-format-14 is not installed";
    const std::string found =
        unformatted(support::source_folder().string(), "src encoder perceptual tests bench").output;
    EXPECT_EQ(found, "");
}

TEST(Format, OfAFileThatClangFormatWouldChangeIsFound) {
    if (run("clang-format-14 --version").status != 0) GTEST_SKIP() << "clang-format-14 is not installed";
    const support::Folder folder;
    std::ofstream(folder / ".clang-format") << "BasedOnStyle: Google\n";
    std::ofstream(folder / "good.cpp") << "int a;\n";
    std::ofstream(folder / "bad.cpp") << "int  a ;\n";
    const std::string found = unformatted(folder.path().string(), ".").output;
    EXPECT_NE(found.find("bad.cpp"), std::string::npos) << found;
    EXPECT_EQ(found.find("good.cpp"), std::string::npos) << found;
}

}  // namespace
}  // namespace render2mpeg::checks
