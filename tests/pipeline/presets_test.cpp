#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <tuple>

#include "pipeline/fixture.h"

/// Presets, keyframes and shapes, as a user asks for them.
namespace render2mpeg::test {
namespace {

TEST(Preset, WhatContradictsItIsRefusedBeforeAnythingIsWritten) {
    const Folder folder;
    write_frames(path(folder, "in.y4m"), 96, 64, "25:1", "1:1", 2);
    const auto refused = [&](const std::string& arguments, std::initializer_list<const char*> words) {
        const auto outcome = run(program() + " " + arguments);
        EXPECT_TRUE(outcome.status == 1 || outcome.status == 2) << outcome.output;
        for (const char* word : words)
            EXPECT_NE(outcome.output.find(word), std::string::npos) << outcome.output << " lacks " << word;
    };
    const std::string in = path(folder, "in.y4m"), out = " -o " + path(folder, "a.mpg");
    refused("encode " + in + out + " --for dvd-pal", {"96x64", "--for dvd-pal"});
    refused("render " + plain_film() + out + " --for dvd-pal --gop 16", {"--gop 16", "--for dvd-pal", "15"});
    refused("render " + plain_film() + " --for dvd-pal -o " + path(folder, "a.mkv"), {"a.mkv", "--for dvd-pal"});
    refused("render " + plain_film() + out + " --for atsc", {"a.mpg", "--for atsc"});
    refused("render " + plain_film() + out + " --pixel-aspect 1:1 --display-aspect 4:3", {"--pixel-aspect"});
    EXPECT_EQ(folder.entries(), 1u) << "only the frames that the test wrote";
}

TEST(Keyframes, BeginGopsInFilmsSlow) {
    const Folder folder;
    write_frames(path(folder, "in.y4m"), 96, 64, "25:1", "1:1", 20);
    std::ofstream(folder / "k.txt") << "# a chapter\n9\n";
    const auto types = [&](const std::string& more) {
        const auto made = run(program() + " encode -y " + path(folder, "in.y4m") + " -o " + path(folder, "a.m2v") +
                              " --gop 8 --quiet --stats " + path(folder, "s.json") + more);
        EXPECT_EQ(made.status, 0) << made.output;
        return types_in(folder / "s.json");
    };
    // What is not an I picture is as its cost tells.
    const auto keys = [](const std::string& all) {
        std::vector<std::size_t> found;
        for (std::size_t i = 0; i < all.size(); ++i)
            if (all[i] == 'I') found.push_back(i);
        return found;
    };
    using Places = std::vector<std::size_t>;
    EXPECT_EQ(keys(types("")), (Places{0, 8, 16}));
    EXPECT_EQ(keys(types(" --keyframes 3,4,900")), (Places{0, 3, 4, 12}));
    EXPECT_EQ(keys(types(" --keyframes " + path(folder, "k.txt"))), (Places{0, 8, 9, 17}));

    // A render's B pictures keep away from them; they stand alone until it is known how light changes.
    const auto render =
        run(program() + " render -y --hold " + plain_film() + " --size 32x32 --samples 1 --frames 0:9" +
            " --exposure 0 --quiet --keyframes 4 -o " + path(folder, "b.m2v") + " --stats " + path(folder, "s.json"));
    ASSERT_EQ(render.status, 0) << render.output;
    const std::string rendered = types_in(folder / "s.json");
    EXPECT_EQ(keys(rendered), (Places{0, 4}));
    EXPECT_EQ(rendered[3], 'P') << rendered;
    EXPECT_EQ(rendered.back(), 'P') << rendered;
}

/// A white disc's width and height in pixels, from the second moments of the first picture of a Y4M file.
struct Extent {
    double width, height;
};
Extent disc_in(const std::string& file, int width, int height) {
    const std::string bytes = contents(file);
    const std::size_t start = bytes.find("FRAME\n") + 6;
    double sum = 0, x1 = 0, y1 = 0, x2 = 0, y2 = 0;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const double v = static_cast<unsigned char>(bytes[start + static_cast<std::size_t>(y * width + x)]) - 16.0;
            sum += v, x1 += v * x, y1 += v * y, x2 += v * x * x, y2 += v * y * y;
        }
    // A disc's second moment about its centre is a sixteenth of its diameter's square.
    return {4 * std::sqrt(x2 / sum - x1 / sum * x1 / sum), 4 * std::sqrt(y2 / sum - y1 / sum * y1 / sum)};
}

TEST(Shape, ABallIsRoundAsShownAndMovesByWhatItsVectorsSay) {
    const Folder folder;
    std::ofstream(folder / "film.json") << R"({
        "camera": { "position": [0, 0, 4], "fov": 40 }, "sky": { "color": 0 }, "exposure": 0, "frames": 4,
        "objects": [{ "shape": "sphere", "radius": 0.9, "segments": 96, "material": { "emission": 1, "base_color": 0 },
                      "interpolation": "linear", "keys": [{ "at": 0, "position": [-0.2, 0, 0] },
                                                          { "at": 0.16, "position": [0.2, 0, 0] }] }] })";
    const std::string render =
        program() + " render -y --hold " + folder.path().string() + " --samples 4 --vpls 0 --quiet ";
    for (const auto& [size, width, height, shape, pixel] : {std::tuple{"144x96", 144, 96, "16:9", 32.0 / 27},
                                                            {"144x96", 144, 96, "4:3", 8.0 / 9},
                                                            {"144x116", 144, 116, "4:3", 4.0 / 3 * 116 / 144}}) {
        SCOPED_TRACE(std::string(size) + " " + shape);
        const std::string options = " --size " + std::string(size) + " --display-aspect " + shape;
        const auto made = run(render + options + " --frames 1:1 -o " + path(folder, "a.y4m"));
        ASSERT_EQ(made.status, 0) << made.output;
        const Extent disc = disc_in(path(folder, "a.y4m"), width, height);
        EXPECT_GT(disc.height, 0.5 * height);
        EXPECT_NEAR(disc.width * pixel / disc.height, 1, 0.02);

        // With exact motion a white ball on black costs next to nothing after the first picture.
        const auto film = run(render + options + " -o " + path(folder, "a.m2v") + " --stats " + path(folder, "s.json"));
        ASSERT_EQ(film.status, 0) << film.output;
        const json statistics = json::parse(contents(folder / "s.json"));
        const double first = statistics.at("per_frame")[0].at("bytes"), all = statistics.at("bytes");
        EXPECT_LT(all - first, 1.6 * first);
        EXPECT_GT(statistics.at("psnr_y"), 35);
    }
}

