#include <gtest/gtest.h>

#include <utility>

#include "pipeline/fixture.h"

/// Films of every preset, as foreign tools see them.
namespace render2mpeg::test {
namespace {

struct Case {
    const char *preset, *output;
    int width, height;
    const char *rate, *name_of_rate, *declared;  ///< as Y4M, as text, as a fraction
    const char *shape, *level;
    bool pulldown;
};

const Case cases[] = {
    {"dvd-ntsc", "a.mpg", 720, 480, "24000:1001", "23.976", "30000/1001", "16:9", "Main", true},
    {"dvd-ntsc", "a.mpg", 720, 480, "30000:1001", "29.97", "30000/1001", "4:3", "Main", false},
    {"dvd-pal", "a.vob", 720, 576, "25:1", "25", "25/1", "16:9", "Main", false},
    {"atsc", "a.ts", 1280, 720, "60000:1001", "59.94", "60000/1001", "16:9", "High", false},
    {"atsc", "a.ts", 704, 480, "24:1", "24", "24/1", "4:3", "Main", false},
};

TEST(PresetSlow, FilmsAreForeignToolsWhatTheirHeadersSay) {
    for (const Case& c : cases) {
        SCOPED_TRACE(std::string(c.preset) + " " + c.name_of_rate);
        const Folder folder;
        constexpr int frames = 29;
        write_frames(path(folder, "in.y4m"), c.width, c.height, c.rate, "", frames);
        const std::string output = path(folder, c.output);
        const auto made = run(program() + " encode -y " + path(folder, "in.y4m") + " --for " + c.preset +
                              " --quiet --quantiser 6 --display-aspect " + c.shape + " -o " + output + " --stats " +
                              path(folder, "s.json"));
        ASSERT_EQ(made.status, 0) << made.output;
        const json statistics = json::parse(contents(folder / "s.json"));
        EXPECT_EQ(statistics.at("cadence"), c.pulldown                        ? "pulldown"
                                            : std::string(c.preset) == "atsc" ? "frames"
                                                                              : "fields");

        const json video = mediainfo(output);
        EXPECT_EQ(video.at("Format_Version"), "2");
        EXPECT_EQ(video.at("Format_Profile"), "Main");
        EXPECT_EQ(video.at("Format_Level"), c.level);
        EXPECT_EQ(video.at("Width"), std::to_string(c.width));
        EXPECT_EQ(video.at("Height"), std::to_string(c.height));
        EXPECT_NEAR(std::stod(video.at("DisplayAspectRatio").get<std::string>()),
                    std::string(c.shape) == "4:3" ? 4.0 / 3 : 16.0 / 9, 0.001);
        EXPECT_NEAR(std::stod(video.at("FrameRate").get<std::string>()), std::stod(c.name_of_rate), 0.001);
        EXPECT_EQ(video.at("ScanType"), "Progressive");
        EXPECT_EQ(video.value("ScanOrder", ""), c.pulldown                        ? "2:3 Pulldown"
                                                : std::string(c.preset) == "atsc" ? ""
                                                                                  : "TFF");
        EXPECT_EQ(video.value("BitRate_Maximum", ""), std::string(c.preset) != "atsc" ? "9000000"
                                                      : c.width == 704                ? "15000000"
                                                                                      : "17500000");
        const json probe = ffprobe(output);
        EXPECT_EQ(probe.at("nb_read_frames"), std::to_string(frames));
        EXPECT_EQ(probe.at("display_aspect_ratio"), c.shape);
        if (!c.pulldown) {
            EXPECT_EQ(probe.at("r_frame_rate"), c.declared);
        }
        // Its own rate, in whatever time base.
        EXPECT_NEAR(std::stod(probe.at("duration").get<std::string>()), frames / std::stod(c.name_of_rate), 0.05);
    }
}

TEST(PresetSlow, DvdStreamsPassAModelOfTheDiscsBufferAndAuthoring) {
    for (const Case& c : cases) {
        if (std::string(c.preset) == "atsc") continue;
        SCOPED_TRACE(std::string(c.preset) + " " + c.name_of_rate);
        const Folder folder;
        write_frames(path(folder, "in.y4m"), c.width, c.height, c.rate, "", 28);
        const auto encode = [&](int quantiser, const std::string& name) {
            return run(program() + " encode -y " + path(folder, "in.y4m") + " --for " + c.preset +
                       " --quiet --quantiser " + std::to_string(quantiser) + " --display-aspect " + c.shape + " -o " +
                       path(folder, name))
                .status;
        };
        // At quantiser 1 the limits bind: the stream begins with its buffer as full as it declares, for which mplex
        // has to wait longer than the 80 to 100 ms of its own choice.
        for (const auto& [quantiser, wait] : {std::pair{4, ""}, {1, "-R 8 "}}) {
            ASSERT_EQ(encode(quantiser, "a.m2v"), 0);
            const auto mplex =
                run("mplex -f 8 " + std::string(wait) + "-o " + path(folder, "b.mpg") + " " + path(folder, "a.m2v"));
            EXPECT_EQ(mplex.status, 0);
            EXPECT_NE(mplex.output.find("no under-runs detected"), std::string::npos) << mplex.output;
        }
        ASSERT_EQ(encode(1, "a.mpg"), 0);
        const std::string author = "HOME=" + folder.path().string() +
                                   " VIDEO_FORMAT=" + (c.height == 576 ? "PAL" : "NTSC") + " dvdauthor -o " +
                                   path(folder, "disc");
        const auto title = run(author + " -t " + path(folder, "a.mpg")), toc = run(author + " -T");
        EXPECT_EQ(title.status, 0) << title.output;
        EXPECT_EQ(toc.status, 0) << toc.output;
        EXPECT_EQ(title.output.find("WARN"), std::string::npos) << title.output;
        EXPECT_NE(title.output.find("Aspect ratio: " + std::string(c.shape)), std::string::npos) << title.output;
    }
}

}  // namespace
}  // namespace render2mpeg::test
