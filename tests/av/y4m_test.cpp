#include "encoder/av/y4m.h"

#include <gtest/gtest.h>

#include <string>

#include "av/coded_film.h"
#include "core/error.h"
#include "core/sampling.h"

namespace render2mpeg::test {
namespace {

core::Plane<std::uint8_t> noise(int width, int height, std::uint64_t seed) {
    core::Plane<std::uint8_t> plane(width, height);
    std::uint64_t i = 0;
    for (std::uint8_t& v : plane.values()) v = static_cast<std::uint8_t>(16.0f + 219.0f * core::uniform(seed, i++));
    return plane;
}

core::Picture picture(int width, int height, std::uint64_t seed) {
    core::Picture p;
    p.y = noise(width, height, seed);
    p.cb = noise((width + 1) / 2, (height + 1) / 2, seed + 100);
    p.cr = noise((width + 1) / 2, (height + 1) / 2, seed + 200);
    return p;
}

TEST(Y4m, IsReadByFfmpegBitByBit) {
    for (const auto& [width, height] : {std::pair{64, 48}, {33, 17}, {1, 1}}) {
        const Folder folder;
        av::Y4mWriter writer(folder / "film.y4m", width, height, core::frame_rate_from("29.97"), {16, 11});
        std::vector<std::uint8_t> expected;
        for (std::uint64_t n = 0; n < 3; ++n) {
            const core::Picture p = picture(width, height, n);
            writer.write(p);
            for (const auto* plane : {&p.y, &p.cb, &p.cr})
                expected.insert(expected.end(), plane->values().begin(), plane->values().end());
        }
        writer.finish();
        support::run("ffmpeg -v error -i " + (folder / "film.y4m").string() + " -f rawvideo -pix_fmt yuv420p " +
                     (folder / "raw.yuv").string());
        EXPECT_TRUE(bytes_of(folder / "raw.yuv") == expected);
        const std::string said = support::run(
                                     "ffprobe -v error -show_entries "
                                     "stream=pix_fmt,r_frame_rate,sample_aspect_ratio,color_range,chroma_location "
                                     "-of csv=p=0 " +
                                     (folder / "film.y4m").string())
                                     .output;
        EXPECT_EQ(said, "16:11,yuv420p,tv,left,30000/1001\n");
    }
}

TEST(Y4m, HasItsNameOnlyWhenItIsWhole) {
    const Folder folder;
    {
        av::Y4mWriter writer(folder / "film.y4m", 8, 8, core::frame_rate_from("25"));
        writer.write(picture(8, 8, 1));
        EXPECT_FALSE(fs::exists(folder / "film.y4m"));
        EXPECT_EQ(folder.entries(), 1u);
    }
    EXPECT_EQ(folder.entries(), 0u) << "what was given up leaves nothing behind";
    av::Y4mWriter writer(folder / "film.y4m", 8, 8, core::frame_rate_from("25"));
    writer.write(picture(8, 8, 1));
    writer.finish();
    EXPECT_TRUE(fs::exists(folder / "film.y4m"));
    EXPECT_EQ(folder.entries(), 1u);
}

TEST(Y4m, SaysWhyItCannotWrite) {
    const Folder folder;
    try {
        av::Y4mWriter(folder / "no/such/film.y4m", 8, 8, core::frame_rate_from("25"));
        FAIL() << "writes into a folder that does not exist";
    } catch (const core::Error& error) {
        EXPECT_NE(std::string(error.what()).find("no/such/film.y4m"), std::string::npos);
        EXPECT_NE(std::string(error.what()).find("No such file"), std::string::npos) << error.what();
    }
}

TEST(Y4m, SaysThatTheDiskIsFull) {
    if (!fs::exists("/dev/full")) GTEST_SKIP() << "this system has no /dev/full";
    const Folder folder;
    fs::create_symlink("/dev/full", folder / "film.y4m.tmp");
    try {
        av::Y4mWriter writer(folder / "film.y4m", 64, 64, core::frame_rate_from("25"));
        for (std::uint64_t n = 0; n < 20; ++n) writer.write(picture(64, 64, n));
        writer.finish();
        FAIL() << "writes to a full disk";
    } catch (const core::Error& error) {
        EXPECT_NE(std::string(error.what()).find("No space left"), std::string::npos) << error.what();
    }
    EXPECT_FALSE(fs::exists(folder / "film.y4m"));
}

TEST(Y4m, TakesNoPictureOfAnotherSize) {
    const Folder folder;
    av::Y4mWriter writer(folder / "film.y4m", 8, 8, core::frame_rate_from("25"));
    EXPECT_THROW(writer.write(picture(8, 10, 1)), core::ContractViolation);
    core::Picture odd = picture(8, 8, 1);
    odd.cr = noise(8, 8, 3);
    EXPECT_THROW(writer.write(odd), core::ContractViolation);
}

}  // namespace
}  // namespace render2mpeg::test
