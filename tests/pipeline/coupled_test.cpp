#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/fixture.h"

/// The loop closed: what was coded steers what is lit next.
namespace render2mpeg::test {
namespace {

const std::string one_sample = " --size 48x32 --samples 1 --exposure 0 --quiet";

struct Made {
    nlohmann::json statistics;
    std::string bytes;
};

Made make(const Folder& folder, const std::string& name, const std::string& options) {
    const auto output = folder / "film.m2v", stats = folder / "s.json";
    const auto outcome = run(support::program() + " render -y --hold " + name + " -o " + output.string() + one_sample +
                             " --stats " + stats.string() + " --indirect lightcuts" +
                             (options.find("--vpls") == std::string::npos ? " --vpls 128" : "") + options);
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    return {nlohmann::json::parse(contents(stats)), contents(output)};
}

double cut_of(const nlohmann::json& entry) {
    return entry.at("direct_cut").get<double>() + entry.at("indirect_cut").get<double>();
}
double mean_cut(const Made& made) {
    const auto& cut = made.statistics.at("mean_cut");
    return cut.at("direct").get<double>() + cut.at("indirect").get<double>();
}

TEST(Coupled, CoarserQuantisersMakeSmallerCutsSlow) {
    const Folder folder;
    double before = 1e9;
    for (const char* quantiser : {"1", "6", "31"}) {
        const double now = mean_cut(
            make(folder, plain_film(), " --frames 0:3 --tolerance coupled=0.5 --quantiser " + std::string(quantiser)));
        EXPECT_LT(now, before) << quantiser;
        before = now;
    }
}

TEST(Coupled, ACutThatTheRateCannotAffordIsAPredictedPictureSlow) {
    // The view changes at frame 36, and an I picture there would break the buffer.
    const Folder folder;
    const auto stats = folder / "s.json";
    const auto outcome = run(support::program() + " render -y --hold " + film("flash_cut") + " -o " +
                             (folder / "f.m2v").string() + " --stats " + stats.string() +
                             " --size 160x128 --samples 1 --vpls 0 --exposure 0 --frames 28:38 --quiet --gop 100" +
                             " --b-pictures 0 --bitrate 20k --maxrate 20k --vbv 17k --passes 1");
    ASSERT_EQ(outcome.status, 0) << outcome.output;
    const auto frames = nlohmann::json::parse(contents(stats)).at("per_frame");
    ASSERT_EQ(frames.size(), 11u);
    EXPECT_EQ(frames[8].at("type"), "P");
}

TEST(Coupled, TheShareOfWhatIsHiddenSteersTheCut) {
    const Folder folder;
    const std::string rest = " --frames 0:3 --quantiser 8 --tolerance coupled=";
    EXPECT_LT(mean_cut(make(folder, plain_film(), rest + "1")), mean_cut(make(folder, plain_film(), rest + "0.1")));
}

TEST(Coupled, TheFilmDoesNotDependOnThreadsSlow) {
    const Folder folder;
    const std::string rest = " --frames 0:3 --gop 3 --vpls 64 --tolerance coupled=0.5 --threads ";
    EXPECT_EQ(make(folder, film("character"), rest + "1").bytes, make(folder, film("character"), rest + "4").bytes);
}

TEST(Coupled, NoChunkDependsOnTheOneBeforeSlow) {
    // Chunks begin on a grid from the first frame; the second one of 60 + 60 is the first one of what begins there.
    const Folder folder;
    const std::string tiny = " --vpls 16 --b-pictures 0 --tolerance coupled=1 --frames ";
    const Made both = make(folder, plain_film(), tiny + "0:62"), second = make(folder, plain_film(), tiny + "60:62");
    for (int i = 0; i < 3; ++i)
        EXPECT_EQ(cut_of(both.statistics.at("per_frame").at(static_cast<std::size_t>(60 + i))),
                  cut_of(second.statistics.at("per_frame").at(static_cast<std::size_t>(i))));
}

TEST(Coupled, CutsOfAStillFilmStayTheSameSlow) {
    const Folder folder;
    // Intra pictures, since quantisers of predicted ones depend on how much of their group is left.
    const Made made = make(folder, film("still_room"), " --frames 0:14 --gop 1 --tolerance coupled=0.5");
    const auto& frames = made.statistics.at("per_frame");
    for (std::size_t i = 11; i <= 14; ++i) EXPECT_NEAR(cut_of(frames.at(i)) / cut_of(frames.at(i - 1)), 1.0, 0.01) << i;
}

TEST(Coupled, OnlyFilmsHaveACodingToCoupleTo) {
    const Folder folder;
    const auto outcome = run(support::program() + " render -y --hold " + plain_film() + " -o " +
                             (folder / "f.%04d.png").string() + one_sample + " --frames 0:0 --tolerance coupled");
    EXPECT_TRUE(outcome.status == 1 || outcome.status == 2);
    EXPECT_NE(outcome.output.find("fixed=P%"), std::string::npos) << outcome.output;
    for (const char* wrong : {"coupled=0", "coupled=-1", "coupled=x", "coupled=1e9", "coupled="})
        EXPECT_NE(run(support::program() + " render -y --hold " + plain_film() + " -o " + (folder / "a.mpg").string() +
                      " --tolerance " + wrong)
                      .status,
                  0)
            << wrong;
}

}  // namespace
}  // namespace render2mpeg::test
