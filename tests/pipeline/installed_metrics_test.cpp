#include "app/experiments/installed_metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "core/error.h"
#include "pipeline/fixture.h"

/// Metrics of other programs: with programs that stand for them, and with those that are installed.
namespace render2mpeg::test {
namespace {

/// A PATH for the length of a test.
class Path {
  public:
    explicit Path(const std::string& path) : before_(std::getenv("PATH")) { setenv("PATH", path.c_str(), 1); }
    ~Path() { setenv("PATH", before_.c_str(), 1); }

  private:
    std::string before_;
};

void write_program(const Folder& folder, const std::string& name, const std::string& script) {
    std::ofstream(folder / name) << "#!/bin/sh\n" << script;
    std::filesystem::permissions(folder / name, std::filesystem::perms::owner_all);
}

/// Stand-ins: XPSNR is 20 and 41.5 in turns and SSIMULACRA2 80, where they get what they want.
void write_programs(const Folder& folder) {
    write_program(folder, "ffmpeg",
                  "case \"$*\" in *filter=xpsnr*) echo 'Filter xpsnr'; exit 0;; esac\n"
                  "[ -s reference.y4m ] && [ -s decoded.y4m ] || exit 1\n"
                  "frames=$(grep -ac FRAME decoded.y4m)\n"
                  "n=0\n"
                  "while [ $n -lt $frames ]; do n=$((n + 1))\n"
                  "if [ $((n % 2)) = 0 ]; then v=41.5; else v=20; fi\n"
                  "echo \"n:    $n  XPSNR y: $v  XPSNR u: inf  XPSNR v: inf\"; done >xpsnr.txt\n");
    write_program(folder, "ssimulacra2",
                  "echo a warning >&2; head -c 2 \"$1\" | grep -q P6 || exit 1; cmp -s \"$1\" \"$2\"; echo 80.25\n");
}

core::Picture grey_picture(int code) {
    core::Picture picture;
    picture.y = core::Plane<std::uint8_t>(64, 48, 120);
    for (int x = 8; x < 40; ++x)
        for (int y = 8; y < 40; ++y) picture.y.at(x, y) = static_cast<std::uint8_t>(code + 40 * ((x / 4 + y / 4) % 2));
    picture.cb = picture.cr = core::Plane<std::uint8_t>(32, 24, 128);
    return picture;
}

TEST(MeanAndLow, AreThoseOfAllAndOfTheLowestTwentieth) {
    std::vector<double> values;
    for (int i = 40; i > 0; --i) values.push_back(i);
    EXPECT_EQ(app::mean_and_low(values).mean, 20.5);
    EXPECT_EQ(app::mean_and_low(values).low, 1.5) << "of two of forty";
    EXPECT_EQ(app::mean_and_low({3, 1, 2}).low, 1) << "at least of one";
    EXPECT_TRUE(std::isnan(app::mean_and_low({}).mean));
    EXPECT_TRUE(std::isnan(app::mean_and_low({}).low));
}

TEST(InstalledMetrics, AreAskedOnePictureAtATime) {
    const Folder folder;
    write_programs(folder);
    const Path path(folder.path().string() + ":" + std::getenv("PATH"));
    const app::InstalledMetrics metrics;
    EXPECT_EQ(metrics.missing(), "");
    const std::vector<app::JudgedPicture> pictures(3, {grey_picture(100), grey_picture(110)});
    const app::InstalledQuality found = metrics.of(pictures, {});
    EXPECT_EQ(found.xpsnr_y.mean, 41.5) << "of the second of two alike, which nothing hides as it moves";
    EXPECT_EQ(found.xpsnr_y.low, 41.5);
    EXPECT_EQ(found.ssimulacra2.mean, 80.25);
    perceptual::PictureColors wide;
    wide.view.name = core::ViewName::pq;
    EXPECT_TRUE(std::isnan(metrics.of(pictures, wide).ssimulacra2.mean));
    EXPECT_TRUE(std::isnan(metrics.of({}, {}).xpsnr_y.mean));
    std::vector<app::JudgedPicture> small = pictures;
    for (app::JudgedPicture& judged : small)
        for (core::Picture* picture : {&judged.reference, &judged.decoded})
            picture->y = core::Plane<std::uint8_t>(64, 30, 120);
    EXPECT_TRUE(std::isnan(metrics.of(small, {}).xpsnr_y.mean)) << "ffmpeg's filter does not survive them";

    write_program(folder, "ssimulacra2", "echo one; echo 'no such picture' >&2; exit 1\n");
    try {
        metrics.of(pictures, {});
        FAIL() << "nothing was thrown";
    } catch (const core::Error& error) {
        EXPECT_NE(std::string(error.what()).find("ssimulacra2"), std::string::npos) << error.what();
        EXPECT_NE(std::string(error.what()).find("no such picture"), std::string::npos) << error.what();
    }
    write_program(folder, "ssimulacra2", "echo nothing\n");
    EXPECT_THROW(metrics.of(pictures, {}), core::Error);
    write_program(folder, "ssimulacra2", "echo 1\n");
    write_program(folder, "ffmpeg", "echo >xpsnr.txt\n");
    EXPECT_THROW(metrics.of(pictures, {}), core::Error);
}

TEST(InstalledMetrics, ThatAreMissingAreNamed) {
    const Folder folder;
    const Path path(folder.path().string());
    const app::InstalledMetrics none;
    EXPECT_EQ(none.missing(),
              "XPSNR is missing: it wants ffmpeg 7.1 or newer; SSIMULACRA2: libjxl's program ssimulacra2.");
    EXPECT_TRUE(std::isnan(none.of(std::vector<app::JudgedPicture>(1), {}).xpsnr_y.mean));
    // An ffmpeg without the filter.
    write_program(folder, "ffmpeg", "echo \"Unknown filter 'xpsnr'.\"\n");
    write_program(folder, "ssimulacra2", "echo 1\n");
    EXPECT_EQ(app::InstalledMetrics().missing(), "XPSNR is missing: it wants ffmpeg 7.1 or newer.");
}

TEST(InstalledMetrics, FallWithWhatDiffers) {
    const app::InstalledMetrics metrics;
    if (!metrics.has_xpsnr() && !metrics.has_ssimulacra2()) GTEST_SKIP() << metrics.missing();
    const auto found = [&](int code) {
        return metrics.of(std::vector<app::JudgedPicture>{{grey_picture(100), grey_picture(code)}}, {});
    };
    const app::InstalledQuality same = found(100), near = found(104), far = found(130);
    if (metrics.has_xpsnr()) {
        EXPECT_TRUE(std::isinf(same.xpsnr_y.mean));
        EXPECT_GT(near.xpsnr_y.mean, far.xpsnr_y.mean + 10);
        EXPECT_GT(near.xpsnr_y.mean, 25);
    }
    if (metrics.has_ssimulacra2()) {
        EXPECT_NEAR(same.ssimulacra2.mean, 100, 1e-6);
        EXPECT_GT(near.ssimulacra2.mean, far.ssimulacra2.mean + 5);
    }
}

TEST(InstalledMetricsSlow, AreToldByCost) {
    const Folder folder;
    write_programs(folder);
    const std::string command =
        program() + " cost " + plain_film() +
        " --size 48x48 --samples 1 --exposure 0 --sample 1x1 --tolerances 40 --overwrite --json " +
        path(folder, "c.json");
    const auto told = run("PATH=" + folder.path().string() + ":/usr/bin:/bin " + command);
    ASSERT_EQ(told.status, 0) << told.output;
    EXPECT_NE(told.output.find("SSIMULACRA2"), std::string::npos) << told.output;
    EXPECT_EQ(told.output.find("missing"), std::string::npos) << told.output;
    for (const json& row : json::parse(contents(folder / "c.json")).at("rows")) {
        EXPECT_EQ(row.at("xpsnr_y"), 41.5);
        EXPECT_EQ(row.at("xpsnr_y_low"), 41.5);
        EXPECT_EQ(row.at("ssimulacra2"), 80.25);
        EXPECT_EQ(row.at("ssimulacra2_low"), 80.25);
    }
    const auto without = run("PATH=/nowhere " + command);
    ASSERT_EQ(without.status, 0) << without.output;
    EXPECT_NE(without.output.find("\nXPSNR is missing"), std::string::npos) << without.output;
    EXPECT_TRUE(json::parse(contents(folder / "c.json")).at("rows")[0].at("xpsnr_y").is_null());
}

}  // namespace
}  // namespace render2mpeg::test
