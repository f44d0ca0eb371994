#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "image/image.h"
#include "pipeline/fixture.h"

/// Frames where the world is hidden, and holes.
namespace render2mpeg::test {
namespace {

/// From left to right a third each: a white wall, a hole, the sky; the wall also stands behind the hole's upper half.
constexpr const char* thirds = R"({
  "frames": 2, "size": [48, 16], "exposure": 0, "sky": [0.5, 0.5, 0.5], "transparent": true,
  "camera": { "position": [0, 0, 10], "look_at": [0, 0, 0], "height": 2 },
  "materials": { "white": { "base_color": [1, 1, 1] }, "hole": { "base_color": [1, 0, 0], "holdout": true } },
  "objects": [
    { "name": "wall", "shape": "quad", "size": [2, 2], "position": [-2, 0, 0], "material": "white" },
    { "name": "behind", "shape": "quad", "size": [2, 1], "position": [0, 0.5, -1], "material": "white" },
    { "name": "hole", "shape": "quad", "size": [2, 2], "position": [0, 0, 0], "material": "hole" }]
})";

const std::string quick = " --samples 4 --quiet ";

class Alpha : public testing::Test {
  protected:
    Alpha() { std::ofstream(folder_ / "thirds.json") << thirds; }

    void render(const std::string& output, const std::string& options = "") {
        const auto outcome = run(program() + " render " + path(folder_, "thirds.json") + quick + options + " -o " +
                                 path(folder_, output));
        ASSERT_EQ(outcome.status, 0) << outcome.output;
    }
    image::Image read(const std::string& name) const { return image::read_image(folder_ / name, {}, name); }

    Folder folder_;
};

TEST_F(Alpha, OfFramesIsWhatCoversThem) {
    render("a.%04d.exr", "--frames 0:0");
    const image::Image lit = read("a.0000.exr");
    ASSERT_TRUE(lit.has_alpha);
    for (const int y : {3, 12}) {
        EXPECT_EQ(lit.pixels.at(8, y).w, 1) << "the wall";
        EXPECT_GT(lit.pixels.at(8, y).x, 0.1f) << "is lit by the sky that nobody sees";
        EXPECT_EQ(lit.pixels.at(24, y), glm::vec4(0)) << "the hole, whatever is behind it";
        EXPECT_EQ(lit.pixels.at(40, y), glm::vec4(0)) << "the sky";
    }
    // PNG's colours are not multiplied by alpha.
    render("a.%04d.png", "--frames 0:0");
    const image::Image shown = read("a.0000.png");
    ASSERT_TRUE(shown.has_alpha);
    EXPECT_EQ(shown.pixels.at(8, 8).w, 1);
    EXPECT_EQ(shown.pixels.at(40, 8).w, 0);
}

TEST_F(Alpha, OfProRes4444IsThatOfPng) {
    render("m.mov", "--codec prores4444");
    render("n.mp4", "--also neutral:prores4444 " + path(folder_, "o.mov"));
    render("p.%04d.png", "--frames 0:0");
    const auto rgba = [&](const std::string& name) {
        return run("ffmpeg -v error -err_detect explode -i " + path(folder_, name) +
                   " -frames:v 1 -f rawvideo -pix_fmt rgba -")
            .output;
    };
    const std::string png = rgba("p.%04d.png");
    ASSERT_EQ(png.size(), 4u * 48 * 16);
    for (const char* name : {"m.mov", "o.mov"}) {
        const std::string film = rgba(name);
        ASSERT_EQ(film.size(), png.size());
        for (std::size_t i = 3; i < png.size(); i += 4)
            ASSERT_NEAR(static_cast<unsigned char>(film[i]), static_cast<unsigned char>(png[i]), 1) << name << i;
        EXPECT_GT(static_cast<unsigned char>(film[4 * (8 * 48 + 8)]), 100) << "the wall is not multiplied by alpha";
    }
}

