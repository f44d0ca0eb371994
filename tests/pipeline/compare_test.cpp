#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "app/experiments/comparison.h"
#include "app/experiments/foreign_film.h"
#include "app/experiments/reference_cache.h"
#include "image/image.h"
#include "pipeline/fixture.h"

/// `render2mpeg compare`: coupled light and our encoder against rendering first and ffmpeg.
namespace render2mpeg::test {
namespace {

const std::string few_samples =
    " --size 48x32 --indirect lightcuts --vpls 16 --samples 1 --exposure 0 --sample 1x4 --references 2 --runs 1";

TEST(Compare, HoldsSixWaysAgainstOneReferenceSlow) {
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
    ASSERT_EQ(found.at("ways").size(), 6u);
    for (const json& way : found.at("ways")) {
        const json& rows = way.at("rows");
        ASSERT_EQ(rows.size(), 2u) << way;
        EXPECT_LT(1.2 * rows[1].at("bytes").get<double>(), rows[0].at("bytes").get<double>()) << way;
        EXPECT_GT(rows[0].at("psnr_y").get<double>(), rows[1].at("psnr_y").get<double>() + 3) << way;
        EXPECT_GT(rows[0].at("psnr_y").get<double>(), 33.0) << "pictures meet their own references: " << way;
        EXPECT_GT(rows[0].at("ssim_y").get<double>(), 0.97) << way;
        EXPECT_GT(rows[0].at("light_seconds").get<double>(), 0.0) << way;
        EXPECT_EQ(rows[0].at("light_runs").size(), 1u);
        EXPECT_LT(std::abs(rows[0].at("flicker").get<double>()), 3.0) << "a pair of references tells it";
        EXPECT_NE(rows[0].at("flicker"), rows[1].at("flicker"));
    }
    // Light that is not coupled is lit once.
    EXPECT_EQ(found.at("ways")[1].at("rows")[0].at("light_seconds"),
              found.at("ways")[4].at("rows")[1].at("light_seconds"));
    ASSERT_EQ(found.at("differences").size(), 6u);
    EXPECT_TRUE(found.at("differences")[0].at("bits").at("psnr_y").is_number());

    const std::string page = contents(folder / "c.html");
    EXPECT_NE(page.find(found.at("summary").get<std::string>()), std::string::npos);
    test::expect_alone(page);
    std::istringstream lines(outcome.output);
    for (std::string line; std::getline(lines, line);)
        if (!line.starts_with(plain_film()) && !line.starts_with(program())) {
            EXPECT_LE(line.size(), 80u) << line;
        }
}

TEST(Compare, TakesMediansOfRunsAndKeepsItsReferencesSlow) {
    const Folder folder;
    const std::string once =
        program() + " compare " + plain_film() +
        " --size 32x32 --indirect lightcuts --vpls 16 --samples 1 --exposure 0 --sample 1x2 --references 1" +
        " --quantisers 8,31 --keep-references " + path(folder, "kept") + " --json " + path(folder, "c.json") +
        " --runs ";
    const auto outcome = run(once + "2");
    ASSERT_EQ(outcome.status, 0) << outcome.output;
    EXPECT_NE(outcome.output.find("medians of 2 runs"), std::string::npos) << outcome.output;
    const json first = json::parse(contents(folder / "c.json"));
    EXPECT_EQ(first.at("runs"), 2);
    for (const json& way : first.at("ways"))
        for (const json& row : way.at("rows")) {
            ASSERT_EQ(row.at("light_runs").size(), 2u);
            ASSERT_EQ(row.at("code_runs").size(), 2u);
            EXPECT_NEAR(row.at("light_seconds").get<double>(),
                        0.5 * (row.at("light_runs")[0].get<double>() + row.at("light_runs")[1].get<double>()), 1e-9);
        }

    // The next time nothing is lit that is known, and all is the same.
    ASSERT_EQ(run(once + "1 --quiet").status, 0);
    const json second = json::parse(contents(folder / "c.json"));
    EXPECT_EQ(second.at("reference"), first.at("reference")) << "with the seconds that it took then";
    EXPECT_EQ(second.at("ways")[1].at("rows")[0].at("psnr_y"), first.at("ways")[1].at("rows")[0].at("psnr_y"));
}

TEST(Medians, AreTheMiddleAndSpreadsTheWidth) {
    EXPECT_EQ(app::median({3, 1, 2}), 2);
    EXPECT_EQ(app::median({4, 1, 2, 3}), 2.5);
    EXPECT_EQ(app::median({}), 0);
    EXPECT_NEAR(app::spread({1.1, 0.9, 1.0}), 0.2, 1e-12);
    EXPECT_EQ(app::spread({0, 0}), 0);
}

TEST(KeptReferences, AreWholeOrNotThere) {
    const Folder folder;
    const app::ReferenceCache cache(folder / "kept");
    app::KeptReference reference{core::Plane<glm::vec3>(5, 4, glm::vec3(1, 2, 3)), 7.5};
    reference.light.at(3, 2) = {9, 8, 7};
    EXPECT_FALSE(cache.find(1, 5, 4));
    cache.keep(1, reference);
    const auto found = cache.find(1, 5, 4);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->light, reference.light);
    EXPECT_EQ(found->seconds, 7.5);
    EXPECT_FALSE(cache.find(2, 5, 4)) << "another name";
    EXPECT_FALSE(cache.find(1, 4, 5)) << "another size";
    ASSERT_EQ(std::distance(std::filesystem::directory_iterator(folder / "kept"), {}), 1) << "nothing unfinished";

