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
                             " --stats " + stats.string() + options);
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    return {nlohmann::json::parse(contents(stats)), contents(output)};
}

double gather_rays(const Made& made) {
    return made.statistics.at("counts").at("gather_rays").get<double>();
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

TEST(Coupled, TheShareOfWhatIsHiddenSteersTheRays) {
    const Folder folder;
    const std::string rest = " --frames 0:3 --quantiser 8 --tolerance coupled=";
    EXPECT_LT(gather_rays(make(folder, plain_film(), rest + "1")),
              0.5 * gather_rays(make(folder, plain_film(), rest + "0.1")));
}

TEST(Coupled, TheLossThatIsAskedForSteersTheRaysSlow) {
    const Folder folder;
    const std::string rest = " --frames 0:1 --quantiser 8 --loss ";
    const Made fine = make(folder, film("cornell"), rest + "0.05"),
               coarse = make(folder, film("cornell"), rest + "1.5");
    EXPECT_LT(gather_rays(coarse), 0.7 * gather_rays(fine));
    const auto told = [](const Made& made, const char* what) {
        return made.statistics.at("light_loss").at(what).get<double>();
    };
    EXPECT_EQ(told(fine, "asked"), 0.05);
    EXPECT_EQ(told(fine, "pictures"), 2) << "I and P pictures are measured";
    EXPECT_LT(told(fine, "found"), 0.5 * told(coarse, "found"));
    EXPECT_LT(told(fine, "share"), 0.5 * told(coarse, "share"));
}

TEST(Coupled, PredictedPicturesHaveAShareOfTheirOwnSlow) {
    const Folder folder;
    const std::string rest = " --frames 0:4 --quantiser 8";
    const auto share = [](const Made& made, std::size_t frame) {
        return made.statistics.at("per_frame").at(frame).at("light_share").get<double>();
    };
    // What is left to code of a picture that is predicted mostly vanishes, and noise with it.
    const Made found = make(folder, film("cornell"), rest + " --loss 0.2");
    ASSERT_EQ(found.statistics.at("per_frame").at(4).at("type"), "P");
    EXPECT_GT(share(found, 4), 1.2 * share(found, 0));
    const Made told = make(folder, film("cornell"), rest + " --tolerance coupled=0.5");
    for (const std::size_t frame : {0u, 1u, 4u}) EXPECT_EQ(share(told, frame), 0.5) << frame;
}

TEST(Coupled, AFirstPictureLosesAboutWhatIsAskedForSlow) {
    const Folder folder;
    for (const char* name : {"cornell", "still_room"}) {
        const Made made = make(folder, film(name), " --frames 0:0 --quantiser 8 --loss 0.2");
        const double told = made.statistics.at("light_loss").at("found").get<double>();
        EXPECT_GT(told, 0.12) << name;
        EXPECT_LT(told, 0.35) << name;
    }
}

TEST(Coupled, PredictedPicturesAreMeasuredWhereTheCoderHoldsThemBackSlow) {
    const Folder folder;
    const auto stats = folder / "s.json";
    const auto outcome =
        run(support::program() + " render -y --hold " + film("cornell") + " -o " + (folder / "f.mp4").string() +
            " --stats " + stats.string() + " --size 64x64 --samples 1 --exposure 0 --quiet --codec hevc --quantiser 8" +
            " --b-pictures 0 --frames 0:2");
    ASSERT_EQ(outcome.status, 0) << outcome.output;
    const auto made = nlohmann::json::parse(contents(stats));
    EXPECT_EQ(made.at("light_loss").at("pictures"), 3);
    const auto& frames = made.at("per_frame");
    ASSERT_EQ(frames.at(2).at("type"), "P");
    // Each P picture tells the share of the next.
    EXPECT_NE(frames.at(2).at("light_share"), frames.at(1).at("light_share"));
}

TEST(Coupled, TheFilmDoesNotDependOnThreadsSlow) {
    const Folder folder;
    const std::string rest = " --frames 0:3 --gop 3 --threads ";
    EXPECT_EQ(make(folder, film("character"), rest + "1").bytes, make(folder, film("character"), rest + "4").bytes);
}

TEST(Coupled, NoChunkDependsOnTheOneBeforeSlow) {
    // Chunks begin on a grid from the first frame; the second one of 60 + 60 is the first one of what begins there.
    const Folder folder;
    const std::string tiny = " --b-pictures 0 --loss 2 --frames ";
    const Made both = make(folder, plain_film(), tiny + "0:62"), second = make(folder, plain_film(), tiny + "60:62");
    for (int i = 0; i < 3; ++i)
        for (const char* count : {"records_created", "shadow_rays", "indirect_cut"})
            EXPECT_EQ(both.statistics.at("per_frame").at(static_cast<std::size_t>(60 + i)).at(count),
                      second.statistics.at("per_frame").at(static_cast<std::size_t>(i)).at(count));
}

TEST(Coupled, AStillFilmIsLitOnceSlow) {
    const Folder folder;
    // Intra pictures, since quantisers of predicted ones depend on how much of their group is left.
    const Made made = make(folder, film("still_room"), " --frames 0:9 --gop 1 --tolerance coupled=0.5");
    const auto& frames = made.statistics.at("per_frame");
    const auto created = [&](std::size_t i) { return frames.at(i).at("records_created").get<double>(); };
    EXPECT_GT(created(0), 500);
    // The first look is rough: what it hid is found in the next.
    EXPECT_LT(created(1), 0.05 * created(0));
    for (std::size_t i = 6; i <= 9; ++i) EXPECT_EQ(created(i), 0) << i;
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
