#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "tests/support/places.h"
#include "tests/support/program.h"

/// Sources that scripts/tidy judges together.
namespace render2mpeg::checks {
namespace {

/// Three sources of two folders and how they are compiled, the second one's function wrong in its third line.
class Piles : public testing::Test {
  protected:
    void SetUp() override {
        const std::string root = folder_.path().string();
        std::string commands;
        for (const std::string name : {"a/first", "a/second", "b/third"}) {
            std::filesystem::create_directories((folder_ / name).parent_path());
            const std::string letter = name.substr(2, 1), file = root + "/" + name + ".cpp";
            std::ofstream(file) << "int " << letter << "(int n) {\n    int* p = n > 3 ? &n : nullptr;\n    return "
                                << (letter == "s" ? "*p" : "p != nullptr") << ";\n}\n";
            commands += std::string(commands.empty() ? "" : ",") + R"({"directory": ")" + root + R"(", "file": ")" +
                        file + R"(", "command": "c++ -o )" + letter + ".o -c " + file + R"("})";
        }
        std::ofstream(folder_ / "compile_commands.json") << "[" << commands << "]";
    }
    /// `changed`: names behind the number of lines that differ.
    std::string write(const std::vector<std::string>& changed, int most = 9) const {
        std::string names;
        for (const std::string& name : changed) names += name + "\\n";
        return support::run("cd " + folder_.path().string() + " && printf '" + names + "' | " + script_ + " . piles " +
                            std::to_string(most))
            .output;
    }
    const support::Folder folder_;
    const std::string script_ = (support::source_folder() / "scripts/piles").string();
};

TEST_F(Piles, HoldWhatIsChangedInAFolder) {
    EXPECT_EQ(write({"2 a/first.cpp", "1 a/second.cpp", "2 b/third.cpp", "1 b/gone.cpp"}), "");
    EXPECT_EQ(support::contents(folder_ / "piles/0.cpp"),
              support::contents(folder_ / "a/first.cpp") + support::contents(folder_ / "a/second.cpp"));
    EXPECT_EQ(support::contents(folder_ / "piles/1.cpp"), support::contents(folder_ / "b/third.cpp"));
    EXPECT_EQ(write({"1 a/second.cpp"}), "");
    EXPECT_EQ(support::contents(folder_ / "piles/0.cpp"), support::contents(folder_ / "a/second.cpp"));
    EXPECT_EQ(support::contents(folder_ / "piles/compile_commands.json").find("1.cpp"), std::string::npos);
    EXPECT_EQ(write({}), "");
    EXPECT_EQ(support::contents(folder_ / "piles/compile_commands.json"), "[]");
}

TEST_F(Piles, OfWhichMostLinesDifferAreJudgedAndTheOthersNamed) {
    EXPECT_EQ(write({"2 a/first.cpp", "1 b/third.cpp", "2 b/third.cpp"}, 1),
              "tidy: left out as those that changed least (1 sources): a/first.cpp\n");
    EXPECT_EQ(support::contents(folder_ / "piles/0.cpp"), support::contents(folder_ / "b/third.cpp"));
}

TEST_F(Piles, AreFollowedByTheAnalyzerThroughEachSource) {
    if (support::run("command -v clang-tidy-14").status != 0) GTEST_SKIP() << "clang-tidy-14 is not installed";
    ASSERT_EQ(write({"1 a/first.cpp", "1 a/second.cpp"}), "");
    const std::string said =
        support::run("cd " + folder_.path().string() +
                     " && clang-tidy-14 -p piles --quiet '--checks=-*,clang-analyzer-*' $PWD/piles/0.cpp | " + script_ +
                     " --name piles")
            .output;
    EXPECT_NE(said.find((folder_ / "a/second.cpp").string() + ":3:"), std::string::npos) << said;
    EXPECT_NE(said.find("clang-analyzer-core.NullDereference"), std::string::npos) << said;
    EXPECT_EQ(said.find("piles/0.cpp"), std::string::npos) << said;
}

}  // namespace
}  // namespace render2mpeg::checks
