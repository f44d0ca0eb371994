#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>

#include "image/image.h"
#include "pipeline/fixture.h"

/// The encoder stage by itself, as a user starts it.
namespace render2mpeg::test {
namespace {

std::string inside(const Folder& folder, const std::string& name) {
    return (folder / name).string();
}

int frames_by_ffmpeg(const std::filesystem::path& file) {
    const auto strict = run("ffmpeg -v error -xerror -err_detect explode -i " + file.string() + " -f null -");
    if (strict.status != 0 || !strict.output.empty()) return -1;
    return std::atoi(run("ffprobe -v error -count_frames -select_streams v -show_entries stream=nb_read_frames -of "
                         "default=nw=1:nk=1 " +
                         file.string())
                         .output.c_str());
}

nlohmann::json statistics(const Folder& folder, const std::string& arguments) {
    const auto outcome = run(program() + " encode -y " + arguments + " --quiet --stats " + inside(folder, "s.json"));
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    EXPECT_EQ(outcome.output, "");
    return outcome.status == 0 ? nlohmann::json::parse(contents(folder / "s.json")) : nlohmann::json::object();
}

TEST(Encode, FramesAndLayersOfARenderGiveNearlyTheFilmOfTheRenderItselfSlow) {
    const Folder folder;
    const std::string render = program() + " render -y --hold " + support::plain_film() +
                               " --size 96x80 --samples 1 --exposure 0.5 --tolerance "
                               "fixed=10% --quiet --frames 4:9 -o ";
    ASSERT_EQ(run(render + inside(folder, "direct.m2v") + " --aov " + inside(folder, "aov") + " --stats " +
                  inside(folder, "direct.json"))
                  .status,
              0);
    ASSERT_EQ(run(render + inside(folder, "p.%04d.png")).status, 0);
    const auto direct = nlohmann::json::parse(contents(folder / "direct.json"));
    const double bytes = direct.at("bytes"), psnr = direct.at("psnr_y");

    const std::string layers = inside(folder, "aov/frame_%04d.exr"), motion = " --motion " + layers;
    const std::string output = " -o " + inside(folder, "film.m2v");
    // Scene-linear frames in halves develop into nearly the same pictures, display-referred ones in 8 bits less nearly.
    const auto exr = statistics(folder, layers + output + motion + " --exposure 0.5");
    EXPECT_EQ(exr.at("frames"), 6);
    EXPECT_EQ(exr.at("per_frame")[0].at("frame"), 4) << "images keep their numbers";
    EXPECT_NEAR(exr.at("bytes").get<double>() / bytes, 1.0, 0.02);
    EXPECT_NEAR(exr.at("psnr_y").get<double>(), psnr, 0.15);
    const auto png = statistics(folder, inside(folder, "p.%04d.png") + output + motion);
    EXPECT_NEAR(png.at("bytes").get<double>() / bytes, 1.0, 0.03);
    // chosen: what rounding to 8-bit RGB adds cannot be predicted; it cost 0.15 dB here, and 1 dB is a picture that is
    // off.
    EXPECT_NEAR(png.at("psnr_y").get<double>(), psnr, 0.3);
    EXPECT_EQ(png.at("motion"), true);
    EXPECT_EQ(frames_by_ffmpeg(folder / "film.m2v"), 6);
}

/// Noise that moves 7 pixels to the right and 3 up with each frame, as a Y4M file and Blender's layers beside it;
/// `sign` -1: layers that point the wrong way.
void write_pan(const Folder& folder, int frames, float sign) {
    constexpr int width = 112, height = 80;
    std::ofstream stream(folder / "pan.y4m", std::ios::binary);
    stream << "YUV4MPEG2 W112 H80 F24:1 Ip A1:1 C420mpeg2\n";
    for (int n = 0; n < frames; ++n) {
        stream << "FRAME\n";
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                const auto column = static_cast<unsigned>(x - 7 * n + 4096), row = static_cast<unsigned>(y + 3 * n);
                const unsigned mixed = ((column * 0x9e3779b1u) ^ (row * 0x85ebca6bu)) * 0xc2b2ae35u;
                stream.put(static_cast<char>(60 + (mixed >> 25)));
            }
        for (int i = 0; i < width * height / 2; ++i) stream.put(static_cast<char>(128));
        std::vector<image::Channel> channels;
        for (const auto& [name, value] :
             {std::pair{"V.Vector.X", -7.0f}, {"V.Vector.Y", -3.0f}, {"V.Vector.Z", -7.0f}, {"V.Vector.W", -3.0f}})
            channels.push_back({name, std::vector<float>(width * height, sign * value), false});
        image::write_exr(folder / ("v." + std::to_string(n) + ".exr"), width, height, channels);
    }
}

TEST(Encode, MotionOfAPanOfNoiseIsWorthItOnlyTheRightWayRound) {
    std::vector<double> bytes;
    for (const float sign : {1.0f, -1.0f}) {
        const Folder folder;
        write_pan(folder, 6, sign);
        const std::string start = inside(folder, "pan.y4m") + " -o " + inside(folder, "pan.m2v");
        const auto with = statistics(folder, start + " --motion " + inside(folder, "v.%d.exr"));
        EXPECT_DOUBLE_EQ(with.at("fps").get<double>(), 24.0) << "the file's own";
        bytes.push_back(with.at("bytes"));
        if (sign > 0) {
            const auto without = statistics(folder, start);
            EXPECT_EQ(without.at("motion"), false);
            const auto frame = with.at("per_frame")[1];
            EXPECT_LT(frame.at("vectors_chosen_searched"), frame.at("vectors_chosen_exact"));
            EXPECT_GT(without.at("per_frame")[1].at("searches"), 1000);
            bytes.push_back(without.at("bytes"));
        }
    }
    EXPECT_LT(bytes[0], 0.9 * bytes[1])
        << "with motion, against none: a search in steps of four pixels finds little in noise";
    EXPECT_GT(bytes[2], 0.9 * bytes[1]) << "motion turned round, against none";
}

TEST(Encode, SaysThatItSearchesWithoutMotion) {
    const Folder folder;
    write_pan(folder, 2, 1);
    const auto outcome =
        run(program() + " encode -y " + inside(folder, "pan.y4m") + " -o " + inside(folder, "pan.mpg"));
    EXPECT_EQ(outcome.status, 0) << outcome.output;
    EXPECT_NE(outcome.output.find("vectors are searched for"), std::string::npos) << outcome.output;
    EXPECT_NE(outcome.output.find("PSNR-Y"), std::string::npos) << outcome.output;
    EXPECT_EQ(frames_by_ffmpeg(folder / "pan.mpg"), 2);
    EXPECT_FALSE(std::filesystem::exists(folder / "pan.mpg.partial"));
    const auto with = run(program() + " encode -y " + inside(folder, "pan.y4m") + " -o " + inside(folder, "pan.mpg") +
                          " --motion " + inside(folder, "v.%d.exr"));
    EXPECT_EQ(with.output.find("searched for"), std::string::npos) << with.output;
}

TEST(Encode, BytesDependNeitherOnThreadsNorOnWhichFramesAreLeftOut) {
    const Folder folder;
    write_pan(folder, 7, 1);
    const std::string start = program() + " encode -y " + inside(folder, "pan.y4m") + " --gop 3 --quiet --motion " +
                              inside(folder, "v.%d.exr") + " -o ";
    ASSERT_EQ(run(start + inside(folder, "one.m2v") + " --threads 1").status, 0);
    ASSERT_EQ(run(start + inside(folder, "three.m2v") + " --threads 3").status, 0);
    EXPECT_EQ(contents(folder / "one.m2v"), contents(folder / "three.m2v"));
    ASSERT_EQ(run(start + inside(folder, "part.m2v") + " --frames 2:5").status, 0);
    EXPECT_EQ(frames_by_ffmpeg(folder / "part.m2v"), 4);
}

TEST(Encode, PixelShapesReachTheFilmSlow) {
    const Folder folder;
    for (const auto& [shape, ratio] : {std::pair{"1/1", "1:1"}, {"16/15", "16:15"}, {"64/45", "64:45"}}) {
        ASSERT_EQ(run("ffmpeg -v error -y -f lavfi -i testsrc2=size=720x576:rate=25:duration=0.08 -pix_fmt yuv420p "
                      "-vf setsar=" +
                      std::string(shape) + " " + inside(folder, "in.y4m"))
                      .status,
                  0);
        ASSERT_EQ(run(program() + " encode -y " + inside(folder, "in.y4m") + " --quiet -o " + inside(folder, "out.m2v"))
                      .status,
                  0);
        EXPECT_EQ(run("ffprobe -v error -show_entries stream=sample_aspect_ratio -of default=nw=1:nk=1 " +
                      inside(folder, "out.m2v"))
                      .output,
                  std::string(ratio) + "\n");
    }
}

TEST(Encode, RefusesInOneLineAndLeavesNothing) {
    const Folder folder;
    write_pan(folder, 2, 1);
    std::filesystem::copy_file(folder / "v.0.exr", folder / "v.5.exr");
    std::ofstream(folder / "x.avi").close();
    std::ofstream(folder / "broken.0.exr") << "not an image";
    std::ofstream(folder / "c411.y4m") << "YUV4MPEG2 W8 H8 F25:1 C411\nFRAME\n" << std::string(128, 'x');
    std::ofstream(folder / "rate.y4m") << "YUV4MPEG2 W8 H8 F31:1 C420mpeg2\nFRAME\n" << std::string(96, 'x');
    std::ofstream(folder / "shape.y4m") << "YUV4MPEG2 W8 H8 A3:1 F25:1 C420mpeg2\nFRAME\n" << std::string(96, 'x');
    const std::size_t entries = folder.entries();
    const auto refused = [&](const std::string& input, const std::string& options, const std::string& words) {
        const auto outcome = run(program() + " encode -y " + inside(folder, input) + " -o " +
                                 inside(folder, "film.mpg") + " " + options + " --quiet");
        EXPECT_TRUE(outcome.status == 1 || outcome.status == 2) << outcome.output;
        EXPECT_EQ(std::count(outcome.output.begin(), outcome.output.end(), '\n'), 1) << outcome.output;
        EXPECT_NE(outcome.output.find(words), std::string::npos) << outcome.output;
    };
    refused("absent.y4m", "", "absent.y4m");
    refused("x.avi", "", "ffmpeg -i ");
    refused("v.0.exr", "", "%04d");
    refused("absent.%d.exr", "", "no file has such a name");
    refused("broken.%d.exr", "", "broken.0.exr");
    refused("v.%d.exr", "", "frame 2 is missing");
    refused("v.%d.exr", "--frames 3:5", "v.3.exr");
    refused("c411.y4m", "", "C411");
    refused("rate.y4m", "", "23.976, 24, 25, 29.97, 30, 50, 59.94, 60");
    refused("shape.y4m", "", "3:1");
    refused("pan.y4m", "--frames 0:2", "frames 0 to 1");
    refused("pan.y4m", "--exposure 1", "exposure");
    refused("pan.y4m", "--motion " + inside(folder, "v.0.exr"), "%04d");
    refused("pan.y4m", "--motion " + inside(folder, "w.%d.exr"), "w.1.exr");
    refused("pan.y4m", "--motion-convention nuke --motion " + inside(folder, "v.%d.exr"), "v.1.exr: it has no motion");
    EXPECT_EQ(folder.entries(), entries);
    const auto kind = run(program() + " encode -y " + inside(folder, "pan.y4m") + " -o " + inside(folder, "x.y4m"));
    EXPECT_EQ(kind.status, 1);
    EXPECT_NE(kind.output.find(".mpg"), std::string::npos) << kind.output;
    EXPECT_EQ(run(program() + " encode -y " + inside(folder, "pan.y4m") + " -o " + inside(folder, "x.mpg") +
                  " --motion-convention maya")
                  .status,
              2);
}

TEST(Encode, HelpShowsEveryOptionWithItsDefault) {
    const auto help = run(program() + " encode --help");
    EXPECT_EQ(help.status, 0);
    for (const char* words :
         {"FRAMES", "--output", "--motion", "--motion-convention", "=blender", "--fps", "--frames", "--exposure",
          "--quantiser", "=4", "--gop", "=60", "--threads", "--stats", "--quiet", ".mpg", "%04d", ".y4m"})
        EXPECT_NE(help.output.find(words), std::string::npos) << words;
}

/// Pictures of a film as ffmpeg decodes them to this pixel format.
std::string decoded(const std::string& film, const std::string& pixels) {
    const auto shown = run("ffmpeg -v error -xerror -i " + film + " -f rawvideo -pix_fmt " + pixels + " -");
    EXPECT_EQ(shown.status, 0);
    return shown.output;
}

TEST(Encode, AMasterHasAllThatY4mHasSlow) {
    const Folder folder;
    for (const std::string pixels : {"yuv444p12le", "yuv422p10le", "yuv420p10le"}) {
        SCOPED_TRACE(pixels);
        const std::string source = inside(folder, pixels + ".y4m");
        ASSERT_EQ(run("ffmpeg -v error -f lavfi -i testsrc2=s=64x48:r=12:d=0.25 -vf format=" + pixels + " -strict -1 " +
                      source)
                      .status,
                  0);
        ASSERT_EQ(
            run(program() + " encode " + source + " --codec ffv1 --quiet -o " + inside(folder, pixels + ".mkv")).status,
            0);
        const std::string film = inside(folder, pixels + ".mkv");
        EXPECT_EQ(ffprobe(film).value("r_frame_rate", ""), "12/1");
        if (pixels == "yuv444p12le") {
            EXPECT_TRUE(decoded(film, pixels) == decoded(source, pixels)) << "bit by bit";
            continue;
        }
        // Luma has all its bits; chroma that the master has more of is interpolated.
        EXPECT_TRUE(decoded(film, "gray10le") == decoded(source, "gray10le"));
    }
}

TEST(Encode, FilmsHaveAnyRateAndShapeWhereTheirCodecsDoSlow) {
    const Folder folder;
    ASSERT_EQ(
        run("ffmpeg -v error -f lavfi -i testsrc2=s=96x64:r=15:d=1 -vf setsar=2/1 " + inside(folder, "s.y4m")).status,
        0);
    const std::pair<const char*, const char*> films[] = {{"h.mp4", ""},
                                                         {"h.mkv", ""},
                                                         {"h.ts", " --codec h264"},
                                                         {"e.mp4", " --codec hevc"},
                                                         {"a.mp4", " --codec av1"},
                                                         {"p.mov", " --codec prores"},
                                                         {"f.mkv", " --codec ffv1"}};
    for (const auto& [name, codec] : films)
        for (const auto& [rate, told] : {std::pair{"", "15/1"},
                                         {" --fps 12.5", "25/2"},
                                         {" --fps 48", "48/1"},
                                         {" --fps 120000/1001", "120000/1001"}}) {
            SCOPED_TRACE(std::string(name) + rate);
            const auto made = run(program() + " encode -y " + inside(folder, "s.y4m") + codec + rate +
                                  " --encoder fast --quiet -o " + inside(folder, name));
            if (made.output.find("FFmpeg with") != std::string::npos) continue;  // this machine's FFmpeg lacks it
            ASSERT_EQ(made.status, 0) << made.output;
            const json stream = ffprobe(inside(folder, name));
            EXPECT_EQ(stream.value("sample_aspect_ratio", ""), "2:1");
            // Matroska counts nanoseconds; of a transport stream's clock ffprobe guesses 120.
            double num = 0, den = 1, wanted_num = 0, wanted_den = 1;
            std::sscanf(stream.value("r_frame_rate", "").c_str(), "%lf/%lf", &num, &den);
            std::sscanf(told, "%lf/%lf", &wanted_num, &wanted_den);
            EXPECT_NEAR(num / den, wanted_num / wanted_den, std::string(name) == "h.ts" ? 0.12 : 1e-3);
            EXPECT_EQ(frames_by_ffmpeg(folder / name), 15);
        }
    const auto refused = run(program() + " encode " + inside(folder, "s.y4m") + " -o " + inside(folder, "s.mpg"));
    EXPECT_EQ(refused.status, 2);
    EXPECT_NE(refused.output.find("MPEG-2 has"), std::string::npos) << refused.output;
}

TEST(Encode, OddFramesAreShownWithTheirLastColumnAndRowTwice) {
    const Folder folder;
    const std::string y4m = inside(folder, "odd.y4m");
    ASSERT_EQ(run("ffmpeg -v error -f lavfi -i testsrc2=s=64x48:r=25 -vf format=yuv444p,crop=63:47:0:0:exact=1 "
                  "-frames:v 3 -strict -1 " +
                  y4m)
                  .status,
              0);
    const auto made = run(program() + " encode " + y4m + " -o " + inside(folder, "film.mp4") + " -q 1");
    ASSERT_EQ(made.status, 0) << made.output;
    EXPECT_NE(made.output.find("63x47"), std::string::npos) << made.output;
    EXPECT_NE(made.output.find("64x48"), std::string::npos) << made.output;
    const auto raw = [&](const std::string& file, const std::string& filter) {
        return run("ffmpeg -v error -i " + file + " -vf " + filter + ",format=gray -f rawvideo -").output;
    };
    const auto difference = [](const std::string& one, const std::string& other) {
        EXPECT_EQ(one.size(), other.size());
        double sum = 0;
        for (std::size_t i = 0; i < one.size(); ++i)
            sum += std::abs(static_cast<std::uint8_t>(one[i]) - static_cast<std::uint8_t>(other[i]));
        return sum / static_cast<double>(one.size());
    };
    const std::string film = inside(folder, "film.mp4");
    EXPECT_LT(difference(raw(film, "extractplanes=y,crop=63:47:0:0:exact=1"), raw(y4m, "extractplanes=y")), 1);
    EXPECT_LT(difference(raw(film, "extractplanes=y,crop=1:48:63:0"), raw(film, "extractplanes=y,crop=1:48:62:0")), 2);
    EXPECT_LT(difference(raw(film, "extractplanes=y,crop=64:1:0:47"), raw(film, "extractplanes=y,crop=64:1:0:46")), 2);
    // MPEG-2 and codecs of 4:4:4 have odd sides.
    for (const char* odd :
         {"film.mpg", "f.mkv --codec ffv1", "film.gif", "l.mp4 --codec h264_lossless", "film.mov --codec prores4444"}) {
        ASSERT_EQ(run(program() + " encode --quiet " + y4m + " -o " + inside(folder, odd)).status, 0) << odd;
        const std::string file = inside(folder, std::string(odd).substr(0, std::string(odd).find(' ')));
        EXPECT_EQ(ffprobe(file).value("width", 0), 63) << odd;
        EXPECT_EQ(ffprobe(file).value("height", 0), 47) << odd;
    }
    EXPECT_EQ(raw(inside(folder, "f.mkv"), "extractplanes=y"), raw(y4m, "extractplanes=y")) << "without loss";
    const auto planned = run(program() + " plan --within 0 --size 63x47 -o film.mp4 " + support::plain_film());
    EXPECT_NE(planned.output.find("63x47: films in H.264 are made with even sides, 64x48"), std::string::npos)
        << planned.output;
}

TEST(Encode, ChromaOfTenBitsIsNotRoundedToEight) {
    const Folder folder;
    constexpr int side = 96;
    std::ofstream stream(folder / "grey.y4m", std::ios::binary);
    stream << "YUV4MPEG2 W" << side << " H" << side << " F25:1 C420p16\nFRAME\n";
    const auto put = [&](int count, double value) {
        const int code = static_cast<int>(256 * value);
        for (int i = 0; i < count; ++i) stream.put(static_cast<char>(code & 255)).put(static_cast<char>(code >> 8));
    };
    put(side * side, 120);
    put(side * side / 4, 100.5);
    put(side * side / 4, 140.25);
    stream.close();
    for (const std::string codec : {"hevc", "av1"}) {
        if (run("ffmpeg -v error -h encoder=" + std::string(codec == "av1" ? "libsvtav1" : "libx265"))
                .output.find("preset") == std::string::npos)
            continue;
        const std::string film = inside(folder, codec + ".mp4");
        ASSERT_EQ(
            run(program() + " encode --quiet " + inside(folder, "grey.y4m") + " -o " + film + " -q 1 --codec " + codec)
                .status,
            0);
        const std::string samples = run("ffmpeg -v error -i " + film + " -pix_fmt yuv420p10le -f rawvideo -").output;
        ASSERT_EQ(samples.size(), 3u * side * side);
        const auto mean = [&](std::size_t first) {
            double sum = 0;
            for (std::size_t i = first; i < first + side * side / 2; i += 2)
                sum += static_cast<std::uint8_t>(samples[i]) + 256 * static_cast<std::uint8_t>(samples[i + 1]);
            return sum / (side * side / 4);
        };
        EXPECT_NEAR(mean(2 * side * side), 4 * 100.5, 0.5) << codec;
        EXPECT_NEAR(mean(2 * side * side + side * side / 2), 4 * 140.25, 0.5) << codec;
    }
}

TEST(Encode, InfiniteLightIsWhite) {
    const Folder folder;
    constexpr int side = 64;
    const float infinite = std::numeric_limits<float>::infinity();
    std::vector<image::Channel> channels;
    for (const auto& [name, value] : {std::pair{"R", infinite}, {"G", -infinite}, {"B", std::nanf("")}}) {
        channels.push_back({name, std::vector<float>(side * side, 0.18f), false});
        std::fill_n(channels.back().values.begin(), side * side / 2, value);
    }
    image::write_exr(folder / "f.0.exr", side, side, channels);
    const auto told = statistics(folder, inside(folder, "f.%d.exr") + " --codec ffv1 -o " + inside(folder, "f.mkv"));
    EXPECT_EQ(told.at("counts").at("non_finite"), 3 * side * side / 2);
    const std::string codes = codes_of(inside(folder, "f.mkv"));
    ASSERT_EQ(codes.size(), std::size_t{3 * side * side});
    const auto code = [&](std::size_t pixel, std::size_t channel) {
        return static_cast<unsigned char>(codes[3 * pixel + channel]);
    };
    EXPECT_GE(code(0, 0), 254);
    EXPECT_LE(code(0, 1), 1);
    EXPECT_LE(code(0, 2), 1);
    EXPECT_NEAR(code(side * side - 1, 0), 118, 1);
}

TEST(Encode, TakesFramesOfTiffAndJpegSlow) {
    const Folder folder;
    const std::string source = "ffmpeg -v error -f lavfi -i testsrc2=s=64x48:r=25:d=0.12 ";
    ASSERT_EQ(run(source + "-pix_fmt rgb48le " + inside(folder, "t.%02d.tif")).status, 0);
    ASSERT_EQ(run(source + "-pix_fmt rgb48be " + inside(folder, "p.%02d.png")).status, 0);
    ASSERT_EQ(run(source + "-q:v 1 -pix_fmt yuvj444p " + inside(folder, "j.%02d.jpg")).status, 0);
    for (const std::string frames : {"t.%02d.tif", "p.%02d.png", "j.%02d.jpg"})
        ASSERT_EQ(run(program() + " encode " + inside(folder, frames) + " --codec ffv1 --quiet -o " +
                      inside(folder, frames.substr(0, 1) + ".mkv"))
                      .status,
                  0)
            << frames;
    const std::string png = decoded(inside(folder, "p.mkv"), "yuv444p12le");
    EXPECT_TRUE(decoded(inside(folder, "t.mkv"), "yuv444p12le") == png);
    const std::string jpeg = codes_of(inside(folder, "j.mkv")), still = codes_of(inside(folder, "j.01.jpg"));
    ASSERT_EQ(jpeg.size(), still.size());
    double off = 0;
    for (std::size_t i = 0; i < jpeg.size(); ++i)
        off += std::abs(static_cast<unsigned char>(jpeg[i]) - static_cast<unsigned char>(still[i]));
    EXPECT_LT(off / static_cast<double>(jpeg.size()), 3);
}

TEST(Encode, SaysThatFramesArePanoramasAndOfTwoEyesAndSparesTheirPoles) {
    const Folder folder;
    write_frames(inside(folder, "frames.y4m"), 64, 128, "25:1", "1:1", 3);
    const std::string encode = program() + " encode -y --quiet --codec h264 --quantiser 8 " +
                               inside(folder, "frames.y4m") + " -o " + inside(folder, "film.mp4");
    const auto told = [&](const std::string& options) {
        const auto made = run(encode + options);
        EXPECT_EQ(made.status, 0) << made.output;
        return json::parse(run(program() + " info --json --summary " + inside(folder, "film.mp4")).output);
    };
    const json flat = told(""), around = told(" --projection equirectangular --stereo top-bottom");
    EXPECT_TRUE(flat.at("panorama").is_null() && flat.at("stereo").is_null());
    EXPECT_EQ(around.at("panorama"), (json{0.0, 0.0, 0.0, 0.0}));
    EXPECT_EQ(around.at("stereo"), "top-bottom");
    EXPECT_LT(around.at("bytes").get<double>(), 0.97 * flat.at("bytes").get<double>()) << "poles are coded coarser";
    const json half = told(" --projection vr180 --stereo side-by-side");
    EXPECT_EQ(half.at("panorama"), (json{0.25, 0.0, 0.25, 0.0}));
    EXPECT_EQ(half.at("stereo"), "side-by-side");

    const auto silent = run(program() + " encode -y " + inside(folder, "frames.y4m") + " -o " +
                            inside(folder, "film.mpg") + " --projection equirectangular");
    EXPECT_EQ(silent.status, 0) << silent.output;
    EXPECT_NE(silent.output.find("such files cannot say what frames show"), std::string::npos) << silent.output;

    write_frames(inside(folder, "frames.y4m"), 62, 48, "25:1", "1:1", 1);
    for (const auto& [options, words] : {std::pair{" --stereo side-by-side", "take an even width"},
                                         {" --stereo left-right", "side-by-side"},
                                         {" --projection fisheye", "vr180"}}) {
        const auto refused = run(encode + options);
        EXPECT_EQ(refused.status, 2) << refused.output;
        EXPECT_NE(refused.output.find(words), std::string::npos) << refused.output;
        EXPECT_EQ(std::count(refused.output.begin(), refused.output.end(), '\n'), 1) << refused.output;
    }
}

}  // namespace
}  // namespace render2mpeg::test
