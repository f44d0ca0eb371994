#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>

#include "encoder_rd/clips.h"
#include "encoder_rd/codecs.h"
#include "encoder_rd/report.h"

namespace render2mpeg::bench {
namespace {

namespace fs = std::filesystem;

/// A tiny film of a turning box, in a folder that goes away with it.
class EncoderBenchmarkSlow : public ::testing::Test {
  protected:
    EncoderBenchmarkSlow() : folder_(fs::temp_directory_path() / ("encoder_rd_test." + std::to_string(getpid()))) {
        fs::create_directories(folder_);
        std::ofstream(folder_ / "turning.json") << R"({
            "size": [64, 48], "frame_rate": 30, "frames": 5, "exposure": 0,
            "camera": { "position": [0, 1, 3], "look_at": [0, 0.5, 0], "fov": 45 },
            "sky": [0.3, 0.4, 0.6],
            "objects": [
                { "shape": "plane", "size": [8, 8], "material": { "texture": { "checker": ["#202020", "#d0c0a0"], "squares": 24 } } },
                { "shape": "box", "size": 1, "material": { "texture": { "checker": ["#803020", "#e0e0e0"], "squares": 4 } },
                  "keys": [{ "at": 0, "rotate": 0 }, { "at": 1, "rotate": 200 }] }]})";
    }
    ~EncoderBenchmarkSlow() override { fs::remove_all(folder_); }

    Clip clip() const { return make_clip({(folder_ / "turning.json").string(), folder_ / "cache", {}, 60}); }

    fs::path folder_;
};

TEST_F(EncoderBenchmarkSlow, RendersAFilmOnceAndThenKeepsItWithItsMotion) {
    const Clip first = clip();
    ASSERT_EQ(first.pictures.size(), 5u);
    const core::MotionField motion = first.motion(3, 1);
    const auto written = fs::last_write_time(first.y4m);
    const Clip again = clip();
    EXPECT_EQ(fs::last_write_time(again.y4m), written);
    EXPECT_EQ(again.content, first.content);
    const core::MotionField& kept = again.motion(3, 1);
    EXPECT_EQ(kept.picture, 3);
    EXPECT_EQ(kept.reference, 1);
    EXPECT_TRUE(std::ranges::equal(kept.vector.values(), motion.vector.values()));
    EXPECT_TRUE(std::ranges::equal(kept.kind.values(), motion.kind.values()));
    const auto moved = [](glm::vec2 v) { return glm::dot(v, v) > 0.25f; };
    EXPECT_GT(std::ranges::count_if(kept.vector.values(), moved), 20);
}

TEST_F(EncoderBenchmarkSlow, MeasuresEachWayToCodeAtEachQuantiser) {
    const Clip film = clip();
    const auto results = code_with_ours(film, own_codecs(), {2, 12});
    ASSERT_EQ(results.size(), own_codecs().size());
    std::vector<Curve> curves;
    for (std::size_t i = 0; i < results.size(); ++i) {
        ASSERT_EQ(results[i].size(), 2u);
        const Measured &fine = results[i][0], &coarse = results[i][1];
        EXPECT_EQ(fine.pictures, 5);
        EXPECT_GT(fine.bits, 1.3 * coarse.bits);
        EXPECT_GT(fine.psnr_y, coarse.psnr_y + 3);
        EXPECT_GT(fine.ssim_y, coarse.ssim_y);
        EXPECT_GT(fine.psnr_hvs_m, coarse.psnr_hvs_m + 3);
        EXPECT_EQ(fine.types[0].pictures + fine.types[1].pictures + fine.types[2].pictures, 5);
        curves.push_back({film.name, own_codecs()[i].name, results[i]});
    }
    const auto search = std::ranges::find(curves, "search", &Curve::codec);
    ASSERT_NE(search, curves.end());
    EXPECT_GT(search->points[0].evaluations, 100);
    EXPECT_LE(curves[0].points[0].evaluations, 40);
    EXPECT_NE(table(curves).find("| quality | search | turning |"), std::string::npos);
    write_plots(folder_, curves);
    EXPECT_GT(fs::file_size(folder_ / "turning.svg"), 1000u);
}

TEST(EncoderBenchmarkFilms, AreAtLeastFourWithoutRealScenes) {
    EXPECT_GE(clips_of_set(ClipSet::fit).size(), 4u);
    EXPECT_GE(clips_of_set(ClipSet::test).size(), 4u);
    EXPECT_GE(scene_clips(ClipSet::fit).size(), 3u);
}

}  // namespace
}  // namespace render2mpeg::bench