class AlphaOfWebm : public Alpha {
  protected:
    void SetUp() override {
        if (run("ffmpeg -v error -f lavfi -i color -frames:v 1 -c:v libvpx-vp9 -f null -").status != 0)
            GTEST_SKIP() << "this FFmpeg has no libvpx";
    }
    std::string rgba(const std::string& name) const {
        const bool is_vp9 = !name.ends_with(".mov") && !name.ends_with(".png");
        return run(std::string("ffmpeg -v error -err_detect explode ") + (is_vp9 ? "-c:v libvpx-vp9 " : "") + "-i " +
                   path(folder_, name) + " -frames:v 1 -f rawvideo -pix_fmt rgba -")
            .output;
    }
    void expect_like_png(const std::string& name) const {
        const std::string png = rgba("p.%04d.png"), film = rgba(name);
        ASSERT_EQ(png.size(), 4u * 48 * 16);
        ASSERT_EQ(film.size(), png.size()) << name;
        for (int x = 0; x < 48; ++x) {
            const auto code = [&](const std::string& of, int c) {
                return static_cast<int>(static_cast<unsigned char>(
                    of[4 * (8 * 48 + static_cast<std::size_t>(x)) + static_cast<std::size_t>(c)]));
            };
            EXPECT_NEAR(code(film, 3), code(png, 3), 8) << name << " at " << x;
            // Colours beside the edge are of nothing that is seen.
            if (x < 14) {
                EXPECT_NEAR(code(film, 0), code(png, 0), 6) << name << " at " << x;
            }
        }
    }
};

TEST_F(AlphaOfWebm, IsThatOfPngSlow) {
    render("m.webm", "--quantiser 2");
    render("n.mp4", "--quantiser 2 --also neutral " + path(folder_, "o.webm"));
    render("p.%04d.png");
    for (const char* name : {"m.webm", "o.webm"}) expect_like_png(name);
    EXPECT_NE(run("ffprobe -v error -show_streams " + path(folder_, "m.webm")).output.find("alpha_mode=1"),
              std::string::npos);
}

TEST_F(AlphaOfWebm, IsThatOfFramesThatAreEncodedSlow) {
    render("p.%04d.png");
    render("q.%04d.exr");
    for (const char* made : {"p.%04d.png -q 2 -o r.webm", "q.%04d.exr -q 2 -o s.webm",
                             "p.%04d.png -q 2 -o t.mkv --codec vp9", "q.%04d.exr -o u.mov --codec prores4444"}) {
        const auto outcome =
            run("cd " + folder_.path().string() + " && " + program() + " encode --quiet --fps 25 " + made);
        ASSERT_EQ(outcome.status, 0) << outcome.output;
    }
    for (const char* name : {"r.webm", "s.webm", "t.mkv", "u.mov"}) expect_like_png(name);
}

TEST_F(Alpha, OfFramesThatAreEncodedIsDroppedWhereAskedSlow) {
    render("p.%04d.png", "--frames 0:0");
    for (const auto& [option, open] : {std::pair("", 0), {"--transparent on", 0}, {"--transparent off", 255}}) {
        const auto made = run(program() + " encode -y --quiet --fps 25 --codec prores4444 " + option + " " +
                              path(folder_, "p.%04d.png") + " -o " + path(folder_, "k.mov"));
        ASSERT_EQ(made.status, 0) << made.output;
        const std::string film =
            run("ffmpeg -v error -i " + path(folder_, "k.mov") + " -f rawvideo -pix_fmt rgba -").output;
        ASSERT_EQ(film.size(), 4u * 48 * 16);
        EXPECT_NEAR(static_cast<unsigned char>(film[4 * (8 * 48 + 40) + 3]), open, 1) << option << " of the sky";
        EXPECT_NEAR(static_cast<unsigned char>(film[4 * (8 * 48 + 8) + 3]), 255, 1) << option << " of the wall";
    }
}

TEST_F(AlphaOfWebm, IsNoneWhereTheFilmHasNone) {
    render("v.webm", "--transparent off --quantiser 2 --frames 0:0");
    const std::string holes = run("ffprobe -v error -show_streams " + path(folder_, "v.webm")).output;
    EXPECT_NE(holes.find("alpha_mode=1"), std::string::npos) << "the hole stays";
    std::string film = thirds;
    for (const std::string& word : {std::string(R"(, "holdout": true)"), std::string(R"(, "transparent": true)")})
        film.erase(film.find(word), word.size());
    std::ofstream(folder_ / "thirds.json") << film;
    render("w.webm", "--quantiser 2 --frames 0:0");
    const std::string streams = run("ffprobe -v error -show_streams " + path(folder_, "w.webm")).output;
    EXPECT_NE(streams.find("codec_name=vp9"), std::string::npos);
    EXPECT_EQ(streams.find("alpha_mode"), std::string::npos);
}

