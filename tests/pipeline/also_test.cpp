#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "pipeline/fixture.h"

/// --also: other films of the same light.
namespace render2mpeg::test {
namespace {

std::string rendering(const Folder& folder, const std::string& film, const std::string& more) {
    return program() + " render " + plain_film() + " --frames 0:6 --gop 3 --size 96x64 --exposure 0 --quiet -o " +
           path(folder, film) + " " + more;
}

TEST(AlsoFilms, InTheSameViewHaveTheSameBytesSlow) {
    const Folder folder;
    const auto outcome = run(rendering(folder, "a.mp4",
                                       "--also neutral " + path(folder, "b.mp4") + " --also pq " +
                                           path(folder, "c.mkv") + " --also agx:ffv1 " + path(folder, "d.mkv")));
    ASSERT_EQ(outcome.status, 0) << outcome.output;
    EXPECT_EQ(contents(path(folder, "a.mp4")), contents(path(folder, "b.mp4")));
    EXPECT_EQ(ffprobe(path(folder, "c.mkv")).value("color_transfer", ""), "smpte2084");
    EXPECT_EQ(ffprobe(path(folder, "d.mkv")).value("codec_name", ""), "ffv1");
    EXPECT_EQ(ffprobe(path(folder, "d.mkv")).value("nb_read_frames", ""), "7");
    ASSERT_EQ(run(rendering(folder, "e.mp4", "")).status, 0);
    EXPECT_EQ(contents(path(folder, "a.mp4")), contents(path(folder, "e.mp4"))) << "nothing beside changes a film";
}

TEST(AlsoFilms, OfFarmsAreThoseOfOneRunSlow) {
    const Folder folder;
    const std::string what = plain_film() + " --frames 0:61 --hold --gop 5 --size 64x48 --exposure 0 --quiet -o ";
    ASSERT_EQ(run(program() + " render " + what + path(folder, "a.mp4") + " --also pq " + path(folder, "b.mp4")).status,
              0);
    const std::string farm = path(folder, "c.mp4.farm");
    const auto planned = run(program() + " farm " + what + path(folder, "c.mp4") + " --also pq " +
                             path(folder, "d.mp4") + " --to parallel --parts 2 --pack");
    ASSERT_EQ(planned.status, 0) << planned.output;
    for (const char* part : {"1", "2"}) {
        const auto made = run(program() + " part " + farm + " " + part);
        ASSERT_EQ(made.status, 0) << made.output;
    }
    const auto joined = run(program() + " join " + farm);
    ASSERT_EQ(joined.status, 0) << joined.output;
    EXPECT_EQ(contents(path(folder, "a.mp4")), contents(path(folder, "c.mp4")));
    EXPECT_EQ(contents(path(folder, "b.mp4")), contents(path(folder, "d.mp4")));
}

TEST(AlsoFilms, HaveTheExposureThatIsMeasuredAndThePeakThatIsAskedForSlow) {
    const Folder folder;
    const std::string what = program() + " render " + plain_film() + " --frames 0:2 --size 64x48 --quiet ";
    const auto made = run(what + "-o " + path(folder, "a.mp4") + " --also neutral " + path(folder, "b.mp4") +
                          " --also pq " + path(folder, "c.mp4") + " --peak 700");
    ASSERT_EQ(made.status, 0) << made.output;
    EXPECT_EQ(contents(path(folder, "a.mp4")), contents(path(folder, "b.mp4")));
    EXPECT_NE(run(program() + " info " + path(folder, "c.mp4")).output.find("white of 700 cd/m2"), std::string::npos);
    const auto other = run(what + "-o " + path(folder, "a.mp4") + " --also neutral " + path(folder, "b.mp4") +
                           " --also hlg " + path(folder, "c.mp4") + " --resume");
    EXPECT_NE(other.status, 0) << "another film beside it is another film: " << other.output;
    const auto usual = run(what + "--view pq -o " + path(folder, "d.mp4"));
    ASSERT_EQ(usual.status, 0) << usual.output;
    EXPECT_EQ(ffprobe(path(folder, "d.mp4")).value("codec_name", ""), "hevc");
}

TEST(AlsoFilms, HaveTheFilmsSoundAndHeatmapsNoneSlow) {
    const Folder folder;
    ASSERT_EQ(run("ffmpeg -v error -f lavfi -i sine=d=1 " + path(folder, "s.wav")).status, 0);
    const auto made = run(rendering(folder, "a.mp4",
                                    "--audio " + path(folder, "s.wav") + " --also neutral " + path(folder, "b.mp4") +
                                        " --heatmap tolerance " + path(folder, "h.m2v")));
    ASSERT_EQ(made.status, 0) << made.output;
    EXPECT_EQ(contents(path(folder, "a.mp4")), contents(path(folder, "b.mp4")));
}

TEST(AlsoFilms, BesideImagesHaveTheirLabels) {
    const Folder folder;
    const auto made = run(program() + " render " + plain_film() +
                          " --frames 0:1 --size 63x47 --exposure 0 --quiet -o " + path(folder, "a.%04d.png") +
                          " --also neutral " + path(folder, "b.mov") + " --title Dawn --timecode 01:00:00:07");
    ASSERT_EQ(made.status, 0) << made.output;
    const auto told = run(program() + " info " + path(folder, "b.mov"));
    EXPECT_NE(told.output.find("title      Dawn"), std::string::npos) << told.output;
    EXPECT_NE(told.output.find("timecode   01:00:00:07"), std::string::npos) << told.output;
    EXPECT_EQ(ffprobe(path(folder, "b.mov")).value("width", 0), 64) << "H.264 has even sides, and so has its light";
}

TEST(AlsoFilms, AreRefusedInOneLine) {
    const Folder folder;
    const auto refused = [&](const std::string& words, const std::string& why) {
        const auto outcome = run(rendering(folder, "a.mp4", words));
        EXPECT_NE(outcome.status, 0) << words;
        EXPECT_NE(outcome.output.find(why), std::string::npos) << outcome.output;
        EXPECT_FALSE(std::filesystem::exists(folder / "a.mp4"));
    };
    refused("--also warm " + path(folder, "b.mp4"), "view warm: expected one of neutral");
    refused("--also pq:vvc " + path(folder, "b.mp4"), "vvc is no codec");
    refused("--also pq:h264 " + path(folder, "b.mp4"), "H.264 films are not of high dynamic range");
    refused("--also neutral " + path(folder, "a.mp4"), "two outputs have this name");
    ASSERT_EQ(run("ffmpeg -v error -f lavfi -i sine=d=1 " + path(folder, "s.wav")).status, 0);
    refused("--audio " + path(folder, "s.wav") + " --also neutral " + path(folder, "b.m2v"), "has no sound");
    refused("--also neutral", "expected what to show and a file");
}

}  // namespace
}  // namespace render2mpeg::test
