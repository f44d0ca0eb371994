#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <glm/glm.hpp>
#include <string>

#include "pipeline/fixture.h"

/// Films of high dynamic range against closed forms of [BT2100].
namespace render2mpeg::test {
namespace {

/// Scene-linear light of BT.709, patches in a row.
constexpr std::array<glm::dvec3, 8> patches{{{0.18, 0.18, 0.18},
                                             {1, 1, 1},
                                             {0.01, 0.01, 0.01},
                                             {6, 6, 6},
                                             {1, 0, 0},
                                             {0, 0.5, 0},
                                             {0.1, 0.1, 3},
                                             {60, 50, 40}}};
constexpr int width = 256, height = 144;

/// BT.709's primaries in BT.2020's [BT2087].
glm::dvec3 in_bt2020(glm::dvec3 c) {
    return {0.6274 * c.x + 0.3293 * c.y + 0.0433 * c.z, 0.0691 * c.x + 0.9195 * c.y + 0.0114 * c.z,
            0.0164 * c.x + 0.0880 * c.y + 0.8956 * c.z};
}

/// The tone curve of docs/model/display.md.
double bent(double x) {
    return x <= 0.625 ? x : 1 - 0.375 * 0.375 / (x + 0.375 - 0.625);
}

double pq(double nits) {
    const double y = std::pow(nits / 10000, 0.1593017578125);
    return std::pow((0.8359375 + 18.8515625 * y) / (1 + 18.6875 * y), 78.84375);
}

double hlg(double light) {
    return light <= 1.0 / 12 ? std::sqrt(3 * light) : 0.17883277 * std::log(12 * light - 0.28466892) + 0.55991073;
}

double nits_of(double exposed, double peak) {
    return peak * bent(203 * exposed / peak);
}

/// Y', Cb, Cr of 10 bits.
glm::dvec3 coded(glm::dvec3 patch, const std::string& view, double peak) {
    const glm::dvec3 light = in_bt2020(patch);
    glm::dvec3 s;
    for (int c = 0; c < 3; ++c) s[c] = view == "pq" ? pq(nits_of(light[c], peak)) : hlg(bent(light[c] * 0.26496));
    const double y = 0.2627 * s.x + 0.6780 * s.y + 0.0593 * s.z;
    return {64 + 876 * y, 512 + 896 * (s.z - y) / 1.8814, 512 + 896 * (s.x - y) / 1.4746};
}

class HighDynamicRange : public testing::Test {
  protected:
    void SetUp() override {
        std::ofstream raw(path(folder_, "p.raw"), std::ios::binary);
        for (int n = 0; n < 2; ++n)
            for (const int c : {1, 2, 0})
                for (int y = 0; y < height; ++y)
                    for (int x = 0; x < width; ++x) {
                        const auto value = static_cast<float>(patches[static_cast<std::size_t>(8 * x / width)][c]);
                        raw.write(reinterpret_cast<const char*>(&value), sizeof value);
                    }
        raw.close();
        const auto made = run("ffmpeg -v error -f rawvideo -pix_fmt gbrpf32le -s 256x144 -i " + path(folder_, "p.raw") +
                              " -start_number 0 " + path(folder_, "p.%02d.exr"));
        ASSERT_EQ(made.status, 0) << made.output;
    }
    support::Outcome encode(const std::string& more, const std::string& film) const {
        return run(program() + " encode " + path(folder_, "p.%02d.exr") + " --quiet -y --encoder fast -q 1 " + more +
                   " -o " + path(folder_, film));
    }
    void expect_patches(const std::string& film, const std::string& view, double peak) const {
        const auto decoded = run("ffmpeg -v error -err_detect explode -i " + path(folder_, film) +
                                 " -frames:v 1 -f rawvideo -pix_fmt yuv420p10le -");
        ASSERT_EQ(decoded.output.size(), std::size_t{2 * width * height * 3 / 2});
        const auto at = [&](std::size_t sample) {
            return static_cast<unsigned char>(decoded.output[2 * sample]) +
                   256 * static_cast<unsigned char>(decoded.output[2 * sample + 1]);
        };
        for (std::size_t i = 0; i < patches.size(); ++i) {
            const glm::dvec3 wanted = coded(patches[i], view, peak);
            const std::size_t y = height / 2 * width + (2 * i + 1) * width / 16, all = width * height,
                              half = height / 4 * (width / 2) + (2 * i + 1) * width / 32;
            EXPECT_NEAR(at(y), wanted.x, 2.5) << film << " patch " << i;
            EXPECT_NEAR(at(all + half), wanted.y, 3) << film << " patch " << i;
            EXPECT_NEAR(at(all + all / 4 + half), wanted.z, 3) << film << " patch " << i;
        }
    }
    const Folder folder_;
};

TEST_F(HighDynamicRange, FilmsHaveTheLightOfTheirCurveAndSayHowBrightTheyAreSlow) {
    double brightest = 0, sum = 0;
    for (const glm::dvec3 patch : patches) {
        const glm::dvec3 light = in_bt2020(patch);
        const double most = nits_of(std::max({light.x, light.y, light.z}), 600);
        brightest = std::max(brightest, most);
        sum += most / 8;
    }
    for (const std::string codec : {"hevc", "av1"}) {
        const std::string film = codec + ".mp4";
        const auto made = encode("--view pq --peak 600 --codec " + codec, film);
        ASSERT_EQ(made.status, 0) << made.output;
        expect_patches(film, "pq", 600);
        const json stream = ffprobe(path(folder_, film));
        EXPECT_EQ(stream.value("pix_fmt", ""), "yuv420p10le");
        EXPECT_EQ(stream.value("color_transfer", ""), "smpte2084");
        EXPECT_EQ(stream.value("color_primaries", ""), "bt2020");
        EXPECT_EQ(stream.value("color_space", ""), "bt2020nc");
        json display, level;
        for (const json& data : stream.value("side_data_list", json::array()))
            (data.contains("max_content") ? level : display) = data;
        EXPECT_EQ(display.value("max_luminance", ""), "6000000/10000") << stream;
        EXPECT_NEAR(level.value("max_content", 0), brightest, 1) << stream;
        EXPECT_NEAR(level.value("max_average", 0), sum, 1) << stream;
        // The stream itself says for which display it is made.
        const auto frames = run("ffmpeg -v error -i " + path(folder_, film) + " -c copy -map_metadata -1 " +
                                path(folder_, codec + (codec == "hevc" ? ".hevc" : ".obu")) +
                                " && ffprobe -v error -show_frames -read_intervals %+#1 " +
                                path(folder_, codec + (codec == "hevc" ? ".hevc" : ".obu")));
        EXPECT_NE(frames.output.find("Mastering display metadata"), std::string::npos) << codec << frames.output;
        const auto told = run(program() + " info " + path(folder_, film));
        EXPECT_NE(
            told.output.find("primaries BT.2020, transfer PQ, matrix BT.2020; made for white of 600 cd/m2, brightest"),
            std::string::npos)
            << told.output;
    }
}

TEST_F(HighDynamicRange, HlgHasReferenceWhiteAtThreeQuarters) {
    EXPECT_NEAR(hlg(0.26496), 0.75, 1e-4);
    EXPECT_NEAR(pq(203), 0.58, 1e-3);
    const auto made = encode("--view hlg --codec hevc", "h.mp4");
    ASSERT_EQ(made.status, 0) << made.output;
    expect_patches("h.mp4", "hlg", 1000);
    EXPECT_EQ(ffprobe(path(folder_, "h.mp4")).value("color_transfer", ""), "arib-std-b67");
}

TEST_F(HighDynamicRange, IsRefusedWhereItCannotBe) {
    const auto refused = [&](const std::string& words, const std::string& film, const std::string& why) {
        const auto outcome = encode(words, film);
        EXPECT_NE(outcome.status, 0) << words;
        EXPECT_NE(outcome.output.find(why), std::string::npos) << outcome.output;
        EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1) << outcome.output;
    };
    refused("--view pq --codec h264", "f.mp4", "H.264 films are not of high dynamic range; choose --codec hevc, av1");
    refused("--view pq", "f.mpg", "MPEG-2 films are not");
    refused("--view filmic --peak 500 --codec hevc", "f.mp4", "--peak: goes with --view pq");
    refused("--view pq --peak 50 --codec hevc", "f.mp4", "--peak");
    const auto png =
        run("ffmpeg -v error -i " + path(folder_, "p.00.exr") + " " + path(folder_, "q.00.png") + " && " + program() +
            " encode " + path(folder_, "q.%02d.png") + " --view hlg --codec hevc -o " + path(folder_, "q.mp4"));
    EXPECT_NE(png.output.find("only scene-linear ones (EXR) have brighter light"), std::string::npos) << png.output;
}

}  // namespace
}  // namespace render2mpeg::test