TEST_F(Alpha, IsOneWhereTheSkyIsSeenAndHolesStay) {
    render("b.%04d.exr", "--frames 0:0 --transparent off");
    const image::Image lit = read("b.0000.exr");
    EXPECT_EQ(lit.pixels.at(24, 8), glm::vec4(0));
    EXPECT_EQ(lit.pixels.at(40, 8).w, 1);
    EXPECT_NEAR(lit.pixels.at(40, 8).x, 0.5f, 0.01f);
}

TEST_F(Alpha, IsThatOfWhatTheCameraLooksAtWithinItsPlanes) {
    std::string film = thirds;
    const std::string hole = R"("base_color": [1, 0, 0], "holdout": true)", camera = R"("height": 2)";
    film.replace(film.find(hole), hole.size(),
                 R"("base_color": 0, "emission": [4, 0, 0], "double_sided": true, "seen": false)");
    std::ofstream(folder_ / "thirds.json") << film;
    render("g.%04d.exr", "--frames 0:0");
    const image::Image lit = read("g.0000.exr");
    EXPECT_EQ(lit.pixels.at(24, 12), glm::vec4(0)) << "nothing is behind it";
    EXPECT_EQ(lit.pixels.at(24, 4).w, 1) << "the wall behind it";
    EXPECT_GT(lit.pixels.at(24, 4).x, 2 * lit.pixels.at(24, 4).y) << "is lit by what the camera does not see";
    film.replace(film.find(camera), camera.size(), R"("height": 2, "far": 10.5)");
    std::ofstream(folder_ / "thirds.json") << film;
    render("h.%04d.exr", "--frames 0:0");
    const image::Image cut = read("h.0000.exr");
    EXPECT_EQ(cut.pixels.at(24, 4), glm::vec4(0)) << "the wall lies beyond";
    EXPECT_EQ(cut.pixels.at(8, 4).w, 1) << "the other does not";
}

TEST_F(Alpha, OfLayersIsThatOfTheirMattes) {
    render("c.%04d.exr", "--frames 0:0 --aov " + path(folder_, "layers"));
    const image::ExrChannels read = image::read_exr(folder_ / "layers/frame_0000.exr", [](const std::string& name) {
        return name == "A" || name == "ViewLayer.CryptoObject00.G";
    });
    ASSERT_EQ(read.channels.size(), 2u);
    EXPECT_EQ(read.channels[0].values, read.channels[1].values) << "one thing covers each pixel";
}

TEST_F(Alpha, OfFilmsIsNone) {
    render("d.mpg");
    const std::string codes = codes_of(path(folder_, "d.mpg"));
    ASSERT_EQ(codes.size(), 48u * 16 * 3);
    EXPECT_LT(static_cast<unsigned char>(codes[3 * (8 * 48 + 40)]), 8) << "black";
    EXPECT_GT(static_cast<unsigned char>(codes[3 * (8 * 48 + 8)]), 60);
}

TEST_F(Alpha, OfWhatTheShutterBlursIsItsShareOfTheTime) {
    std::string film = thirds;
    const std::string wall = R"("position": [-2, 0, 0])";
    film.replace(film.find(wall), wall.size(),
                 R"("keys": [{ "at": 0, "position": [-2, 0, -0.5] }, { "at": 0.04, "position": [2, 0, -0.5] }])");
    std::ofstream(folder_ / "thirds.json") << film;
    render("e.%04d.exr", "--frames 0:0 --shutter 180 --fps 25 --transparent on");
    const image::Image lit = read("e.0000.exr");
    // It stands still until the middle of the shutter's time, then goes 8 pixels behind the hole.
    EXPECT_EQ(lit.pixels.at(20, 3).w, 0) << "the hole's";
    double sum = 0;
    for (int x = 0; x < 16; ++x) sum += static_cast<double>(lit.pixels.at(x, 8).w);
    EXPECT_NEAR(sum, 14, 0.5) << "a quarter of the time it leaves half of its place";
}

}  // namespace
}  // namespace render2mpeg::test
