#include "encoder/av/y4m_reader.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <numbers>
#include <string>

#include "av/coded_film.h"
#include "core/error.h"
#include "core/sampling.h"
#include "encoder/av/y4m.h"

namespace render2mpeg::test {
namespace {

using Siting = av::Y4mFormat::Siting;

core::Plane<std::uint8_t> plane(int width, int height, const std::function<double(double, double)>& value) {
    core::Plane<std::uint8_t> p(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) p.at(x, y) = static_cast<std::uint8_t>(std::lround(value(x, y)));
    return p;
}

core::Picture noisy(int width, int height, std::uint64_t seed) {
    std::uint64_t i = 0;
    const auto noise = [&](double, double) { return 255.0 * static_cast<double>(core::uniform(seed, i++)); };
    core::Picture p;
    p.y = plane(width, height, noise);
    p.cb = plane((width + 1) / 2, (height + 1) / 2, noise);
    p.cr = plane((width + 1) / 2, (height + 1) / 2, noise);
    return p;
}

/// A Y4M file with this header line and one frame.
fs::path written(const Folder& folder, const std::string& header, const core::Picture& picture,
                 const std::string& frame = "FRAME") {
    std::ofstream stream(folder / "film.y4m", std::ios::binary);
    stream << header << "\n" << frame << "\n";
    for (const auto* p : {&picture.y, &picture.cb, &picture.cr})
        stream.write(reinterpret_cast<const char*>(p->values().data()), static_cast<std::streamsize>(p->size()));
    return folder / "film.y4m";
}

void expect_refusal(const fs::path& file, const std::string& words) {
    try {
        const av::Y4mReader reader(file);
        FAIL() << "takes a file that should be refused: " << words;
    } catch (const core::Error& error) {
        const std::string line = error.what();
        EXPECT_NE(line.find(words), std::string::npos) << line;
        EXPECT_NE(line.find(file.string()), std::string::npos) << line;
        EXPECT_EQ(line.find('\n'), std::string::npos) << line;
    }
}

TEST(Y4mReader, ReadsBackWhatWasWrittenInAnyOrder) {
    for (const auto& [width, height] : {std::pair{64, 48}, {33, 17}, {1, 1}}) {
        const Folder folder;
        av::Y4mWriter writer(folder / "film.y4m", width, height, core::frame_rate_from("29.97"), {16, 11});
        for (std::uint64_t n = 0; n < 3; ++n) writer.write(noisy(width, height, n));
        writer.finish();
        av::Y4mReader reader(folder / "film.y4m");
        EXPECT_EQ(reader.frames(), 3);
        EXPECT_EQ(reader.format().hertz, (core::Rational{30000, 1001}));
        EXPECT_EQ(reader.format().pixel_aspect, (core::Rational{16, 11}));
        EXPECT_EQ(reader.format().siting, Siting::mpeg2);
        for (const std::uint64_t n : {2u, 0u, 1u}) {
            const core::Picture read = reader.read(static_cast<std::int64_t>(n)), expected = noisy(width, height, n);
            EXPECT_EQ(read.number, static_cast<std::int64_t>(n));
            EXPECT_TRUE(read.y == expected.y && read.cb == expected.cb && read.cr == expected.cr) << n;
            EXPECT_TRUE(read.luma.empty());
        }
    }
}

TEST(Y4mReader, ReadsWhatFfmpegWrites) {
    const Folder folder;
    const std::string source = "ffmpeg -y -v error -f lavfi -i testsrc2=size=98x50:rate=24:duration=0.16 ",
                      films = (folder / "film.y4m").string() + " -pix_fmt yuv420p -f rawvideo " +
                              (folder / "raw.yuv").string();
    // From ffmpeg 7 on frames say where chroma is, before that the encoder's options.
    const std::string frames_say = source + "-pix_fmt yuv420p -vf setparams=chroma_location=left " + films,
                      encoder_says = source + "-pix_fmt yuv420p -chroma_sample_location left " + films;
    ASSERT_EQ(support::run(frames_say + " || " + encoder_says).status, 0);
    av::Y4mReader reader(folder / "film.y4m");
    ASSERT_EQ(reader.frames(), 4);
    EXPECT_EQ(reader.format().hertz, (core::Rational{24, 1}));
    ASSERT_EQ(reader.format().siting, Siting::mpeg2);
    std::vector<std::uint8_t> all;
    for (std::int64_t n = 0; n < 4; ++n) {
        const core::Picture p = reader.read(n);
        for (const auto* samples : {&p.y, &p.cb, &p.cr})
            all.insert(all.end(), samples->values().begin(), samples->values().end());
    }
    EXPECT_TRUE(all == bytes_of(folder / "raw.yuv"));
}

TEST(Y4mReader, MovesChromaOfOtherSitingsToWhereMpeg2HasIt) {
    // A slow wave over the picture, sampled where each siting samples it; the sums are places in luma samples.
    const auto wave = [](double x, double y) {
        return 128 + 50 * std::sin(2 * std::numbers::pi * x / 31) + 40 * std::cos(2 * std::numbers::pi * y / 27);
    };
    const auto sited = [&](double x0, double y0) {
        return plane(32, 24, [&](double x, double y) { return wave(2 * x + x0, 2 * y + y0); });
    };
    core::Picture expected;
    expected.y = plane(64, 48, [](double, double) { return 100; });
    expected.cb = expected.cr = sited(0, 0.5);
    struct Case {
        std::string tag;
        core::Plane<std::uint8_t> cb, cr;
    };
    for (const Case& c :
         {Case{" C420jpeg", sited(0.5, 0.5), sited(0.5, 0.5)}, Case{"", sited(0.5, 0.5), sited(0.5, 0.5)},
          Case{" C420paldv", sited(0, 1), sited(0, 0)}, Case{" C420mpeg2", expected.cb, expected.cr}}) {
        const Folder folder;
        core::Picture picture = expected;
        picture.cb = c.cb;
        picture.cr = c.cr;
        av::Y4mReader reader(written(folder, "YUV4MPEG2 W64 H48 F25:1 Ip" + c.tag, picture));
        const core::Picture read = reader.read(0);
        EXPECT_TRUE(read.y == expected.y);
        // The outermost samples lack a neighbour.
        int worst_cb = 0, worst_cr = 0;
        for (int y = 2; y < 22; ++y)
            for (int x = 2; x < 30; ++x) {
                worst_cb = std::max(worst_cb, std::abs(read.cb.at(x, y) - expected.cb.at(x, y)));
                worst_cr = std::max(worst_cr, std::abs(read.cr.at(x, y) - expected.cr.at(x, y)));
            }
        EXPECT_LE(worst_cb, 1) << c.tag << ": unmoved it would be up to 5";
        EXPECT_LE(worst_cr, 1) << c.tag;
    }
}

TEST(Y4mReader, AFlatPictureStaysFlatWhateverItsSiting) {
    for (const int level : {0, 16, 128, 255})
        for (const char* tag : {"420jpeg", "420paldv"}) {
            const Folder folder;
            core::Picture picture = noisy(7, 5, 1);
            picture.cb = picture.cr = core::Plane<std::uint8_t>(4, 3, static_cast<std::uint8_t>(level));
            av::Y4mReader reader(written(folder, std::string("YUV4MPEG2 W7 H5 F25:1 C") + tag, picture));
            const core::Picture read = reader.read(0);
            EXPECT_TRUE(read.cb == picture.cb && read.cr == picture.cr) << tag << " " << level;
        }
}

TEST(Y4mReader, FullRangeBecomesLimited) {
    const Folder folder;
    core::Picture picture;
    picture.y = plane(4, 2, [](double x, double y) { return y == 0 ? 85 * x : 255; });
    picture.cb = plane(2, 1, [](double x, double) { return 255 * x; });
    picture.cr = core::Plane<std::uint8_t>(2, 1, 128);
    av::Y4mReader reader(written(folder, "YUV4MPEG2 W4 H2 F25:1 C420mpeg2 XCOLORRANGE=FULL", picture));
    const core::Picture read = reader.read(0);
    EXPECT_EQ(read.y.at(0, 0), 16);
    EXPECT_EQ(read.y.at(1, 0), 89);
    EXPECT_EQ(read.y.at(3, 0), 235);
    EXPECT_FLOAT_EQ(read.luma.at(1, 0), 89.0f);
    EXPECT_EQ(read.cb.at(0, 0), 16);
    EXPECT_EQ(read.cb.at(1, 0), 240);
    EXPECT_EQ(read.cr.at(0, 0), 128);
}

/// Samples of a wave over the picture, one where each `across` and `down` of luma's are, the first at (0, y0).
void put_samples(std::string& bytes, int width, int height, int across, int down, double y0, int depth,
                 const std::function<double(double, double)>& wave) {
    for (int y = 0; y < (height + down - 1) / down; ++y)
        for (int x = 0; x < (width + across - 1) / across; ++x) {
            const auto code = std::lround(wave(across * x, down * y + y0) * (1 << (depth - 8)));
            bytes.push_back(static_cast<char>(code & 255));
            if (depth > 8) bytes.push_back(static_cast<char>(code >> 8));
        }
}

TEST(Y4mReader, TakesAllDepthsAndKindsOfChroma) {
    constexpr int width = 65, height = 47;
    const auto luma = [](double x, double y) { return 120 + 60 * std::sin(x / 9 + y / 7); };
    const auto chroma = [](double x, double y) { return 128 + 50 * std::sin(x / 11) + 40 * std::cos(y / 8); };
    struct Case {
        const char* tag;
        int across, down, depth;
    };
    for (const Case& c : {Case{"422", 2, 1, 8},
                          {"444", 1, 1, 8},
                          {"420p10", 2, 2, 10},
                          {"422p10", 2, 1, 10},
                          {"444p12", 1, 1, 12},
                          {"444p16", 1, 1, 16},
                          {"420p9", 2, 2, 9}}) {
        SCOPED_TRACE(c.tag);
        const Folder folder;
        std::string bytes;
        put_samples(bytes, width, height, 1, 1, 0, c.depth, luma);
        for (int plane = 0; plane < 2; ++plane)
            put_samples(bytes, width, height, c.across, c.down, c.down == 2 ? 0.5 : 0, c.depth, chroma);
        std::ofstream(folder / "film.y4m", std::ios::binary)
            << "YUV4MPEG2 W" << width << " H" << height << " F25:1 C" << c.tag << "\nFRAME\n"
            << bytes;
        const core::Picture read = av::Y4mReader(folder / "film.y4m", core::ExactChroma::full).read(0);
        ASSERT_EQ(av::Y4mReader(folder / "film.y4m").frames(), 1);
        EXPECT_TRUE(av::Y4mReader(folder / "film.y4m").read(0).exact_cb.empty()) << "nobody asked for it";
        ASSERT_EQ(read.exact_cr.size(), read.luma.size());
        ASSERT_EQ(read.cb.size(), std::size_t{33 * 24});
        const double step = 0.501 / (1 << (c.depth - 8));
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                ASSERT_NEAR(read.luma.at(x, y), luma(x, y), step);
                ASSERT_EQ(read.y.at(x, y), std::lround(read.luma.at(x, y)));
                // Straight lines between samples of the wave err by half a code value, more at borders.
                if (x < 2 || y < 2 || x > width - 3 || y > height - 3) continue;
                ASSERT_NEAR(read.exact_cb.at(x, y), chroma(x, y), c.across == 1 ? step : 0.6 + step);
                if (x % 2 == 0 && y % 2 == 0) {
                    ASSERT_NEAR(read.cb.at(x / 2, y / 2), chroma(x, y + 0.5), 0.8 + step);
                }
            }
        EXPECT_TRUE(read.cb == read.cr && read.exact_cb == read.exact_cr);
        const core::Picture halved = av::Y4mReader(folder / "film.y4m", core::ExactChroma::halved).read(0);
        ASSERT_EQ(halved.exact_cb.size(), read.cb.size());
        for (std::size_t i = 0; i < read.cb.size(); ++i)
            ASSERT_EQ(read.cb.values()[i], std::lround(halved.exact_cb.values()[i]));
        EXPECT_TRUE(halved.cb == read.cb && halved.exact_cb == halved.exact_cr);
    }
}

TEST(Y4mReader, PicturesWithoutChromaAreGrey) {
    const Folder folder;
    std::string bytes;
    for (const int code : {0, 1 << 15, 65535, 40000}) {
        bytes.push_back(static_cast<char>(code & 255));
        bytes.push_back(static_cast<char>(code >> 8));
    }
    std::ofstream(folder / "film.y4m", std::ios::binary) << "YUV4MPEG2 W2 H2 F25:1 Cmono16 XCOLORRANGE=FULL\nFRAME\n"
                                                         << bytes;
    const core::Picture read = av::Y4mReader(folder / "film.y4m", core::ExactChroma::full).read(0);
    EXPECT_EQ(read.y.at(0, 0), 16);
    EXPECT_NEAR(read.luma.at(1, 0), 16 + 219 * 32768.0 / 65535, 1e-4);
    EXPECT_EQ(read.y.at(0, 1), 235);
    EXPECT_EQ(read.cb.at(0, 0), 128);
    EXPECT_EQ(read.cr.at(0, 0), 128);
}

TEST(Y4mReader, RefusesOtherKindsByName) {
    const core::Picture picture = noisy(8, 8, 1);
    for (const char* kind : {"411", "444alpha", "420p8", "420p17", "422p", "mono-10", "420jpegp10"}) {
        const Folder folder;
        expect_refusal(written(folder, std::string("YUV4MPEG2 W8 H8 F25:1 Ip C") + kind, picture),
                       std::string("C") + kind);
    }
    for (const char* kind : {"t", "b", "m"}) {
        const Folder folder;
        expect_refusal(written(folder, std::string("YUV4MPEG2 W8 H8 F25:1 I") + kind, picture), "interlaced");
    }
    const Folder folder;
    expect_refusal(written(folder, "YUV4MPEG2 W8 H8 F25:1", picture, "FRAME Itip"), "frame 0");
}

TEST(Y4mReader, RefusesWhatIsDamagedAndSaysWhere) {
    const core::Picture picture = noisy(8, 8, 1);
    for (const auto& [header, words] : {std::pair{"P6 8 8 255", "not a Y4M file"},
                                        {"YUV4MPEG2X W8 H8", "not a Y4M file"},
                                        {"YUV4MPEG2 W8", "how large"},
                                        {"YUV4MPEG2 W0 H8", "16383"},
                                        {"YUV4MPEG2 W8 H99999999999", "16383"},
                                        {"YUV4MPEG2 W8 H-8", "16383"},
                                        {"YUV4MPEG2 W8 H8 F25", "ratio"},
                                        {"YUV4MPEG2 W8 H8 F9999999999999:1", "ratio"},
                                        {"YUV4MPEG2 W8 H9 F25:1", "frame 0: it is cut off"},
                                        {"YUV4MPEG2 W4 H4 F25:1", "frame 1: it does not begin"}}) {
        const Folder folder;
        expect_refusal(written(folder, header, picture), words);
    }
    const Folder folder;
    expect_refusal(folder / "absent.y4m", "no such file");
    expect_refusal(folder.path(), "not a file");
    std::ofstream(folder / "empty.y4m").close();
    expect_refusal(folder / "empty.y4m", "not a Y4M file");
    std::ofstream(folder / "header.y4m") << "YUV4MPEG2 W8 H8 F25:1\n";
    expect_refusal(folder / "header.y4m", "no pictures");
}

TEST(Y4mReader, UnknownRateAndShapeAreNotGuessed) {
    const Folder folder;
    const av::Y4mReader reader(written(folder, "YUV4MPEG2 W8 H8 F0:0 A0:0 Xcomment Zfuture", noisy(8, 8, 1)));
    EXPECT_FALSE(reader.format().hertz.has_value());
    EXPECT_FALSE(reader.format().pixel_aspect.has_value());
}

}  // namespace
}  // namespace render2mpeg::test
