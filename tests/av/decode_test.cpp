#include <gtest/gtest.h>

#include <string>

#include "av/coded_film.h"
#include "core/error.h"

namespace render2mpeg::test {
namespace {

using support::run;

struct Result {
    std::vector<core::Picture> pictures;
    std::string error;  ///< empty: none
};

Result decode(const fs::path& file) {
    Result result;
    try {
        av::decode(file, [&](const core::Picture& p) { result.pictures.push_back(p); });
    } catch (const core::Error& error) {
        result.error = error.what();
    }
    return result;
}

bool same(const core::Picture& a, const core::Picture& b) {
    return a.y == b.y && a.cb == b.cb && a.cr == b.cr;
}

/// Planes one after another, as in ffmpeg's rawvideo.
std::vector<std::uint8_t> raw(const std::vector<core::Picture>& pictures) {
    std::vector<std::uint8_t> bytes;
    for (const core::Picture& p : pictures)
        for (const auto* plane : {&p.y, &p.cb, &p.cr})
            bytes.insert(bytes.end(), plane->values().begin(), plane->values().end());
    return bytes;
}

TEST(Decode, ShowsWhatFfmpegShows) {
    for (const auto& [width, height] : {std::pair{176, 112}, {83, 61}, {2, 2}, {17, 130}}) {
        const Folder folder;
        const CodedFilm film = coded_film(folder, width, height, "25", 14, "-g 6 -bf 2 -q:v 6");
        const fs::path expected = folder / "expected.yuv";
        run("ffmpeg -v error -flags bitexact -idct simple -i " + film.source.string() + " -f rawvideo " +
            expected.string());
        const Result result = decode(film.source);
        EXPECT_EQ(result.error, "");
        ASSERT_EQ(result.pictures.size(), 14u) << "the last pictures must be fetched, too";
        EXPECT_EQ(result.pictures[0].width(), width);
        EXPECT_EQ(result.pictures[0].cb.height(), (height + 1) / 2);
        EXPECT_TRUE(result.pictures[0].luma.empty());
        EXPECT_TRUE(raw(result.pictures) == bytes_of(expected));
    }
}

TEST(Decode, StopsWhenItsReaderThrows) {
    const Folder folder;
    const CodedFilm film = coded_film(folder, 64, 48, "25", 9, "-q:v 6");
    int seen = 0;
    EXPECT_THROW(av::decode(film.source,
                            [&](const core::Picture&) {
                                if (++seen == 3) throw std::out_of_range("enough");
                            }),
                 std::out_of_range);
    EXPECT_EQ(seen, 3);
}

TEST(Decode, SaysWhichFileAndWhy) {
    const Folder folder;
    EXPECT_NE(decode(folder / "missing.mpg").error.find("missing.mpg"), std::string::npos);
    EXPECT_NE(decode(folder / "missing.mpg").error.find("No such file"), std::string::npos);
    write_bytes(folder / "empty.mpg", {});
    EXPECT_NE(decode(folder / "empty.mpg").error, "");
    write_bytes(folder / "text.mpg", std::vector<std::uint8_t>(5000, 'x'));
    EXPECT_NE(decode(folder / "text.mpg").error, "");
    EXPECT_NE(decode("tcp://localhost:1/a.mpg").error.find("No such file"), std::string::npos)
        << "names are files, not addresses";
}

TEST(Decode, RefusesPixelsThatAreNoLumaAndChroma) {
    const Folder folder;
    run("ffmpeg -v error -f lavfi -i testsrc2=size=64x48 -frames:v 3 -pix_fmt bgr0 -c:v ffv1 " +
        (folder / "a.mkv").string());
    EXPECT_NE(decode(folder / "a.mkv").error.find("bgr0"), std::string::npos);
}

/// A damaged stream is an error, not a picture that looks a little odd: every change of a bit either throws or changes
/// nothing that is shown, or is one that no decoder could notice.
TEST(Decode, NoticesDamage) {
    const Folder folder;
    const CodedFilm film = coded_film(folder, 176, 112, "25", 12, "-g 12 -q:v 4");
    const auto whole = bytes_of(film.source);
    const Result good = decode(film.source);
    ASSERT_EQ(good.error, "");
    int thrown = 0;
    constexpr int flips = 60;
    for (int i = 0; i < flips; ++i) {
        auto bytes = whole;
        const std::size_t at = 200 + (bytes.size() - 400) * static_cast<std::size_t>(i) / flips;
        bytes[at] ^= static_cast<std::uint8_t>(1 << i % 8);
        write_bytes(folder / "flipped.m2v", bytes);
        const Result result = decode(folder / "flipped.m2v");
        if (result.error.empty()) continue;
        ++thrown;
        EXPECT_NE(result.error.find("flipped.m2v"), std::string::npos);
        EXPECT_EQ(result.error.find(" @ 0x"), std::string::npos) << "addresses tell nothing: " << result.error;
    }
    EXPECT_GE(thrown, flips / 2) << "of " << flips;
    EXPECT_LT(thrown, flips) << "a sign bit is beyond any decoder";
}

TEST(Decode, NoticesThatTheEndIsMissing) {
    const Folder folder;
    const CodedFilm film = coded_film(folder, 176, 112, "25", 12, "-g 12 -q:v 4");
    const auto whole = bytes_of(film.source);
    int noticed = 0, fewer = 0;
    constexpr int cuts = 20;
    for (int i = 1; i <= cuts; ++i) {
        auto bytes = whole;
        bytes.resize(bytes.size() * static_cast<std::size_t>(i) / (cuts + 1));
        write_bytes(folder / "cut.m2v", bytes);
        const Result result = decode(folder / "cut.m2v");
        noticed += !result.error.empty();
        fewer += result.pictures.size() < 12;
    }
    EXPECT_EQ(noticed, cuts);
    EXPECT_GE(fewer, cuts - 1);
}

TEST(Decode, KeepsTheTerminalClean) {
    const Folder folder;
    const CodedFilm film = coded_film(folder, 176, 112, "25", 12, "-g 12 -q:v 4");
    auto bytes = bytes_of(film.source);
    for (std::size_t i = 500; i < bytes.size(); i += 97) bytes[i] ^= 0x55;
    write_bytes(folder / "broken.m2v", bytes);
    testing::internal::CaptureStderr();
    testing::internal::CaptureStdout();
    const Result result = decode(folder / "broken.m2v");
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
    EXPECT_NE(result.error, "");
}

TEST(Decode, OneFilmInsideAnother) {
    const Folder folder;
    const CodedFilm film = coded_film(folder, 64, 48, "25", 4, "-q:v 6");
    const Result alone = decode(film.source);
    std::size_t outer = 0;
    av::decode(film.source, [&](const core::Picture& p) {
        const Result inner = decode(film.source);
        ASSERT_EQ(inner.pictures.size(), alone.pictures.size());
        EXPECT_TRUE(same(inner.pictures[outer], alone.pictures[outer]));
        EXPECT_TRUE(same(p, alone.pictures[outer++]));
    });
    EXPECT_EQ(outer, 4u);
}

}  // namespace
}  // namespace render2mpeg::test
