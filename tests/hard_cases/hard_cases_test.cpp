#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <utility>

#include "core/error.h"
#include "tests/hard_cases/hard_case.h"
#include "tests/hard_cases/proof.h"
#include "tests/support/places.h"
#include "tests/support/written_page.h"

namespace render2mpeg::test {
namespace {

struct Chapter {
    const char* title;
    std::vector<HardCase> cases;
};

const std::vector<Chapter>& chapters() {
    static const std::vector<Chapter> all = {{"Lights", light_cases()},
                                             {"Surfaces", surface_cases()},
                                             {"Materials", material_cases()},
                                             {"Motion and time", motion_cases()},
                                             {"Cameras and pictures", view_cases()},
                                             {"Shutter and lens", exposure_cases()},
                                             {"Air", air_cases()}};
    return all;
}

std::vector<const HardCase*> all_cases() {
    std::vector<const HardCase*> cases;
    for (const Chapter& chapter : chapters())
        for (const HardCase& hard_case : chapter.cases) cases.push_back(&hard_case);
    return cases;
}

/// What holds whatever the case is about.
void expect_sound(const HardCase& hard_case, const Lit& film) {
    EXPECT_EQ(film.statistics.non_finite, 0u) << film.statistics.first_non_finite;
    ASSERT_EQ(film.frames.size(), static_cast<std::size_t>(hard_case.frames));
    EXPECT_EQ(film.decoded.size(), film.frames.size());
    for (const core::Radiance& frame : film.frames)
        for (const glm::vec3& value : frame.combined.values())
            for (int k = 0; k < 3; ++k) {
                ASSERT_TRUE(std::isfinite(value[k]) && value[k] >= 0) << value[k];
                ASSERT_LE(value[k], hard_case.brightest);
            }
}

class HardCases : public testing::TestWithParam<const HardCase*> {};

void expect_outcome(const HardCase& hard_case, Way way) {
    SCOPED_TRACE(name_of(way));
    if (!hard_case.refused.empty()) {
        try {
            lit(hard_case, hard_case.scene(), way);
            FAIL() << "not refused";
        } catch (const core::Error& error) {
            EXPECT_NE(std::string(error.what()).find(hard_case.refused), std::string::npos) << error.what();
        }
        return;
    }
    const Lit film = lit(hard_case, hard_case.scene(), way);
    expect_sound(hard_case, film);
    if (hard_case.check && !testing::Test::HasFatalFailure()) hard_case.check(film);
}

/// The way that is tried each time: one of the two by rays and records, in turn.
Way usual_way(const HardCase& hard_case) {
    static const std::vector<const HardCase*> cases = all_cases();
    const auto place = std::find(cases.begin(), cases.end(), &hard_case) - cases.begin();
    return place % 2 == 0 ? Way::records : Way::coupled;
}

TEST_P(HardCases, HaveTheOutcomeThatIsRight) {
    expect_outcome(*GetParam(), usual_way(*GetParam()));
}

TEST_P(HardCases, HaveTheOutcomeThatIsRightInEveryWaySlow) {
    if (!GetParam()->refused.empty()) return;  // before any light
    for (const Way way : all_ways)
        if (way != usual_way(*GetParam())) expect_outcome(*GetParam(), way);
}

std::string identifier(const testing::TestParamInfo<const HardCase*>& info) {
    std::string name;
    bool starts = true;
    for (const char c : info.param->name) {
        if (std::isalnum(static_cast<unsigned char>(c)))
            name += starts ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
        starts = c == ' ' || c == '-';
    }
    return name;
}

INSTANTIATE_TEST_SUITE_P(Each, HardCases, testing::ValuesIn(all_cases()), identifier);

struct ProofChapter {
    const char* title;
    std::vector<Proof> proofs;
};

const std::vector<ProofChapter>& proof_chapters() {
    static const std::vector<ProofChapter> all = {
        {"Numbers, one by one", numeric_proofs()}, {"Files and runs", file_proofs()}, {"Coding", coding_proofs()}};
    return all;
}

/// The file of each test in tests/, by "Suite.Name".
std::map<std::string, std::string> files_of_tests() {
    std::map<std::string, std::string> files;
    const std::regex head(R"(\nTEST(?:_F|_P)?\((\w+),\s*(\w+)\))");
    for (const auto& entry : std::filesystem::recursive_directory_iterator(support::source_folder() / "tests")) {
        if (!entry.path().filename().string().ends_with("_test.cpp")) continue;
        std::ostringstream written;
        written << std::ifstream(entry.path()).rdbuf();
        const std::string text = written.str();
        for (std::sregex_iterator at(text.begin(), text.end(), head), end; at != end; ++at)
            files[(*at)[1].str() + "." + (*at)[2].str()] =
                std::filesystem::relative(entry.path(), support::source_folder()).generic_string();
    }
    return files;
}

std::string rows_of(const std::vector<Proof>& proofs) {
    const std::map<std::string, std::string> files = files_of_tests();
    std::string text;
    for (const Proof& proof : proofs) {
        text += "| " + proof.name + " | " + proof.outcome + " | ";
        const char* between = "";
        for (const std::string& name : proof.cases) text += std::exchange(between, "; ") + name;
        for (const std::string& name : proof.tests) {
            const auto file = files.find(name);
            text += std::exchange(between, "; ") + name + " (" + (file == files.end() ? "" : file->second) + ")";
        }
        text += " |\n";
    }
    return text;
}

TEST(HardCasesPage, NamesOnlyTestsThatAreThere) {
    const std::map<std::string, std::string> files = files_of_tests();
    std::set<std::string> cases;
    for (const HardCase* hard_case : all_cases()) cases.insert(hard_case->name);
    for (const ProofChapter& chapter : proof_chapters())
        for (const Proof& proof : chapter.proofs) {
            EXPECT_FALSE(proof.cases.empty() && proof.tests.empty()) << proof.name;
            for (const std::string& name : proof.cases) EXPECT_TRUE(cases.contains(name)) << name;
            for (const std::string& name : proof.tests) EXPECT_TRUE(files.contains(name)) << name;
        }
}

std::string page() {
    std::ostringstream text;
    text
        << "# Hard cases\n\n"
           "Scenes in which careless arithmetic fails, and what render2mpeg does with them. Each is lit by rays and "
           "records\n"
           "within 2 % and coupled to its coding, by cuts within 2 %, and without clustering. In each, all "
           "radiance is\n"
           "finite and not negative, and libavcodec decodes the film to the encoder's reconstruction, bit for bit.\n\n"
           "`tests/hard_cases` proves this page and writes it. The last three tables name the tests that prove what no "
           "scene\n"
           "can show. Files of strangers: `docs/fuzzing.md`.\n";
    for (const Chapter& chapter : chapters()) {
        text << "\n## " << chapter.title << "\n\n| case | what goes wrong without care | outcome |\n|---|---|---|\n";
        for (const HardCase& hard_case : chapter.cases)
            text << "| " << hard_case.name << " | " << hard_case.breaks << " | "
                 << (hard_case.refused.empty() ? "" : "refused: ") << hard_case.outcome << " |\n";
    }
    for (const ProofChapter& chapter : proof_chapters())
        text << "\n## " << chapter.title << "\n\n| case | outcome | proven by |\n|---|---|---|\n"
             << rows_of(chapter.proofs);
    return text.str();
}

TEST(HardCasesPage, NamesAnOutcomeOfEachCaseAndIsWrittenToTheBuildFolder) {
    for (const HardCase* hard_case : all_cases()) EXPECT_FALSE(hard_case->outcome.empty()) << hard_case->name;
    for (const ProofChapter& chapter : proof_chapters())
        for (const Proof& proof : chapter.proofs) EXPECT_FALSE(proof.outcome.empty()) << proof.name;
    support::write_page("hard-cases.md", page());
}

}  // namespace
}  // namespace render2mpeg::test
