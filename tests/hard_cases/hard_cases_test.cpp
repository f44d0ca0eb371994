#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "core/error.h"
#include "tests/hard_cases/hard_case.h"
#include "tests/support/places.h"

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
                                             {"Cameras and pictures", view_cases()}};
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

TEST_P(HardCases, HaveTheOutcomeThatIsRight) {
    const HardCase& hard_case = *GetParam();
    for (const Way way : all_ways) {
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
        if (hard_case.check && !HasFatalFailure()) hard_case.check(film);
    }
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

std::string page() {
    std::ostringstream text;
    text << "# Hard cases\n\n"
            "Scenes in which careless arithmetic fails, and what comes of them here. Every one is lit without "
            "clustering, by both\n"
            "stopping rules at 2 %, from records on surfaces, and coupled to its coding; in each, all radiance is finite and not negative, and "
            "libavcodec decodes\n"
            "the film to what the encoder reconstructed, bit for bit. `tests/hard_cases` proves this page and writes "
            "it\n"
            "(`RENDER2MPEG_WRITE_PAGES=1 test_hard_cases`); [the encoder's own](../tests/encoder/hard_cases_test.cpp) "
            "and those of\n"
            "files ([0007](decisions/0007-broken-corners-are-refused.md)) have tests of their own.\n";
    for (const Chapter& chapter : chapters()) {
        text << "\n## " << chapter.title
             << "\n\n| case | what goes wrong where nobody took care | outcome |\n|---|---|---|\n";
        for (const HardCase& hard_case : chapter.cases)
            text << "| " << hard_case.name << " | " << hard_case.breaks << " | "
                 << (hard_case.refused.empty() ? "" : "refused: ") << hard_case.outcome << " |\n";
    }
    return text.str();
}

TEST(HardCasesPage, SaysWhatTheTestsProve) {
    const auto file = support::source_folder() / "docs" / "hard-cases.md";
    if (std::getenv("RENDER2MPEG_WRITE_PAGES") != nullptr) std::ofstream(file) << page();
    std::ostringstream written;
    written << std::ifstream(file).rdbuf();
    EXPECT_EQ(written.str(), page());
}

}  // namespace
}  // namespace render2mpeg::test
