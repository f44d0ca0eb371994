#include "checks/pages.h"
#include "tests/support/places.h"
#include "tests/support/written_page.h"

#include <gtest/gtest.h>

namespace render2mpeg::checks {
namespace {

TEST(Pages, OfStructureAndEquationsAreWrittenToTheBuildFolder) {
    const auto files = read_tree(support::source_folder());
    const std::string structure = structure_page(files), equations = equations_page(files);
    EXPECT_GT(structure.size(), 10000u);
    EXPECT_GT(equations.size(), 10000u);
    support::write_page("structure.md", structure);
    support::write_page("equations.md", equations);
}

TEST(Duties, OfThisTreeAreAllSaid) {
    const auto findings = files_without_duty(read_tree(support::source_folder()));
    EXPECT_TRUE(findings.empty()) << list_of(findings);
}

TEST(Duty, IsTheFirstSentenceOfTheFirstComment) {
    const auto duty = [](const char* text) { return duty_of(make_file("src/core/a.h", text)); };
    EXPECT_EQ(duty("#pragma once\n\n/// Adds, e.g. Two numbers.\n/// And more.\nint f();\n"),
              "Adds, e.g. Two numbers.");
    EXPECT_EQ(duty("/// Over\n/// two lines. [Walter2005]\n"), "Over two lines.");
    EXPECT_EQ(duty("// Not quite a sentence\nint a;\n/// Another.\n"), "Not quite a sentence");
    EXPECT_EQ(duty("#pragma once\nint a;  ///< a member\n"), "");
}

TEST(StructurePage, HasEveryFileOnceByRoom) {
    const std::vector<File> files{
        make_file("src/core/a.cpp", "#include \"a.h\"\n"), make_file("src/core/a.h", "/// Adds a|b.\n"),
        make_file("src/image/b.cpp", "// Draws.\n"), make_file("tests/core/t.cpp", "// No.\n")};
    const std::string page = structure_page(files);
    EXPECT_NE(page.find("## src/core\n\n| file | duty |\n|---|---|\n| a.h, .cpp | Adds a\\|b. |\n"), std::string::npos)
        << page;
    EXPECT_NE(page.find("| b.cpp | Draws. |\n"), std::string::npos) << page;
    EXPECT_EQ(page.find("tests/core/t"), std::string::npos);
    EXPECT_TRUE(files_without_duty(files).empty());
    EXPECT_EQ(files_without_duty({make_file("src/core/c.cpp", "int a;\n")}).size(), 1u);
}

TEST(EquationsPage, LeadsFromEachPlaceToItsFiles) {
    const std::vector<File> files{
        make_file("docs/model/light.md", "As [Walter2005, eq. 2] has it.\n"),
        make_file("docs/sources.md", "| key | what |\n|---|---|\n| Walter2005 | Lightcuts |\n"),
        make_file("src/core/a.cpp", "// [Walter2005, eqs. 2 and 10]\n// [Walter2005]\n"),
        make_file("src/core/b.cpp", "// [Walter2005, eq. 9]\n")};
    const std::string page = equations_page(files);
    const std::string rows =
        "## Walter2005\n\nLightcuts\n\n| place | files | explained in |\n|---|---|---|\n"
        "| as a whole | `src/core/a.cpp` |  |\n| eq. 2 | `src/core/a.cpp` | `docs/model/light.md` |\n"
        "| eq. 9 | `src/core/b.cpp` |  |\n| eq. 10 | `src/core/a.cpp` |  |\n";
    EXPECT_NE(page.find(rows), std::string::npos) << page;
}

}  // namespace
}  // namespace render2mpeg::checks
