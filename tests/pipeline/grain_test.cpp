#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "core/film_grain.h"
#include "pipeline/fixture.h"

/// Films with grain, through the program and foreign decoders.
namespace render2mpeg::test {
namespace {

constexpr int film_width = 192, film_height = 480, film_frames = 4, film_iso = 6400;
constexpr std::array<int, 3> greys{60, 120, 190};  ///< of columns side by side

std::string grey_film(const Folder& folder) {
    std::ofstream stream(folder / "grey.y4m", std::ios::binary);
    stream << "YUV4MPEG2 W" << film_width << " H" << film_height << " F25:1 Ip A1:1 C420mpeg2\n";
    std::string row;
    for (const int grey : greys) row += std::string(film_width / greys.size(), static_cast<char>(grey));
    for (int n = 0; n < film_frames; ++n) {
        stream << "FRAME\n";
        for (int y = 0; y < film_height; ++y) stream << row;
        stream << std::string(film_width * film_height / 2, '\x80');
    }
    return path(folder, "grey.y4m");
}

std::string encoded_greys(const Folder& folder, const std::string& film, const std::string& options,
                          const std::string& name) {
    const auto result = run(program() + " encode " + film + " -y --quiet " + options + " -o " + path(folder, name));
    EXPECT_EQ(result.status, 0) << result.output;
    return path(folder, name);
}

/// Luma in code values of 8 bits, frame by frame, as ffmpeg decodes it.
std::vector<double> decoded_luma(const std::string& file, const std::string& how = "") {
    const auto decoded = run("ffmpeg -v error " + how + " -i " + file + " -f rawvideo -pix_fmt yuv420p10le -");
    EXPECT_EQ(decoded.status, 0);
    constexpr std::size_t of_luma = std::size_t{2} * film_width * film_height, of_frame = of_luma / 2 * 3;
    EXPECT_EQ(decoded.output.size(), of_frame * film_frames);
    std::vector<double> luma;
    for (std::size_t i = 0; i + 1 < decoded.output.size(); i += 2) {
        if (i % of_frame >= of_luma) continue;
        const int code = static_cast<std::uint8_t>(decoded.output[i]) | static_cast<std::uint8_t>(decoded.output[i + 1])
                                                                            << 8;
        luma.push_back(code / 4.0);
    }
    return luma;
}

/// Mean product of a column's deviations from their mean with those at another place.
double covariance(const std::vector<double>& luma, int column, int across, int later) {
    constexpr int part = film_width / static_cast<int>(greys.size()), edge = 4;
    const auto at = [&](int n, int y, int x) {
        return luma[static_cast<std::size_t>((n * film_height + y) * film_width + column * part + x)];
    };
    double sum = 0, products = 0, count = 0;
    for (int n = 0; n + later < film_frames; ++n)
        for (int y = 0; y < film_height; ++y)
            for (int x = edge; x + across < part - edge; ++x, ++count) sum += at(n, y, x);
    for (int n = 0; n + later < film_frames; ++n)
        for (int y = 0; y < film_height; ++y)
            for (int x = edge; x + across < part - edge; ++x)
                products += (at(n, y, x) - sum / count) * (at(n + later, y, x + across) - sum / count);
    return products / count;
}

void expect_grain(const std::vector<double>& luma, const std::string& name) {
    const core::FilmGrain grain(film_iso, film_height);
    ASSERT_EQ(luma.size(), std::size_t{film_width} * film_height * film_frames);
    for (std::size_t i = 0; i < greys.size(); ++i) {
        const int column = static_cast<int>(i);
        const double expected = std::pow(grain.deviation(static_cast<float>(greys[i])), 2),
                     found = covariance(luma, column, 0, 0);
        EXPECT_NEAR(found, expected, 0.1 * expected) << name << ", luma " << greys[i];
        EXPECT_NEAR(covariance(luma, column, 1, 0) / found, std::exp(-1 / (4 * grain.spot() * grain.spot())), 0.08)
            << name;
        EXPECT_NEAR(covariance(luma, column, 0, 1) / found, 0, 0.05) << name;
    }
}

TEST(GrainInFilms, HasTheVarianceOfItsModelByLumaInEachCodecSlow) {
    const Folder folder;
    const std::string film = grey_film(folder), grain = " --grain " + std::to_string(film_iso);
    expect_grain(decoded_luma(encoded_greys(folder, film, "--codec mpeg2 -q 1" + grain, "f.m2v")), "MPEG-2");
    expect_grain(decoded_luma(encoded_greys(folder, film, "--codec h264 --crf 4" + grain, "f.mp4")), "H.264");
    if (run("ffmpeg -v error -h encoder=libsvtav1").output.find("preset") == std::string::npos) GTEST_SKIP();
    const std::string made = encoded_greys(folder, film, "--codec av1" + grain, "g.mp4"),
                      plain = encoded_greys(folder, film, "--codec av1", "p.mp4");
    expect_grain(decoded_luma(made, "-c:v libdav1d"), "AV1");
    const std::vector<double> clean = decoded_luma(made, "-c:v libdav1d -export_side_data film_grain");
    EXPECT_EQ(clean, decoded_luma(plain, "-c:v libdav1d"));
    EXPECT_LT(contents(made).size(), contents(plain).size() + 100 + film_frames * 12);
}

TEST(GrainInFilms, OfAv1DithersGradientsAndNothingElse) {
    if (run("ffmpeg -v error -h encoder=libsvtav1").output.find("preset") == std::string::npos) GTEST_SKIP();
    const Folder folder;
    std::ofstream stream(folder / "wall.y4m", std::ios::binary);
    stream << "YUV4MPEG2 W" << film_width << " H" << film_height << " F25:1 Ip A1:1 C420mpeg2\n";
    constexpr int part = film_width / static_cast<int>(greys.size());
    for (int n = 0; n < film_frames; ++n) {
        stream << "FRAME\n";
        for (int y = 0; y < film_height; ++y)
            for (int x = 0; x < film_width; ++x)
                stream.put(static_cast<char>(x < part       ? 50 + y / 20
                                             : x < 2 * part ? 150 + 30 * ((x * x + 7 * y * y) % 5 - 2) / 2
                                                            : 210));
        stream << std::string(film_width * film_height / 2, '\x80');
    }
    stream.close();
    const std::string film = encoded_greys(folder, path(folder, "wall.y4m"), "--codec av1", "f.mp4");
    const std::vector<double> clean = decoded_luma(film, "-c:v libdav1d -export_side_data film_grain");
    std::vector<double> noise = decoded_luma(film, "-c:v libdav1d");
    for (std::size_t i = 0; i < noise.size(); ++i) noise[i] -= clean[i];
    EXPECT_NEAR(covariance(noise, 0, 0, 0), 1.0 / 12, 0.01) << "as large as what rounding to 8 bits leaves";
    EXPECT_NEAR(covariance(noise, 0, 1, 0), 0, 0.005) << "white";
    EXPECT_NEAR(covariance(noise, 0, 0, 1), 0, 0.005) << "new in each picture";
    EXPECT_EQ(covariance(noise, 1, 0, 0), 0) << "texture";
    EXPECT_EQ(covariance(noise, 2, 0, 0), 0) << "an even wall";
}

TEST(GrainInFilms, TellsTheBitsThatItTakesSlow) {
    const Folder folder;
    const std::string film = grey_film(folder);
    const auto bits_of = [&](const std::string& options) {
        encoded_greys(folder, film, options + " --stats " + path(folder, "s.json"), "f.mp4");
        const json statistics = json::parse(contents(folder / "s.json"));
        double bits = 0;
        for (const json& picture : statistics.at("per_frame")) bits += 8 * picture.at("bytes").get<double>();
        return std::pair(bits, statistics.at("grain_bits"));
    };
    for (const std::string codec : {"--codec h264", "--codec mpeg2", "--codec av1"}) {
        if (codec == "--codec av1" &&
            run("ffmpeg -v error -h encoder=libsvtav1").output.find("preset") == std::string::npos)
            continue;
        const auto [with, told] = bits_of(codec + " -q 4 --grain 400");
        const auto [without, nothing] = bits_of(codec + " -q 4");
        EXPECT_TRUE(nothing.is_null());
        EXPECT_EQ(told.at("pictures"), film_frames);
        EXPECT_EQ(told.at("with"), with) << codec;
        EXPECT_GT(with, without) << codec;
        EXPECT_NEAR(told.at("without").get<double>(), without, 0.05 * (with - without)) << codec;
        EXPECT_TRUE(bits_of(codec + " --bitrate 900k --grain 400").second.is_null()) << "grain takes quality";
    }
    const auto said = run(program() + " encode " + film + " -y --grain 400 -o " + path(folder, "f.mp4"));
    EXPECT_NE(said.output.find("\n  grain      "), std::string::npos) << said.output;
}

TEST(GrainInFilms, IsTheSameWhateverMakesThemSlow) {
    const Folder folder;
    std::ofstream(folder / "film.json") << R"({ "exposure": 0, "frames": 62, "size": [64, 64], "grain": 1600,
        "camera": { "position": [0, 0, 4] }, "objects": [{ "shape": "quad", "size": [8, 5], "position": [0, 0, -2] }],
        "lights": [{ "kind": "sphere", "radius": 0.05, "intensity": 900, "position": [0.5, 0.2, 0] }] })";
    const auto made = [&](const std::string& options, const std::string& name) {
        const auto result = run(program() + " render " + path(folder, "film.json") + " -y --quiet --samples 1 " +
                                options + " -o " + path(folder, name));
        EXPECT_EQ(result.status, 0) << result.output;
        return contents(folder / name);
    };
    for (const std::string name : {"f.m2v", "f.mp4", "av1.mp4"}) {
        const std::string codec = name == "av1.mp4" ? "--codec av1 --encoder fast " : "";
        const std::string one = made(codec + "--threads 1", name);
        EXPECT_EQ(made(codec + "--threads 3", "3" + name), one);
        EXPECT_EQ(made(codec + "--threads 3 --chunks-at-once 2", "2" + name), one);
        EXPECT_EQ(made(codec + "--grain 1600", "l" + name), one);
        EXPECT_NE(made(codec + "--grain 0", "0" + name), one);
    }
    const std::string frame = made("--frames 7:7", "p%04d.png");
    EXPECT_TRUE(frame.empty());
    made("--frames 7:7 --grain 0", "c%04d.png");
    EXPECT_NE(codes_of(path(folder, "p0007.png")), codes_of(path(folder, "c0007.png")));
    made("--frames 7:7", "p%04d.exr");
    made("--frames 7:7 --grain 0", "c%04d.exr");
    EXPECT_EQ(contents(folder / "p0007.exr"), contents(folder / "c0007.exr"));
}

