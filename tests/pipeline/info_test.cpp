#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "pipeline/fixture.h"

/// `render2mpeg info`: what is told of a film is what others say of it, and what we know of our own.
namespace render2mpeg::test {
namespace {

json info(const std::string& file, int status = 0) {
    const auto outcome = run(program() + " info --json " + file + " 2>/dev/null");
    EXPECT_EQ(outcome.status, status) << outcome.output;
    return json::parse(outcome.output);
}

/// "I 2456" for every picture in display order, as ffprobe says.
std::vector<std::string> by_ffprobe(const std::string& file) {
    const auto outcome =
        run("ffprobe -v error -select_streams v -show_entries frame=pict_type,pkt_size -of json " + file);
    std::vector<std::string> rows;
    const json said = json::parse(outcome.output);
    for (const json& frame : said.at("frames"))
        rows.push_back(frame.at("pict_type").get<std::string>() + " " + frame.at("pkt_size").get<std::string>());
    return rows;
}

std::vector<std::string> by_us(const json& info) {
    std::vector<std::string> rows;
    for (const json& picture : info.at("per_picture"))
        rows.push_back(picture.at("type").get<std::string>() + " " + std::to_string(picture.at("bytes").get<int>()));
    return rows;
}

void make_film(const Folder& folder, const std::string& name, const std::string& options) {
    const auto outcome =
        run(program() + " render -y --hold " + plain_film() +
            " --size 64x48 --samples 1 --vpls 0 --tolerance fixed=20% --exposure 0 --frames 0:10 --quiet -o " +
            path(folder, name) + " --stats " + path(folder, "s.json") + options);
    ASSERT_EQ(outcome.status, 0) << outcome.output;
}

/// A film of ffmpeg's own encoder.
void make_foreign(const std::string& file, const std::string& options) {
    const auto outcome = run("ffmpeg -v error -f lavfi -i testsrc2=size=176x144:rate=25 -frames:v 20 -c:v mpeg2video " +
                             options + " -y " + file);
    ASSERT_EQ(outcome.status, 0) << outcome.output;
}

TEST(Info, TellsTitlesOfTransportStreamsAndTimecodesOfGroups) {
    const Folder folder;
    const auto source = run("ffmpeg -v error -f lavfi -i testsrc2=size=176x144:rate=25 -frames:v 20 -pix_fmt yuv420p " +
                            path(folder, "s.y4m"));
    ASSERT_EQ(source.status, 0) << source.output;
    const auto made = [&](const std::string& name, const std::string& options) {
        const auto outcome =
            run(program() + " encode --quiet " + path(folder, "s.y4m") + " -o " + path(folder, name) + options);
        EXPECT_EQ(outcome.status, 0) << outcome.output;
        return info(path(folder, name));
    };
    EXPECT_EQ(made("a.ts", " --title Dawn").at("title"), "Dawn");
    EXPECT_EQ(made("b.mpg", " --timecode 01:02:03:04").at("timecode"), "01:02:03:04");
    const json plain = made("c.ts", "");
    EXPECT_TRUE(plain.at("title").is_null() && plain.at("timecode").is_null()) << plain;
}

class EveryContainer : public testing::TestWithParam<const char*> {};

TEST_P(EveryContainer, TellsTypesAndSizesAsFfprobeDoesSlow) {
    const Folder folder;
    make_film(folder, GetParam(), " --gop 6");
    const json told = info(path(folder, GetParam()));
    EXPECT_EQ(by_us(told), by_ffprobe(path(folder, GetParam())));
    EXPECT_EQ(told.at("pictures"), 11);
    EXPECT_EQ(told.at("damaged"), 0);
    EXPECT_EQ(told.at("not_shown"), 0);
    EXPECT_EQ(told.at("groups").at("count"), 2);
    const bool mpeg2 = told.at("codec") == "mpeg2";
    // The second group is open: its I picture comes after a B picture that refers to the first.
    EXPECT_EQ(told.at("groups").at("longest"), mpeg2 ? 7 : 6);
    EXPECT_EQ(told.at("profile"), mpeg2 ? "Main" : "High");
    EXPECT_EQ(told.at("level"), mpeg2 ? "Main" : "1.0");
    EXPECT_EQ(told.at("fps"), 25);
}

INSTANTIATE_TEST_SUITE_P(Containers, EveryContainer, testing::Values("f.mpg", "f.ts", "f.m2v", "f.mkv", "f.mp4"));

TEST(Information, OfOurFilmsIsWhatTheEncoderCounted) {
    const Folder folder;
    make_film(folder, "f.m2v", " --quality 60 --gop 6");
    const json told = info(path(folder, "f.m2v")).at("per_picture");
    const json known = json::parse(contents(folder / "s.json")).at("per_frame");
    ASSERT_EQ(told.size(), known.size());
    double moving = 0;
    for (std::size_t i = 0; i < told.size(); ++i) {
        EXPECT_EQ(told[i].at("type"), known[i].at("type"));
        EXPECT_NEAR(told[i].at("quantiser").at("mean").get<double>(), known[i].at("mean_quantiser").get<double>(), 1e-6)
            << i;
        if (known[i].at("type") == "I")
            EXPECT_EQ(told[i].at("intra"), 1.0);
        else
            EXPECT_LT(told[i].at("intra").get<double>(), 1.0);
        if (known[i].at("type") != "B") {
            EXPECT_EQ(told[i].at("backward").at("share"), 0.0);
        }
        moving += told[i].at("forward").at("moving").get<double>();
        EXPECT_LE(told[i].at("forward").at("mean").get<double>(),
                  told[i].at("forward").at("longest").get<double>() + 1e-9);
    }
    EXPECT_GT(moving, 0.2) << "boxes move";
}

TEST(Information, OfForeignFilmsAgreesWithFfprobeSlow) {
    const Folder folder;
    const std::string file = path(folder, "f.mpg");
    for (const char* options : {"-g 12 -bf 2 -q:v 5", "-g 9 -bf 2 -q:v 3 -flags +ilme+ildct -top 1", "-g 1 -q:v 20",
                                "-g 10 -bf 1 -b:v 300k -qmax 28 -non_linear_quant 1"}) {
        make_foreign(file, options);
        const json told = info(file);
        EXPECT_EQ(by_us(told), by_ffprobe(file)) << options;
        EXPECT_EQ(told.at("pictures"), 20) << options;
    }
    // A fixed quantiser is told as it is; of B pictures it is 1.25 times as coarse and a little.
    make_foreign(file, "-g 12 -bf 0 -qmin 7 -qmax 7 -q:v 7");
    const json fixed = info(file);
    for (const json& picture : fixed.at("per_picture")) EXPECT_EQ(picture.at("quantiser").at("mean"), 7.0);
}

TEST(Information, IsATableWithoutJson) {
    const Folder folder;
    make_foreign(path(folder, "f.mpg"), "-g 12 -bf 2 -q:v 5");
    const auto full = run(program() + " info " + path(folder, "f.mpg"));
    EXPECT_EQ(full.status, 0);
    EXPECT_NE(full.output.find("MPEG-2 Main@Main, 176x144 at 25 Hz, 20 pictures, 0.80 s"), std::string::npos)
        << full.output;
    std::istringstream lines(full.output.substr(full.output.find('\n') + 1));
    for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 80u) << line;
    const auto brief = run(program() + " info --summary " + path(folder, "f.mpg"));
    EXPECT_EQ(full.output.size() > brief.output.size() + 20 * 60, true);
    EXPECT_EQ(std::count(full.output.begin(), full.output.end(), '\n') -
                  std::count(brief.output.begin(), brief.output.end(), '\n'),
              20 + 3)
        << "one line per picture under its heading";
}

TEST(Information, TellsDamageAndGoesOn) {
    const Folder folder;
    make_foreign(path(folder, "f.m2v"), "-g 12 -bf 2 -q:v 5");
    std::string bytes = contents(folder / "f.m2v");
    for (std::size_t i = bytes.size() / 2; i < bytes.size() / 2 + 400; i += 3) bytes[i] = static_cast<char>(~bytes[i]);
    std::ofstream(folder / "broken.m2v", std::ios::binary) << bytes;
    const json told = info(path(folder, "broken.m2v"), 1);
    EXPECT_GE(told.at("pictures").get<int>(), 15);
    EXPECT_GE(told.at("damaged").get<int>() + told.at("not_shown").get<int>(), 1);
    const auto line = run(program() + " info --summary " + path(folder, "broken.m2v") + " 2>&1 >/dev/null");
    EXPECT_TRUE(line.output.starts_with("render2mpeg: ")) << line.output;
    EXPECT_EQ(std::count(line.output.begin(), line.output.end(), '\n'), 1) << line.output;
}

TEST(Information, NeverCrashesWhereAFilmEndsEarlyOrIsNoneSlow) {
    const Folder folder;
    make_foreign(path(folder, "f.mpg"), "-g 5 -bf 2 -q:v 5");
    const std::string bytes = contents(folder / "f.mpg");
    for (const std::size_t length :
         {std::size_t{0}, std::size_t{40}, std::size_t{3000}, bytes.size() / 2, bytes.size() - 1}) {
        std::ofstream(folder / "cut.mpg", std::ios::binary) << bytes.substr(0, length);
        const auto outcome = run(program() + " info --summary " + path(folder, "cut.mpg"));
        EXPECT_LE(outcome.status, 1) << length << " " << outcome.output;
        if (length <= 40) {
            EXPECT_EQ(outcome.status, 1) << outcome.output;
        }
    }
    const auto refused = [&](const std::string& file, const char* words) {
        const auto outcome = run(program() + " info " + file);
        EXPECT_EQ(outcome.status, 1);
        EXPECT_NE(outcome.output.find(words), std::string::npos) << outcome.output;
        EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1) << outcome.output;
    };
    refused(path(folder, "absent.mpg"), "absent.mpg: there is no such file");
    ASSERT_EQ(
        run("ffmpeg -v error -f lavfi -i testsrc2=size=64x48 -frames:v 3 -c:v mpeg4 " + path(folder, "f.avi")).status,
        0);
    refused(path(folder, "f.avi"), "its video is mpeg4, not mpeg2video");
    std::ofstream(folder / "list.m3u8") << "#EXTM3U\n#EXTINF:1,\nhttp://127.0.0.1:9/a.ts\n#EXT-X-ENDLIST\n";
    refused(path(folder, "list.m3u8"), "list.m3u8");
}

}  // namespace
}  // namespace render2mpeg::test