    // Cut off, damaged, too long: none is a reference.
    const std::filesystem::path file = std::filesystem::directory_iterator(folder / "kept")->path();
    const std::string whole = contents(file);
    std::string flipped = whole;
    flipped[whole.size() / 2] ^= 1;
    for (const std::string& bad : {whole.substr(0, whole.size() - 1), whole.substr(0, 10), flipped, whole + "x"}) {
        std::ofstream(file, std::ios::binary) << bad;
        EXPECT_FALSE(cache.find(1, 5, 4));
    }
    std::ofstream(file, std::ios::binary) << whole;
    EXPECT_TRUE(cache.find(1, 5, 4));
    EXPECT_FALSE(app::ReferenceCache().find(1, 5, 4)) << "keeps nothing";
    EXPECT_THROW(app::ReferenceCache{file}, core::Error) << "no folder";
}

TEST(ForeignFilm, IsHeldAgainstItsOwnFramesSlow) {
    const Folder folder;
    const std::string render = program() + " render -y --hold " + plain_film() +
                               " --size 32x32 --indirect lightcuts --vpls 16 --samples 1 --exposure 0 --frames 8:12 "
                               "--tolerance fixed=20% --quiet -o ";
    ASSERT_EQ(run(render + path(folder, "f.mpg") + " --stats " + path(folder, "s.json")).status, 0);
    std::filesystem::create_directory(folder / "frames");
    ASSERT_EQ(run(render + path(folder, "frames/f.%04d.png")).status, 0);

    const app::ForeignFilm found = app::look_at_foreign(folder / "f.mpg", folder / "frames", 0);
    const json statistics = json::parse(contents(folder / "s.json"));
    EXPECT_EQ(found.pictures, 5);
    EXPECT_EQ(found.compared, 5);
    EXPECT_NEAR(found.psnr_y, statistics.at("psnr_y").get<double>(), 0.2) << "but for roundings of PNG";
    EXPECT_NEAR(found.ssim_y, statistics.at("ssim_y").get<double>(), 0.002);
    double bytes = 0;
    for (const json& frame : statistics.at("per_frame")) bytes += frame.at("bytes").get<double>() / 5;
    EXPECT_NEAR(found.bytes, bytes, 0.02 * bytes) << "but for headers";

    // A pattern does as well; frames of another size or none at all do not.
    EXPECT_EQ(app::look_at_foreign(folder / "f.mpg", folder / "frames/f.%04d.png", 0).psnr_y, found.psnr_y);
    EXPECT_THROW(app::look_at_foreign(folder / "f.mpg", folder.path(), 0), core::Error);
    for (const char* name : {"frames/g.0000.png", "frames/g.0001.png"})
        image::write_png(folder / name, 16, 16, std::vector<unsigned char>(16 * 16 * 3, 99));
    EXPECT_THROW(app::look_at_foreign(folder / "f.mpg", folder / "frames", 0), core::Error) << "two sequences";
    EXPECT_THROW(app::look_at_foreign(folder / "f.mpg", folder / "frames/g.%04d.png", 0), core::Error) << "size";
}

TEST(ForeignFilm, IsHeldAgainstFramesByTheMatrixThatItDeclares) {
    const Folder folder;
    // Red, green and blue, whose luma differs most between the two.
    std::vector<unsigned char> rgb;
    for (int i = 0; i < 64 * 48; ++i) {
        const int patch = i % 64 / 16;
        for (int c = 0; c < 3; ++c) rgb.push_back(patch == c || patch == 3 ? 200 : 30);
    }
    for (const char* name : {"f.0.png", "f.1.png"}) image::write_png(folder / name, 64, 48, rgb);
    const auto psnr = [&](const std::string& coded, const std::string& declared) {
        const std::string film = path(folder, coded + declared + ".mpg");
        const auto made =
            run("ffmpeg -v error -i " + path(folder, "f.%d.png") + " -vf scale=out_color_matrix=" + coded +
                ":flags=accurate_rnd,format=yuv420p,setparams=colorspace=" + declared + " -colorspace " + declared +
                " -c:v mpeg2video -qscale:v 1 " + film);
        EXPECT_EQ(made.status, 0) << made.output;
        return app::look_at_foreign(film, folder / "f.%d.png", 0).psnr_y;
    };
    EXPECT_GT(psnr("bt601", "smpte170m"), 44);
    EXPECT_GT(psnr("bt709", "bt709"), 44);
    EXPECT_LT(psnr("bt601", "bt709"), 30) << "the wrong one is seen";
    EXPECT_LT(psnr("bt709", "bt470bg"), 30);
}

TEST(ImageSequence, IsFoundInAFolderWhateverItsNumbers) {
    const Folder folder;
    for (const char* name : {"shot.0998.exr", "shot.0999.exr", "shot.1000.exr", "notes.txt", "cover.png"})
        std::ofstream(folder / name) << "x";
    EXPECT_EQ(app::image_sequence_in(folder.path()), folder / "shot.%04d.exr");
    EXPECT_EQ(app::image_sequence_in(folder / "a.%d.png"), folder / "a.%d.png") << "a pattern is its own";
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
    refused("", " --film x.mpg", "--reference");
    refused("", " --json " + plain_film() + "/film.json", "it is an input");
}

/// A way whose films need `factor` times the bytes and `pace` times the seconds of others for the same quality.
app::Way way_of(double factor, double pace) {
    app::Way way;
    for (int q = 1; q <= 16; q *= 2) {
        app::Trial t;
        t.quantiser = q;
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
