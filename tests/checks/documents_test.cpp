#include "checks/documents.h"
#include "tests/support/places.h"

#include <gtest/gtest.h>

namespace render2mpeg::checks {
namespace {

std::string words(int count) {
    std::string text;
    for (int i = 0; i < count; ++i) text += "word\n";
    return text;
}

TEST(Documents, OfThisTreeAreShort) {
    const auto findings = wordy_documents(read_tree(support::source_folder()));
    EXPECT_TRUE(findings.empty()) << list_of(findings);
}

TEST(Documents, OfThisTreeHaveTogetherAtMost60000Words) {
    int count = 0;
    for (const File& file : read_tree(support::source_folder()))
        if (file.path.ends_with(".md")) count += count_words(file.text);
    EXPECT_LE(count, 60000);
}

TEST(Documents, OfThisTreeSayOfEachReleaseWhatIsReadInAFewMinutes) {
    int found = 0;
    for (const File& file : read_tree(support::source_folder())) {
        if (file.path != "CHANGELOG.md") continue;
        ++found;
        const auto findings = wordy_releases(file);
        EXPECT_TRUE(findings.empty()) << list_of(findings);
    }
    EXPECT_EQ(found, 1);
}

TEST(Documents, ThatThisTreeNamesAreThere) {
    const auto findings = missing_files(read_tree(support::source_folder()), support::source_folder());
    EXPECT_TRUE(findings.empty()) << list_of(findings);
}

TEST(DocumentCheck, CountsWordsAndNoMarks) {
    EXPECT_EQ(count_words(""), 0);
    EXPECT_EQ(count_words("  \n\n"), 0);
    EXPECT_EQ(count_words("| a | 2 % |\n|---|---|"), 2);
    EXPECT_EQ(count_words("one two\nthree\tfour  five"), 5);
    EXPECT_EQ(count_words("\xc2\xb1"), 1);
}

TEST(DocumentCheck, FindsPagesOfTooManyWords) {
    for (const WordLimit& limit : word_limits()) {
        const std::string path = std::string(limit.path) + (limit.path.ends_with('/') ? "a.md" : "");
        EXPECT_TRUE(wordy_documents({make_file(path, words(limit.words))}).empty()) << path;
        EXPECT_EQ(wordy_documents({make_file(path, words(limit.words + 1))}).size(), 1u) << path;
    }
    EXPECT_TRUE(wordy_documents({make_file("src/core/README.md", words(20000))}).empty());
    EXPECT_TRUE(wordy_documents({make_file("docs/model/a.txt", words(20000))}).empty());
}

TEST(DocumentCheck, FindsReleasesOfTooManyWords) {
    const auto found = [](const std::string& text) { return wordy_releases(make_file("CHANGELOG.md", text)); };
    const std::string some = words(words_of_a_release), more = words(words_of_a_release + 1);
    EXPECT_TRUE(found("").empty());
    EXPECT_TRUE(found("# Changes\n" + more).empty()) << "of no release";
    EXPECT_TRUE(found("## 2\n" + some + "## 1\n" + some).empty());
    EXPECT_EQ(found("## 1\n" + more).size(), 1u);
    const auto second = found("# Changes\n\n## 2\n" + some + "## 1\n\n### Films\n" + more + "## 0");
    ASSERT_EQ(second.size(), 1u);
    EXPECT_EQ(second[0].line, 4 + words_of_a_release);
}

TEST(DocumentCheck, FindsFilesThatAreNamedAndMissing) {
    const auto names = [](const std::string& comment) {
        return missing_files({make_file("src/core/a.cpp", "// " + comment + "\nint docs;\n")}, support::source_folder())
            .size();
    };
    EXPECT_EQ(names("see docs/sources.md, docs/decisions, docs/model/lightcut, (docs/model/README.md). In docs/"), 0u);
    EXPECT_EQ(names("see docs/source.md and docs/model/9999."), 2u);
    EXPECT_EQ(names("see docs/model/irr and share/docs/a.md"), 1u);
    const auto page = [](const char* text) {
        return missing_files({make_file("docs/a.md", text)}, support::source_folder()).size();
    };
    EXPECT_EQ(page("`src/core/sampling.h`, `src/core`, `src/core/*.h`, `tests/checks/documents`"), 0u);
    EXPECT_EQ(page("`src/core/nothing.h` and `perceptual/nowhere/`, not build/src/nothing.h"), 2u);
}

}  // namespace
}  // namespace render2mpeg::checks
