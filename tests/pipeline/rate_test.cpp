#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string>

#include "pipeline/fixture.h"

/// Rates and quality as users ask for them.
namespace render2mpeg::test {
namespace {

/// Renders the room with moving boxes small, 65 frames in two chunks, and gives its statistics. So few and small
/// pictures do not come as near to a rate as films do (bench_encoder_rates).
nlohmann::json rendered(const Folder& folder, const std::string& options, const std::string& name = "f.m2v",
                        const std::string& scene = plain_film()) {
    const auto outcome = run(program() + " render -y --hold " + scene +
                             " --size 96x80 --samples 1 --vpls 0 --exposure 0.5 --hold --frames 0:64 --quiet --stats " +
                             (folder / "s.json").string() + " -o " + (folder / name).string() + " " + options);
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    return outcome.status == 0 ? nlohmann::json::parse(contents(folder / "s.json")) : nlohmann::json::object();
}

double error_of(const nlohmann::json& statistics) {
    const auto& rate = statistics.at("rate");
    return std::abs(rate.at("average").get<double>() / rate.at("bit_rate").get<double>() - 1);
}

/// 60 grey pictures, then 60 of noise.
void write_calm_and_noise(const std::string& file) {
    std::ofstream frames(file, std::ios::binary);
    frames << "YUV4MPEG2 W64 H64 F25:1 Ip A1:1 C420mpeg2\n";
    std::uint32_t random = 1;
    for (int n = 0; n < 120; ++n) {
        std::string picture(64 * 64 * 3 / 2, static_cast<char>(128));
        for (std::size_t i = 0; n >= 60 && i < 64 * 64; ++i) {
            random = random * 1664525u + 1013904223u;
            picture[i] = static_cast<char>(64 + (random >> 25));
        }
        frames << "FRAME\n" << picture;
    }
}

TEST(Rates, OfOnePassSpendOnNoiseWhatACalmShotBeforeItLeaves) {
    const Folder folder;
    write_calm_and_noise(path(folder, "f.y4m"));
    const auto outcome = run(program() + " encode " + path(folder, "f.y4m") + " --quiet --bitrate 400k --passes 1 -o " +
                             path(folder, "f.m2v") + " --stats " + path(folder, "s.json"));
    ASSERT_EQ(outcome.status, 0) << outcome.output;
    EXPECT_LT(error_of(nlohmann::json::parse(contents(folder / "s.json"))), 0.05);
}

TEST(RatesSlow, OnePassAndTwoComeNearAndStatisticsSayHow) {
    const Folder folder;
    const auto two = rendered(folder, "--bitrate 60k --maxrate 100k --vbv 200k", "f.m2v", support::panel_film());
    EXPECT_LT(error_of(two), 0.05) << two.at("rate");
    EXPECT_GT(two.at("seconds").at("first_pass").get<double>(), 0);
    EXPECT_EQ(two.at("rate").at("mode"), "variable");
    EXPECT_EQ(two.at("rate").at("max_rate"), 100'000);
    EXPECT_EQ(two.at("rate").at("vbv_bits"), 12 * 16'384);
    for (const auto& frame : two.at("per_frame")) {
        EXPECT_LE(std::abs(frame.at("quantiser").get<int>() - frame.at("planned_quantiser").get<int>()),
                  frame.at("tries") == 1 ? 1 : 31);
        EXPECT_GE(frame.at("fullness_after"), 0);
        EXPECT_LE(frame.at("fullness_before"), 12 * 16'384);
    }
    const auto one = rendered(folder, "--bitrate 60k --passes 1", "f.m2v", support::panel_film());
    EXPECT_LT(error_of(one), 0.05) << one.at("rate");
    EXPECT_EQ(one.at("seconds").at("first_pass").get<double>(), 0);
}

TEST(RatesSlow, AConstantRateIsConstantWhateverThePicturesNeed) {
    // At 800 kb/s and 25 Hz each of them has 32,000 bits; quantiser 1 needs less for most.
    const Folder folder;
    const auto stats = rendered(folder, "--bitrate 800k --cbr");
    EXPECT_GT(stats.at("rate").at("stuffing").get<int>(), 0);
    EXPECT_EQ(stats.at("rate").at("max_rate"), 800'000);
    // The first chunk's 60 pictures last 2.4 s; with the buffer as full after them as before, that is its size.
    std::int64_t bytes = 0;
    for (std::size_t i = 0; i < 60; ++i) bytes += stats.at("per_frame")[i].at("bytes").get<std::int64_t>();
    EXPECT_EQ(bytes, 240'000);
}

TEST(Rates, QualityBeginsWithItsQuantiserAndFollowsTheFilmSlow) {
    const Folder folder;
    const auto coded = [&](const std::string& quality) {
        const auto outcome =
            run(program() + " render -y --hold " + film("colonnade") +
                " --size 64x48 --samples 1 --vpls 0 --exposure 0.5 --frames 0:11 --quiet --stats " +
                (folder / "s.json").string() + " -o " + (folder / "f.m2v").string() + " --quality " + quality);
        EXPECT_EQ(outcome.status, 0) << outcome.output;
        return nlohmann::json::parse(contents(folder / "s.json"));
    };
    const auto coarse = coded("40"), fine = coded("80");
    EXPECT_EQ(coarse.at("per_frame")[0].at("quantiser"), 7) << "60 less than 100 are three doublings; eleven follow it";
    EXPECT_NE(coarse.at("per_frame")[11].at("quantiser"), 8) << "what the pictures before came to counts";
    EXPECT_GT(fine.at("psnr_y").get<double>(), coarse.at("psnr_y").get<double>() + 6);
    EXPECT_GT(fine.at("bytes").get<double>(), 1.5 * coarse.at("bytes").get<double>());
}

TEST(Rates, ContradictionsAreRefusedByOneLine) {
    const Folder folder;
    for (const auto& [options, words] : {std::pair{"--quantiser 3 --bitrate 1M", "--quantiser and --bitrate"},
                                         {"--quality 50 --bitrate 1M", "--quality and --bitrate"},
                                         {"--quality 50 --quantiser 4", "--quantiser and --quality"},
                                         {"--cbr", "Give --bitrate too"},
                                         {"--passes 2", "without --bitrate"},
                                         {"--bitrate 1M --maxrate 900k", "is below the bit rate"},
                                         {"--bitrate 1M --cbr --maxrate 2M", "must be equal"},
                                         {"--bitrate 1k", "even pictures without detail need"},
                                         {"--bitrate 100M", "at most 80000000"}}) {
        const auto outcome = run(program() + " render -y --hold " + plain_film() + " -o " +
                                 (folder / "x.mpg").string() + " " + std::string(options));
        EXPECT_TRUE(outcome.status == 1 || outcome.status == 2) << options;
        EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1) << outcome.output;
        EXPECT_NE(outcome.output.find(words), std::string::npos) << outcome.output;
        EXPECT_EQ(folder.entries(), 0u) << options;
    }
}

}  // namespace
}  // namespace render2mpeg::test
