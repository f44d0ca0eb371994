#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "av/coded_film.h"
#include "encoder/encoder.h"

namespace render2mpeg::test {
namespace {

/// A disc that wanders over a slope.
core::Picture scene(int width, int height, std::int64_t number) {
    core::Picture p;
    p.number = number;
    p.y = core::Plane<std::uint8_t>(width, height);
    p.cb = core::Plane<std::uint8_t>((width + 1) / 2, (height + 1) / 2, 110);
    p.cr = core::Plane<std::uint8_t>((width + 1) / 2, (height + 1) / 2, 140);
    const double cx = width * 0.3 + 3.0 * static_cast<double>(number), cy = height * 0.5;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            p.y.at(x, y) =
                static_cast<std::uint8_t>(std::hypot(x - cx, y - cy) < height * 0.25 ? 200 : 40 + (x + 2 * y) % 90);
    p.luma = core::Plane<float>(width, height);
    for (std::size_t i = 0; i < p.y.size(); ++i) p.luma.values()[i] = p.y.values()[i];
    return p;
}

struct Native {
    CodedFilm film;
    std::vector<core::Picture> reconstructions;  ///< in display order
};

Native native_film(int width, int height, int pictures) {
    Native native;
    encoder::Settings& settings = native.film.settings;
    settings.width = width;
    settings.height = height;
    settings.rate = core::frame_rate_from("25");
    settings.gop = 6;
    encoder::Encoder encoder(settings);
    const auto keep = [&](std::vector<encoder::CodedPicture> coded) {
        for (encoder::CodedPicture& c : coded) {
            native.film.largest = std::max(native.film.largest, c.bytes.size());
            native.film.pictures.push_back({std::move(c.bytes), c.plan.number, c.plan.starts_gop});
            native.reconstructions.push_back(std::move(c.reconstruction));
        }
    };
    for (int n = 0; n < pictures; ++n) {
        const encoder::PicturePlan plan = encoder.plan(n, {}, n == 0);
        keep(encoder.push(scene(width, height, n), plan, {}));
    }
    keep(encoder.flush());
    const auto end = encoder::sequence_end();
    auto& last = native.film.pictures.back().bytes;
    last.insert(last.end(), end.begin(), end.end());
    return native;
}

/// The program's own films, through every container: what comes out is what the encoder said that a decoder would show.
void expect_reconstructions(int width, int height) {
    const Folder folder;
    const Native native = native_film(width, height, 14);
    for (const char* ending : {"mpg", "ts", "m2v", "mkv", "mp4"}) {
        SCOPED_TRACE(ending);
        const fs::path file = native.film.mux(folder / (std::string("film.") + ending));
        std::size_t n = 0;
        av::decode(file, [&](const core::Picture& p) {
            ASSERT_LT(n, native.reconstructions.size());
            const core::Picture& expected = native.reconstructions[n++];
            EXPECT_TRUE(p.y == expected.y && p.cb == expected.cb && p.cr == expected.cr) << "picture " << p.number;
        });
        EXPECT_EQ(n, 14u);
        const support::Outcome strict =
            support::run("ffmpeg -v error -xerror -err_detect explode -i " + file.string() + " -f null -");
        EXPECT_EQ(strict.status, 0);
        EXPECT_EQ(strict.output, "");
    }
}

TEST(NativeFilm, ComesOutOfEveryContainerAsTheEncoderReconstructedIt) {
    expect_reconstructions(93, 71);
}

TEST(NativeFilm, OfWholeMacroblocksComesOutOfEveryContainerSlow) {
    expect_reconstructions(176, 112);
}

TEST(NativeFilm, IsCountedWholeByAnotherDecoder) {
    if (support::run("command -v mpeg2dec").status != 0) GTEST_SKIP() << "mpeg2dec is not installed";
    const Folder folder;
    const Native native = native_film(176, 112, 14);
    for (const auto& [name, option] : {std::pair{"film.m2v", ""}, {"film.mpg", "-s "}, {"film.ts", "-t 0x100 "}}) {
        const fs::path file = native.film.mux(folder / name);
        const std::string sums =
            support::run("mpeg2dec -o md5 " + std::string(option) + file.string() + " 2>/dev/null").output;
        EXPECT_EQ(std::count(sums.begin(), sums.end(), '\n'), 14) << name << "\n" << sums;
    }
}

}  // namespace
}  // namespace render2mpeg::test
