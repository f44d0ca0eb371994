#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "pipeline/fixture.h"

/// Films for editors: ProRes, DNxHR, FFV1, lossless H.264.
namespace render2mpeg::test {
namespace {

struct Master {
    const char *codec, *ending, *pixels, *tag, *smallest;
    double error;  ///< mean of R, G, B, of 255, that its coding may leave in these pictures
};

class Masters : public testing::TestWithParam<Master> {
  protected:
    std::string file(const std::string& name) const { return path(folder_, name + GetParam().ending); }
    /// Codes numbered PNG.
    support::Outcome encode(const std::string& name, const std::string& more = "") const {
        return run(program() + " encode " + path(folder_, "g.%02d.png") +
                   " --view standard --quiet -y --fps 25 --codec " + GetParam().codec + " -o " + file(name) + " " +
                   more);
    }
    /// Soft stripes of colour that move.
    void write_stripes(int frames) const {
        std::ofstream raw(path(folder_, "g.raw"), std::ios::binary);
        for (int n = 0; n < frames; ++n)
            for (int y = 0; y < height; ++y)
                for (int x = 0; x < width; ++x)
                    for (int c = 0; c < 3; ++c)
                        raw.put(static_cast<char>(128 +
                                                  std::lround(100 * std::sin(0.05 * (x + 3 * n) + 0.02 * y + 2 * c))));
        raw.close();
        const auto made = run("ffmpeg -v error -f rawvideo -pix_fmt rgb24 -s " + std::to_string(width) + "x" +
                              std::to_string(height) + " -i " + path(folder_, "g.raw") + " -start_number 0 " +
                              path(folder_, "g.%02d.png"));
        ASSERT_EQ(made.status, 0) << made.output;
    }
    /// Chroma stands on the even columns, which ffmpeg does not know of 4:2:2.
    std::string rgb(const std::string& film) const {
        return run("ffmpeg -v error -err_detect explode -i " + film +
                   " -vf scale=in_h_chr_pos=0:flags=accurate_rnd+full_chroma_int -f rawvideo -pix_fmt rgb24 -")
            .output;
    }