TEST(GrainInFilms, IsTheSameBesideAFilmAndInPartsOfAFarmSlow) {
    const Folder folder;
    std::ofstream(folder / "scene.json") << support::travel_scene(80);
    const std::string film = path(folder, "scene.json") +
                             " --hold --frames 0:119 --size 64x64 --samples 1 --gop 30 --overwrite --quiet --threads 1"
                             " --grain 800 -o ";
    const std::string whole = path(folder, "w.mpg"), farm = path(folder, "f.mpg");
    ASSERT_EQ(run(program() + " render " + film + whole + " --also neutral:prores " + path(folder, "w.mov")).status, 0);
    ASSERT_EQ(run(program() + " farm " + film + farm + " --also neutral:prores " + path(folder, "f.mov") +
                  " --to parallel --parts 2")
                  .status,
              0);
    for (const char* part : {" 2", " 1"})
        ASSERT_EQ(run(program() + " part --threads 1 --quiet " + farm + ".farm" + part).status, 0);
    ASSERT_EQ(run(program() + " join --threads 1 --quiet " + farm + ".farm").status, 0);
    EXPECT_EQ(contents(whole), contents(farm));
    EXPECT_EQ(contents(folder / "w.mov"), contents(folder / "f.mov"));
}

}  // namespace
}  // namespace render2mpeg::test
