#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "app/experiments/comparison.h"
#include "app/options/options.h"
#include "pipeline/fixture.h"

/// `render2mpeg compare`: coupled light and our encoder against rendering first and ffmpeg.
namespace render2mpeg::test {
namespace {

using namespace std::string_literals;

const std::string few_samples = " --size 48x32 --samples 1 --exposure 0 --sample 1x4 --references 2";

TEST(Compare, HoldsFourWaysAgainstOneReferenceSlow) {
    const Folder folder;
    const auto outcome = run(program() + " compare " + plain_film() + few_samples + " --quantisers 4,16 --report " +
                             path(folder, "c.html") + " --json " + path(folder, "c.json"));
    ASSERT_EQ(outcome.status, 0) << outcome.output;
    const json found = json::parse(contents(folder / "c.json"));
    EXPECT_EQ(json::parse(contents(folder / "c.report.json")), found);
    const std::string document = contents(support::source_folder() / "docs/json.md");
    for (const auto& [key, value] : found.items()) EXPECT_NE(document.find("`" + key + "`"), std::string::npos) << key;
    EXPECT_TRUE(found.at("complete").get<bool>());
    EXPECT_TRUE(found.at("ffmpeg").get<std::string>().starts_with("ffmpeg version"));
    EXPECT_EQ(found.at("reference").at("frames"), 2);
    ASSERT_EQ(found.at("ways").size(), 4u);
    const json& rows = found.at("rows");
    ASSERT_EQ(rows.size(), 8u);
    for (const auto& [key, value] : rows[0].items())
        EXPECT_NE(document.find("`" + key + "`"), std::string::npos) << key;
    for (std::size_t way = 0; way < 4; ++way) {
        const json &fine = rows[2 * way], &coarse = rows[2 * way + 1];
        EXPECT_EQ(fine.at("group"), found.at("ways")[way].at("name"));
        EXPECT_EQ(coarse.at("group"), fine.at("group"));
        EXPECT_LT(1.2 * coarse.at("bytes").get<double>(), fine.at("bytes").get<double>()) << fine;
        EXPECT_GT(fine.at("psnr_y").get<double>(), coarse.at("psnr_y").get<double>() + 3) << fine;
        EXPECT_GT(fine.at("psnr_y").get<double>(), 33.0) << "pictures meet their own references: " << fine;
        EXPECT_GT(fine.at("ssim_y").get<double>(), 0.97) << fine;
        EXPECT_GT(fine.at("light_seconds").get<double>(), 0.0) << fine;
    }
    EXPECT_EQ(rows[2].at("light_seconds"), rows[7].at("light_seconds")) << "light that is not coupled is lit once";
    ASSERT_EQ(found.at("differences").size(), 4u);
    EXPECT_TRUE(found.at("differences")[0].at("bits").at("psnr_y").is_number());

    const std::string page = contents(folder / "c.html");
    test::expect_alone(page);
    EXPECT_EQ(test::page_data(page).at("figures"), found);
    EXPECT_EQ(test::page_data(page).at("costs").size(), 4u);
    EXPECT_NE(outcome.output.find("decoded against that light, PSNR-Y the truth."), std::string::npos)
        << outcome.output;
    std::istringstream lines(outcome.output);
    for (std::string line; std::getline(lines, line);)
        if (!line.starts_with(plain_film()) && !line.starts_with(program())) {
            EXPECT_LE(line.size(), 80u) << line;
        }
}

TEST(Compare, IsRefusedBeforeAnyWork) {
    const auto refused = [&](const std::string& before, const std::string& options, const char* words) {
        const auto outcome = run(before + program() + " compare " + plain_film() + few_samples + options);
        EXPECT_TRUE(outcome.status == 1 || outcome.status == 2) << outcome.output;
        EXPECT_NE(outcome.output.find(words), std::string::npos) << outcome.output;
        EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1) << outcome.output;
    };
    refused("PATH=/nowhere ", "", "no such program");
    refused("", " --quantisers 4", "two or more");
    refused("", " --quantiser 4", "--quantiser");
    refused("", " --json " + plain_film() + "/film.json", "it is an input");
}

TEST(Comparison, SaysQuantisersInTheScaleOfTheCodec) {
    const app::Way ours{"coupled", "", "coupled", {}, {}};
    EXPECT_EQ(app::choices_of(ours, encoder::Codec::mpeg2, 4).back(), std::pair("--quantiser"s, "4"s));
    const app::Choices h264 = app::choices_of(ours, encoder::Codec::h264, 38);
    EXPECT_EQ(app::parse({"render2mpeg", "render", "a.json", "-o", "a.mp4", h264.back().first, h264.back().second})
                  .render.coding.crf,
              38)
        << "--quantiser has no 38";
    app::Way ffmpeg = ours;
    ffmpeg.ffmpeg.emplace();
    EXPECT_EQ(app::choices_of(ffmpeg, encoder::Codec::h264, 38).back(), std::pair("--as"s, "y4m"s));
}

/// A way whose films need `factor` times the bytes and `pace` times the seconds of others for the same quality.
app::Way way_of(double factor, double pace) {
    app::Way way;
    for (int q = 1; q <= 16; q *= 2) {
        app::Trial t;
        t.quantiser = q;
        t.has_references = true;
        t.bytes = factor * 1e5 / q;
        t.seconds = pace * 0.75;
        t.code_seconds = pace * 0.25 / q;
        t.masked_error = q;
        core::Picture made, truth;
        made.y = core::Plane<std::uint8_t>(16, 16, 100);
        truth.y = core::Plane<std::uint8_t>(16, 16, static_cast<std::uint8_t>(100 + q));
        for (core::Picture* p : {&made, &truth}) p->cb = p->cr = core::Plane<std::uint8_t>(8, 8, 128);
        t.decoded.add(made, truth);
        way.rows.push_back(t);
    }
    return way;
}

TEST(Differences, AreThoseOfBitsAndOfAllTime) {
    const app::Difference d = app::difference_of(way_of(0.8, 2), way_of(1, 1));
    EXPECT_NEAR(d.psnr_y, -20, 1e-6);
    EXPECT_NEAR(d.ssim_y, -20, 1e-6);
    EXPECT_NEAR(d.psnr_hvs_m, -20, 1e-6);
    EXPECT_NEAR(d.seconds, 100, 1e-6);

    // Where there is nothing in common, nothing is claimed.
    EXPECT_TRUE(std::isnan(app::difference_of(app::Way{}, way_of(1, 1)).psnr_y));
    EXPECT_EQ(app::change_text(app::difference_of(app::Way{}, way_of(1, 1)).psnr_y), "-");
    EXPECT_EQ(app::change_text(-12.34), "-12.3 %");
    EXPECT_EQ(app::sentence_of(app::Comparison{}), "");
}

}  // namespace
}  // namespace render2mpeg::test
