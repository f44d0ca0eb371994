#include "checks/links.h"
#include "tests/support/places.h"

#include <gtest/gtest.h>

namespace render2mpeg::checks {
namespace {

const std::filesystem::path nowhere = "/nonexistent";

TEST(Links, OfThisTreeLeadSomewhere) {
    const auto findings = dead_links(read_tree(support::source_folder()), support::source_folder());
    EXPECT_TRUE(findings.empty()) << list_of(findings);
}

TEST(LinkCheck, FindsFilesAndHeadingsThatAreNotThere) {
    const File other = make_file("docs/other.md", "# The *first* one, with `code`\n\n## Twice\n\n## Twice\n");
    const char* dead[] = {"[a](nothing.md)\n",        "![a](picture.png)\n", "<img src=\"picture.png\">\n",
                          "[a](other.md#third)\n",    "[a](#nowhere)\n",     "[a](other.md#twice-2)\n",
                          "[a](../docs/nothing.md)\n"};
    for (const char* text : dead)
        EXPECT_EQ(dead_links({make_file("docs/a.md", text), other}, nowhere).size(), 1u) << text;
    const char* alive[] = {"[a](other.md)\n",
                           "[a](other.md#the-first-one-with-code)\n",
                           "[a](other.md#twice-1)\n",
                           "# Here\n[a](#here)\n",
                           "[a](https://example.org/x)\n",
                           "`[a](nothing.md)`\n",
                           "```\n[a](nothing.md)\n```\n"};
    for (const char* text : alive)
        EXPECT_TRUE(dead_links({make_file("docs/a.md", text), other}, nowhere).empty()) << text;
}

}  // namespace
}  // namespace render2mpeg::checks
