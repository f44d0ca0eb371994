#include <gtest/gtest.h>

#include "pipeline/fixture.h"

/// --heatmap: films in false colours beside the film.
namespace render2mpeg::test {
namespace {

const std::string seven_frames = " --size 64x48 --samples 1 --exposure 0 --quiet --frames 0:6 --gop 4";

TEST(Heatmap, OfEverySubjectIsAFilmAsLongAsTheRenderSlow) {
    const Folder folder;
    const auto of = [&](const char* subject) { return (folder / (std::string(subject) + ".mpg")).string(); };
    const std::string render = support::program() + " render " + plain_film() + " -o ";
    std::string heatmaps;
    for (const char* subject : {"tolerance", "cut", "error", "quantiser"})
        heatmaps += " --heatmap " + std::string(subject) + " " + of(subject);
    const auto outcome =
        run(render + (folder / "film.m2v").string() + seven_frames + " --tolerance coupled=0.5" + heatmaps);
    ASSERT_EQ(outcome.status, 0) << outcome.output;
    for (const char* subject : {"tolerance", "cut", "error", "quantiser"}) {
        const auto shown =
            run("ffprobe -v error -count_frames -select_streams v -show_entries "
                "stream=width,height,nb_read_frames -of csv=p=0 " +
                of(subject));
        EXPECT_TRUE(shown.output.starts_with("64,80,7")) << subject << " " << shown.output;
    }
    EXPECT_EQ(folder.entries(), 5u) << "nothing unfinished is left";

    // To look on changes nothing.
    ASSERT_EQ(run(render + (folder / "plain.m2v").string() + seven_frames + " --tolerance coupled=0.5").status, 0);
    EXPECT_EQ(contents(folder / "plain.m2v"), contents(folder / "film.m2v"));
}

TEST(Heatmap, RefusesWhatThereIsNoneOfBeforeAnythingIsDone) {
    const Folder folder;
    const auto refused = [&](const std::string& output, const std::string& options, const char* words) {
        for (const char* more : {" --dry-run --within 0", ""}) {
            const auto outcome = run(support::program() + " render " + plain_film() + " -o " +
                                     (folder / output).string() + seven_frames + options + more);
            EXPECT_TRUE(outcome.status == 1 || outcome.status == 2) << options;
            EXPECT_NE(outcome.output.find(words), std::string::npos) << outcome.output;
            EXPECT_EQ(folder.entries(), 0u) << options;
        }
    };
    const std::string heat = (folder / "h.mpg").string();
    refused("film.mpg", " --heatmap warmth " + heat, "tolerance, cut, error, quantiser");
    refused("film.mpg", " --heatmap cut " + (folder / "h.png").string(), "h.png");
    refused("f.%04d.png", " --heatmap quantiser " + heat, "only films");
    refused("film.mpg", " --tolerance reference --heatmap tolerance " + heat, "reference");
    // 1152 lines are the most there are; the legend comes on top.
    const auto outcome = run(support::program() + " render " + plain_film() + " --size 1440x1152 -o " +
                             (folder / "film.mpg").string() + " --heatmap cut " + heat);
    EXPECT_EQ(outcome.status, 1) << outcome.output;
    EXPECT_TRUE(outcome.output.starts_with("render2mpeg: heatmap cut: ")) << outcome.output;
    EXPECT_EQ(folder.entries(), 0u);
}

TEST(Heatmap, TakesItsTwoWordsAndNoMore) {
    const Folder folder;
    const std::string heat = (folder / "h.mpg").string();
    const auto outcome = run(support::program() + " render" + seven_frames + " --heatmap cut " + heat + " " +
                             plain_film() + " --dry-run --within 0 -o " + (folder / "film.mpg").string());
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    const auto alone = run(support::program() + " render " + plain_film() + " --dry-run --within 0 -o " +
                           (folder / "film.mpg").string() + " --heatmap cut");
    EXPECT_EQ(alone.status, 2) << alone.output;
}

TEST(Heatmap, HasSquarePixelsWhateverTheFilmHas) {
    const Folder folder;
    const std::string heat = (folder / "h.mpg").string();
    const auto outcome = run(support::program() + " render " + plain_film() + " -o " + (folder / "film.mpg").string() +
                             " --size 72x64 --display-aspect 16:9 --samples 1 "
                             "--exposure 0 --quiet --frames 0:0 --heatmap cut " +
                             heat);
    ASSERT_EQ(outcome.status, 0) << outcome.output;
    const auto shown = run(
        "ffprobe -v error -select_streams v -show_entries stream=width,height,sample_aspect_ratio -of csv=p=0 " + heat);
    EXPECT_TRUE(shown.output.starts_with("114,96,1:1")) << shown.output;
}

}  // namespace
}  // namespace render2mpeg::test