    static constexpr int width = 256, height = 720;
    const Folder folder_;
};

TEST_P(Masters, HoldTheFramesWithTheirColoursSoundAndTime) {
    write_stripes(3);
    ASSERT_EQ(run("ffmpeg -v error -f lavfi -i sine=d=0.2:r=48000 " + path(folder_, "s.wav")).status, 0);
    const auto made = encode("m", "--audio " + path(folder_, "s.wav"));
    ASSERT_EQ(made.status, 0) << made.output;
    const json stream = ffprobe(file("m"));
    EXPECT_EQ(stream.value("pix_fmt", ""), GetParam().pixels);
    EXPECT_EQ(stream.value("nb_read_frames", ""), "3");
    if (*GetParam().tag != '\0') {
        EXPECT_EQ(stream.value("codec_tag_string", ""), GetParam().tag);
        EXPECT_EQ(stream.at("tags").value("timecode", ""), "00:00:00:00");
    }
    EXPECT_EQ(stream.value("color_primaries", ""), "bt709");
    EXPECT_EQ(stream.value("color_space", ""), "bt709");
    EXPECT_NE(stream.value("color_transfer", "unknown"), "unknown");
    const auto sound =
        run("ffprobe -v error -select_streams a -show_entries stream=codec_name -of csv=p=0 " + file("m"));
    EXPECT_EQ(sound.output, "pcm_s24le\n");

    const std::string decoded = rgb(file("m")), drawn = contents(folder_ / "g.raw");
    ASSERT_EQ(decoded.size(), drawn.size());
    double sum = 0;
    for (std::size_t i = 0; i < drawn.size(); ++i)
        sum += std::abs(static_cast<unsigned char>(decoded[i]) - static_cast<unsigned char>(drawn[i]));
    EXPECT_LT(sum / static_cast<double>(drawn.size()), GetParam().error);
}

TEST_P(Masters, AreReadByInfoAndMadeOfPicturesThatStandAlone) {
    write_frames(path(folder_, "f.y4m"), width, height, "25:1", "", 3);
    ASSERT_EQ(run(program() + " encode " + path(folder_, "f.y4m") + " --quiet --codec " + GetParam().codec + " -o " +
                  file("m"))
                  .status,
              0);
    const auto told = run(program() + " info --summary --json " + file("m"));
    ASSERT_EQ(told.status, 0) << told.output;
    const json info = json::parse(told.output);
    const std::string codec = GetParam().codec;
    EXPECT_EQ(info.at("codec"), codec.substr(0, codec.find("_lossless"))) << "streams do not say what was lost";
    EXPECT_EQ(info.at("pictures"), 3);
    EXPECT_EQ(info.at("groups").at("count"), 3);
    const auto text = run(program() + " info --summary " + file("m"));
    EXPECT_NE(text.output.find("devices    not on browsers, phones, televisions"), std::string::npos) << text.output;
}

TEST_P(Masters, RefuseRatesTheyDoNotHave) {
    write_frames(path(folder_, "f.y4m"), width, height, "25:1", "", 1);
    for (const char* option : {"--crf 4", "--quality 60", "--bitrate 4M", "--quantiser 2", "--level 4.1"}) {
        const auto refused = run(program() + " encode " + path(folder_, "f.y4m") + " --quiet --codec " +
                                 GetParam().codec + " -o " + file("m") + " " + option);
        EXPECT_NE(refused.status, 0) << option;
        EXPECT_NE(refused.output.find("has its own rate; leave it out"), std::string::npos) << refused.output;
        EXPECT_EQ(std::count(refused.output.begin(), refused.output.end(), '\n'), 1) << refused.output;
    }
    const auto elsewhere = run(program() + " encode " + path(folder_, "f.y4m") + " --quiet --codec " +
                               GetParam().codec + " -o " + path(folder_, "m.mpg"));
    EXPECT_NE(elsewhere.output.find("m.mpg: such files have no "), std::string::npos) << elsewhere.output;
    const bool has_several = GetParam().codec == std::string("h264_lossless");
    const std::string homes = has_several ? "; .mp4 and .mov have" : std::string("; ") + GetParam().ending + " has";
    EXPECT_NE(elsewhere.output.find(homes), std::string::npos) << elsewhere.output;
    EXPECT_EQ(folder_.entries(), 1u) << "nothing was written";
}

TEST_P(Masters, AreTheSameForAnyThreadsAfterAKillAndOfPartsSlow) {
    const std::string size = GetParam().smallest, away = size == "64x48" ? "3" : "9";  // rays at the box are dear
    std::ofstream(folder_ / "scene.json") << R"({ "camera": { "position": [0, 0, )" << away
                                          << R"(] }, "sky": 1, "exposure": 0, "objects": [{ "shape": "box" }] })";
    // Two chunks, of 41 frames and of three.
    const std::string what = path(folder_, "scene.json") + " --size " + size +
                             " --gop 41 --frames 0:43 --samples 1 --tolerance fixed=50% --hold --quiet --codec " +
                             GetParam().codec;
    const auto render = [&](const std::string& name, const std::string& more) {
        return run(program() + " render -y " + what + " -o " + file(name) + " " + more);
    };
    ASSERT_EQ(render("a", "--threads 1").status, 0);
    const std::string whole = contents(file("a"));
    const std::string record = file("c") + ".partial/chunk_00000.json";
    render("c", "--threads 3 & job=$!; while [ ! -s " + record +
                    " ]; do kill -0 $job || exit 99; sleep 0.01; done; kill -KILL $job; "
                    "wait");
    if (!std::filesystem::exists(file("c"))) {
        ASSERT_EQ(render("c", "--resume").status, 0);
    }
    EXPECT_TRUE(whole == contents(file("c"))) << "by three threads, and gone on with by as many as there are";
    const std::string plan = file("d") + ".farm";
    ASSERT_EQ(run(program() + " farm " + what + " -o " + file("d") + " --to parallel --parts 2").status, 0);
    for (const char* part : {"2", "1"}) {
        const auto made = run(program() + " part " + plan + " " + part + " --quiet");
        ASSERT_EQ(made.status, 0) << made.output;
    }
    const auto joined = run(program() + " join " + plan + " --quiet");
    ASSERT_EQ(joined.status, 0) << joined.output;
    EXPECT_TRUE(whole == contents(file("d")));
}

INSTANTIATE_TEST_SUITE_P(Codecs, Masters,
                         testing::Values(Master{"prores", ".mov", "yuv422p10le", "apch", "64x48", 0.3},
                                         Master{"prores_422", ".mov", "yuv422p10le", "apcn", "64x48", 0.4},
                                         Master{"prores_lt", ".mov", "yuv422p10le", "apcs", "64x48", 0.5},
                                         Master{"prores_proxy", ".mov", "yuv422p10le", "apco", "64x48", 0.8},
                                         Master{"prores4444", ".mov", "yuva444p12le", "ap4h", "64x48", 0.3},
                                         Master{"prores4444xq", ".mov", "yuva444p12le", "ap4x", "64x48", 0.3},
                                         Master{"dnxhr", ".mov", "yuv422p10le", "AVdh", "256x720", 0.5},
                                         Master{"ffv1", ".mkv", "yuv444p12le", "", "64x48", 0.001},
                                         // Eight bits of Y'CbCr are 0.41 off.
                                         Master{"h264_lossless", ".mkv", "yuv444p", "", "64x48", 0.5}),
                         [](const auto& tested) { return std::string(tested.param.codec); });

TEST(Lossless, H264KeepsEverySampleOf444) {
    const Folder folder;
    const auto drawn = run("ffmpeg -v error -f lavfi -i testsrc2=s=96x64:r=25:d=0.2 -pix_fmt yuv444p -strict -1 " +
                           path(folder, "f.y4m"));
    ASSERT_EQ(drawn.status, 0) << drawn.output;
    const auto raw = [&](const std::string& file) {
        return run("ffmpeg -v error -err_detect explode -i " + path(folder, file) + " -f rawvideo -").output;
    };
    const std::string source = raw("f.y4m");
    ASSERT_EQ(source.size(), 5u * 3 * 96 * 64);
    for (const char* film : {"m.mp4", "m.mov", "m.mkv"}) {
        const auto made = run(program() + " encode " + path(folder, "f.y4m") + " --quiet --codec h264_lossless -o " +
                              path(folder, film));
        ASSERT_EQ(made.status, 0) << made.output;
        EXPECT_EQ(ffprobe(path(folder, film)).value("pix_fmt", ""), "yuv444p");
        EXPECT_TRUE(raw(film) == source) << film;
    }
}

}  // namespace
}  // namespace render2mpeg::test