TEST(Shape, ReachesEveryKindOfOutputSlow) {
    const Folder folder;
    const std::string render = program() + " render -y --hold " + plain_film() +
                               " --size 72x64 --display-aspect 16:9 --samples 1 --vpls 0 --frames 0:4 --exposure 0 "
                               "--tolerance fixed=20% --quiet -o ";
    for (const char* name : {"a.mpg", "a.ts", "a.m2v", "a.mkv", "a.mp4", "a.y4m"}) {
        ASSERT_EQ(run(render + path(folder, name)).status, 0);
        const json video = ffprobe(path(folder, name));
        EXPECT_EQ(video.at("display_aspect_ratio"), "16:9") << name;
        EXPECT_EQ(video.at("sample_aspect_ratio"), "128:81") << name;
    }
    // Frames that say their shape become a film that says it.
    ASSERT_EQ(run(render + path(folder, "f.%04d.exr")).status, 0);
    for (const char* name : {"a.y4m", "f.%04d.exr"}) {
        ASSERT_EQ(run(program() + " encode -y " + path(folder, name) + " --quiet -o " + path(folder, "b.mpg")).status,
                  0);
        EXPECT_EQ(ffprobe(path(folder, "b.mpg")).at("display_aspect_ratio"), "16:9") << name;
    }
}

}  // namespace
}  // namespace render2mpeg::test
