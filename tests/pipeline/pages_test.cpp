#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "pipeline/fixture.h"
#include "support/written_page.h"

/// Pages that are made by running the program: the options of every command, and the examples' figures.
namespace render2mpeg::test {
namespace {

/// The commands that the program's own help lists, in its order.
std::vector<std::string> commands_of(const std::string& help) {
    static const std::regex row("\n  ([a-z]+) ");
    std::vector<std::string> commands;
    const std::string list = help.substr(std::min(help.find("\nSubcommands:"), help.size()));
    for (std::sregex_iterator it(list.begin(), list.end(), row), end; it != end; ++it) commands.push_back((*it)[1]);
    return commands;
}

TEST(Pages, OfCommandsAreWrittenToTheBuildFolderAndTheReadmeNamesEach) {
    const auto fenced = [](const std::string& text) { return "```text\n" + text + "```\n"; };
    const std::string help = run(program() + " --help").output;
    std::string page =
        "# Commands\n\n"
        "What `--help` prints, for the program and for each command.\n\n" +
        fenced(help);
    const auto commands = commands_of(help);
    EXPECT_GE(commands.size(), 7u);
    const std::string readme = contents(support::source_folder() / "README.md");
    for (const std::string& command : commands) {
        EXPECT_TRUE(std::regex_search(readme, std::regex("`" + command + "\\b"))) << command;
        page += "\n## " + command + "\n\n" + fenced(run(program() + " " + command + " --help").output);
    }
    support::write_page("commands.md", page);
}

/// What a page shows of a command: the line `<!-- example: ARGUMENTS -->`, then a fenced block.
struct Example {
    std::string arguments;
    std::size_t begin = 0, length = 0;  ///< of the block's inside
};

std::vector<Example> examples_of(const std::string& page) {
    static const std::regex form("<!-- example: ([^\n]*) -->\n```text\n");
    std::vector<Example> examples;
    for (std::sregex_iterator it(page.begin(), page.end(), form), end; it != end; ++it) {
        const auto begin = static_cast<std::size_t>(it->position() + it->length());
        examples.push_back({(*it)[1], begin, page.find("```\n", begin) - begin});
    }
    return examples;
}

/// Without what depends on time: measured seconds, and what is reckoned from them; and without a search's way, which
/// small differences turn.
std::string timeless(std::string text) {
    static const std::pair<std::regex, const char*> forms[] = {
        {std::regex("(^|\n)((?:fixed=|coupled|effort )[^ ]* +)[0-9.]+"), "$1$2T"},                 // cost: a row
        {std::regex("(?:saves |under )?[0-9]+ %(  (?:none|hardly|slight|visible))"), "T$1"},       // cost: an effect
        {std::regex("\nThe whole film on this machine's[^]*"), "\n"},                              //
        {std::regex("\n( +[0-9.]+)( +[0-9.]+)? +[0-9.]+( +[0-9.]+ +[0-9.]+ +0\\.)"), "\n$1 T$3"},  // tune: a row
        {std::regex("[0-9.]+ s of CPU"), "T s of CPU"},                                            //
        {std::regex("\n[^\n]*the same light(?=\n)"), ""},                                          // tune: a try
        {std::regex("(\n *[0-9.]+ T[^\n]*)(?:\n *[0-9.]+ T[^\n]*)+"), "$1"},  // tune: further tries
        {std::regex("(was\\s+asked\\s+for)[^]*?(render2mpeg render)"), "$1 $2"},
    };
    for (const auto& [form, with] : forms) text = std::regex_replace(text, form, with);
    return std::regex_replace(text, std::regex("\\s+"), " ");
}

/// Whether two words are the same, or numbers that processors may differ in: where they round reciprocals otherwise,
/// rays meet other records. Numbers of four digits and more within 4 %, shorter ones within 20 %.
bool are_alike(const std::string& a, const std::string& b) {
    static const std::regex form("([^0-9]*)([0-9]+(?:\\.[0-9]+)?)([^0-9]*)");
    std::smatch of_a, of_b;
    if (!std::regex_match(a, of_a, form) || !std::regex_match(b, of_b, form)) return a == b;
    if (of_a[1] != of_b[1] || of_a[3] != of_b[3]) return false;
    const double x = std::stod(of_a[2]), y = std::stod(of_b[2]);
    const bool exact = std::min(of_a[2].length(), of_b[2].length()) > 4;
    return std::abs(x - y) <= (exact ? 0.04 : 0.2) * std::max(x, y);
}

/// The first words of two texts that are not alike; empty: they all are.
std::string difference_of(const std::string& a, const std::string& b) {
    std::istringstream in_a(a), in_b(b);
    std::string word_a, word_b;
    while (true) {
        const bool more_a = static_cast<bool>(in_a >> word_a), more_b = static_cast<bool>(in_b >> word_b);
        if (!more_a && !more_b) return {};
        if (more_a != more_b || !are_alike(word_a, word_b)) return word_a + " and " + word_b;
    }
}

/// Runs a page's examples in a folder of their own, with the instruction set that every machine has.
void expect_examples(const std::string& path) {
    std::string page = contents(support::source_folder() / path);
    const auto examples = examples_of(page);
    ASSERT_FALSE(examples.empty()) << path;
    const Folder folder;
    std::filesystem::create_directory_symlink(support::source_folder() / "animations", folder / "animations");
    for (auto example = examples.rbegin(); example != examples.rend(); ++example) {
        std::string found =
            run("cd " + folder.path().string() + " && " + program() + " " + example->arguments + " 2>errors").output;
        found = std::regex_replace(found, std::regex("(^|\n)/[^ \n]*/render2mpeg "), "$1render2mpeg ");
        if (support::writes_pages())
            page.replace(example->begin, example->length, found);
        else
            EXPECT_EQ(
                difference_of(timeless("\n" + page.substr(example->begin, example->length)), timeless("\n" + found)),
                "")
                << found << path << " shows other figures than " << example->arguments
                << "\nRun this test with RENDER2MPEG_WRITE_PAGES=1 to write them anew.";
    }
    if (support::writes_pages()) support::expect_page(path, page);
}

TEST(ExamplesSlow, OfChoosingAreWhatIsFound) {
    expect_examples("docs/choosing.md");
}

TEST(Timeless, TextsDifferByWordsAndByNumbersThatAreFar) {
    EXPECT_EQ(difference_of("fixed=16% T 58 36.28 0.9855 (9 dB)", "fixed=16% T 60 36.90 0.9832 (10 dB)"), "");
    EXPECT_EQ(difference_of("cut 58", "cut 88"), "58 and 88");
    EXPECT_EQ(difference_of("36.28 dB", "38.28 dB"), "36.28 and 38.28");
    EXPECT_EQ(difference_of("visible", "hardly"), "visible and hardly");
    EXPECT_NE(difference_of("a b", "a b c"), "");
}

TEST(Timeless, IsWhatNoClockDecides) {
    EXPECT_EQ(timeless("\nfixed=16%     0.10     51     58\neffort low    0.17    110\n"),
              timeless("\nfixed=16%     10.1     51     58\neffort low    0.2    110\n"));
    EXPECT_NE(timeless("\nfixed=16%     0.10     51     58\n"), timeless("\nfixed=16%     0.10     52     58\n"));
    EXPECT_EQ(timeless("\n    60.0     0.22    0.003        166   42.85  0.9870\n"),
              timeless("\n    60.0     0.25    0.004        166   42.85  0.9870\n"));
    EXPECT_NE(timeless("\n    45.7     0.22    0.003        114   39.96  0.9770\n"),
              timeless("\n    45.7     0.22    0.003        115   39.96  0.9770\n"));
}

}  // namespace
}  // namespace render2mpeg::test
