#include "checks/citations.h"
#include "tests/support/places.h"

#include <gtest/gtest.h>

namespace render2mpeg::checks {
namespace {

const std::string table = "# Sources\n\n| key | what |\n|---|---|\n";

std::vector<File> tree_with(const std::string& rows, const std::string& code) {
    return {make_file("docs/sources.md", table + rows), make_file("src/core/a.cpp", code)};
}

TEST(Citations, OfThisTreeAreAllListedAndAllListedAreCited) {
    const auto findings = citation_faults(read_tree(support::source_folder()));
    EXPECT_TRUE(findings.empty()) << list_of(findings);
}

TEST(Places, ThatThisTreeCitesExist) {
    const auto findings = place_faults(read_tree(support::source_folder()));
    EXPECT_TRUE(findings.empty()) << list_of(findings);
}

TEST(CitationCheck, FindsAKeyThatIsNotListed) {
    for (const char* comment :
         {"// [Nobody1999]\n", "/// [Nobody1999, eq. 3]\n", "/* [Nobody1999b] */\n", "// [H999, 6.2.1]\n",
          "// [H999, table 6-4]\n", "// see [Walter2005; Nobody1999, 3.1]\n", "// [Nobody1999,\n// eq. 3]\n"}) {
        const auto findings =
            citation_faults(tree_with("| Walter2005 | Lightcuts |\n", std::string("// [Walter2005]\n") + comment));
        ASSERT_EQ(findings.size(), 1u) << comment << list_of(findings);
        EXPECT_EQ(findings[0].path, "src/core/a.cpp");
        EXPECT_EQ(findings[0].line, 2);
    }
}

TEST(CitationCheck, FindsAKeyThatNothingCites) {
    EXPECT_EQ(citation_faults(tree_with("| Walter2005 | Lightcuts |\n", "int a[3];\n")).size(), 1u);
    EXPECT_EQ(citation_faults(tree_with("| Walter2005 | Lightcuts |\n", "auto s = \"[Walter2005]\";\n")).size(), 1u);
}

TEST(CitationCheck, FindsKeysOutOfOrderAndTwice) {
    const std::string both = "// [Duff2017] [Walter2005]\n";
    EXPECT_TRUE(citation_faults(tree_with("| Duff2017 | b |\n| Walter2005 | a |\n", both)).empty());
    EXPECT_EQ(citation_faults(tree_with("| Walter2005 | a |\n| Duff2017 | b |\n", both)).size(), 1u);
    EXPECT_EQ(citation_faults(tree_with("| Duff2017 | b |\n| Duff2017 | b |\n| Walter2005 | a |\n", both)).size(), 1u);
}

TEST(CitationCheck, TakesNoBracketOfCodeForACitation) {
    const std::string code =
        "[[nodiscard]] int f(int (&year1999)[4]) { return [year2005 = 3] { return year2005; }() + year1999[x2004]; }\n"
        "// uniform in [0, 1), a[index2001], rows [y * 8 + x], [width, 3], samples[i], weights [u, v], see [the "
        "model](model.md)\n";
    EXPECT_TRUE(citation_faults(tree_with("", code)).empty()) << list_of(citation_faults(tree_with("", code)));
}

TEST(CitationCheck, ReadsProseAsWell) {
    auto files = tree_with("", "");
    files.push_back(make_file("docs/model.md", "As in [Nobody1999, eq. 4].\n"));
    EXPECT_EQ(citation_faults(files).size(), 1u);
}

TEST(CitationCheck, FindsAMissingTable) {
    EXPECT_EQ(citation_faults({}).size(), 1u);
}

TEST(PlaceCheck, FindsAHeadingThatIsNotThere) {
    const File page = make_file("docs/measurements.md", "# Measurements\n\n## Tone curve\n");
    EXPECT_TRUE(
        place_faults({make_file("src/core/a.cpp", "// fit: docs/measurements.md#tone-curve.\n"), page}).empty());
    const File wrong = make_file("src/core/a.cpp", "int a;\n// fit: docs/measurements.md#tone\n");
    ASSERT_EQ(place_faults({wrong, page}).size(), 1u);
    EXPECT_EQ(place_faults({wrong, page})[0].line, 2);
    EXPECT_EQ(place_faults({make_file("src/core/a.cpp", "// fit: docs/measurements.md#tone-curve\n")}).size(), 1u);
}

}  // namespace
}  // namespace render2mpeg::checks
