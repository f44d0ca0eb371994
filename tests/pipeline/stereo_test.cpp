#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <string>
#include <tuple>

#include "app/job/eyes.h"
#include "pipeline/fixture.h"

/// Films for two eyes through the program.
namespace render2mpeg::test {
namespace {

using core::FramePacking;

constexpr int eye_width = 64, eye_height = 48;

const std::string things =
    R"("exposure": 0, "sky": [0.3, 0.4, 0.5], "objects": [
      { "shape": "box", "size": [6, 0.2, 6], "position": [0, -0.6, 0], "material": { "base_color": [0.6, 0.5, 0.4] } },
      { "shape": "box", "position": [0.5, 0, -1], "size": 1, "material": { "base_color": [0.7, 0.2, 0.2] } },
      { "shape": "sphere", "radius": 0.4, "position": [-0.5, -0.1, 0.2], "material": { "roughness": 0.3 } }],
      "lights": [{ "kind": "point", "position": [2, 3, 2], "intensity": 30 }])";

std::string two_eyes(const Folder& folder, const std::string& camera, const std::string& more = "",
                     const std::string& name = "film.json") {
    std::ofstream(folder / name) << "{ " << things << more << R"(, "camera": { "fov": 45, )" << camera << " } }";
    return path(folder, name);
}

const std::string at_rest = R"("position": [0, 0.5, 3])";
const std::string on_the_way =
    R"("keys": [{ "at": 0, "position": [0, 0.5, 3] }, { "at": 0.4, "position": [0.3, 0.5, 2.8] }])";

support::Outcome render(const std::string& words) {
    return run(program() + " render " + words + " --overwrite --quiet");
}

/// Part of a picture of RGB code values.
std::string part_of(const std::string& codes, int across, int left, int top) {
    std::string part;
    for (int y = top; y < top + eye_height; ++y)
        part += codes.substr(static_cast<std::size_t>(3 * (y * across + left)), 3u * eye_width);
    return part;
}

/// PSNR of code values, and of the means the ratio.
std::pair<double, double> compared(const std::string& a, const std::string& b) {
    EXPECT_EQ(a.size(), b.size());
    double square = 0, sum_a = 0, sum_b = 0;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
        const double one = static_cast<unsigned char>(a[i]), other = static_cast<unsigned char>(b[i]);
        square += (one - other) * (one - other);
        sum_a += one;
        sum_b += other;
    }
    return {10 * std::log10(255 * 255 * static_cast<double>(a.size()) / std::max(square, 1e-6)), sum_a / sum_b};
}

TEST(StereoPacking, OfPartsIsUndoneByTakingTheParts) {
    for (const FramePacking packing : {FramePacking::side_by_side, FramePacking::top_bottom}) {
        std::vector<core::ToleranceMap> eyes;
        for (const float first : {1.0f, 100.0f}) {
            core::ToleranceMap map = core::ToleranceMap::uniform(3, 2, {});
            for (std::size_t i = 0; i < 6; ++i) map.pixels.values()[i].absolute = first + static_cast<float>(i);
            map.typical = 0.5f;
            map.means = 0.25f;
            map.most_rays = 16;
            eyes.push_back(map);
        }
        const core::ToleranceMap whole = app::packed(eyes, packing);
        EXPECT_EQ(whole.pixels.width(), packing == FramePacking::side_by_side ? 6 : 3);
        EXPECT_EQ(whole.pixels.size(), 12u);
        for (const std::size_t e : {0u, 1u}) {
            const core::ToleranceMap part = app::part_of(whole, packing, e);
            EXPECT_EQ(part.pixels, eyes[e].pixels);
            EXPECT_EQ(std::tuple(part.typical, part.means, part.most_rays), std::tuple(0.5f, 0.25f, 16.0f));
        }
    }
}

TEST(StereoPacking, LetsNothingMoveFromOneEyeToTheOther) {
    core::MotionField eye;
    eye.vector = core::Plane<glm::vec2>(4, 2, glm::vec2(1.5f, 0));
    eye.kind = core::Plane<core::PixelClass>(4, 2, core::PixelClass::surface);
    eye.wraps = true;
    const core::MotionField across = app::packed({eye, eye}, FramePacking::side_by_side);
    EXPECT_FALSE(across.wraps);
    for (int x = 0; x < 8; ++x) EXPECT_EQ(across.kind.at(x, 1) == core::PixelClass::none, x % 4 >= 2) << x;
    const core::MotionField down = app::packed({eye, eye}, FramePacking::top_bottom);
    EXPECT_TRUE(down.wraps);
    for (const core::PixelClass kind : down.kind.values()) EXPECT_EQ(kind, core::PixelClass::surface);
}

TEST(StereoPacking, CarriesLightToTheEyeThatSeesTheSameAndFillsTheRest) {
    constexpr int wide = 6;
    core::Visible left(0, wide, 1), right(0, wide, 1);
    core::Radiance light;
    light.combined = core::Plane<glm::vec3>(wide, 1);
    core::MotionField to_left{0, 0, core::Plane<glm::vec2>(wide, 1, glm::vec2(1, 0)), core::Plane<float>(wide, 1, 2.0f),
                              core::Plane<core::PixelClass>(wide, 1, core::PixelClass::surface)};
    for (int x = 0; x < wide; ++x) {
        light.combined.at(x, 0) = glm::vec3(static_cast<float>(10 * x));
        for (core::Visible* seen : {&left, &right}) {
            seen->kind.at(x, 0) = core::PixelClass::surface;
            seen->address.at(x, 0).object = 3;
            seen->depth.at(x, 0) = 2;
        }
    }
    left.depth.at(3, 0) = 1;  // something else, for the left eye alone
    const core::Radiance carried = app::carried_to_right(light, left, right, to_left);
    const float expected[wide] = {10, 20, 20, 40, 50, 50};
    for (int x = 0; x < wide; ++x) EXPECT_EQ(carried.combined.at(x, 0).x, expected[x]) << x;
}

/// Cameras that are moved aside by hand, and their pictures shifted, see what eyes see.
TEST(StereoFilmSlow, ShowsEachEyeWhatACameraInItsPlaceShows) {
    const Folder folder;
    const std::string size = " --size 64x48 --tolerance fixed=1% --frames 0:0 -o ";
    const std::string eyes = R"(, "stereo": { "interocular_distance": 0.4, "convergence_distance": 3, "convergence": )";
    for (const std::string& convergence : {std::string("parallel"), std::string("off-axis")})
        for (const bool across : {true, false}) {
            const std::string both = two_eyes(folder, at_rest + eyes + '"' + convergence + "\" }");
            const std::string packing = across ? "side-by-side" : "top-bottom";
            ASSERT_EQ(render(both + " --stereo " + packing + size + path(folder, "both%d.png")).status, 0);
            const std::string codes = codes_of(path(folder, "both0.png"));
            ASSERT_EQ(codes.size(), 2u * 3 * eye_width * eye_height);
            for (const int eye : {0, 1}) {
                const double aside = eye == 0 ? -0.2 : 0.2,
                             shift = convergence == "parallel" ? 0 : -aside / (6 * std::tan(glm::radians(22.5)));
                const std::string alone = two_eyes(folder,
                                                   R"("position": [)" + std::to_string(aside) +
                                                       R"(, 0.5, 3], "shift": [)" + std::to_string(shift) + ", 0]",
                                                   "", "alone.json");
                ASSERT_EQ(render(alone + size + path(folder, "alone%d.png")).status, 0);
                const std::string part = across ? part_of(codes, 2 * eye_width, eye * eye_width, 0)
                                                : part_of(codes, eye_width, 0, eye * eye_height);
                const auto [psnr, mean] = compared(part, codes_of(path(folder, "alone0.png")));
                EXPECT_GT(psnr, 45) << convergence << packing << eye;
                EXPECT_NEAR(mean, 1, 0.01) << convergence << packing << eye;
            }
            const auto [apart, mean] = compared(
                part_of(codes, across ? 2 * eye_width : eye_width, 0, 0),
                part_of(codes, across ? 2 * eye_width : eye_width, across ? eye_width : 0, across ? 0 : eye_height));
            EXPECT_LT(apart, 32) << "eyes see different pictures";
        }
}

/// Counts of a film of four frames.
json counts_of(const Folder& folder, const std::string& film, const std::string& packing) {
    const std::string stats = path(folder, packing + ".json");
    EXPECT_EQ(render(film + " --size 192x144 --quantiser 8 --frames 0:3 --stereo " + packing + " --stats " + stats +
                     " -o " + path(folder, packing + ".mp4"))
                  .status,
              0);
    return json::parse(contents(stats)).at("counts");
}

/// Shadows and bounced light that the left eye has found are the right one's where it sees the same.
TEST(StereoFilmSlow, LightsForTheSecondEyeWhatTheFirstDoesNotSee) {
    const Folder folder;
    const std::string words = two_eyes(folder, on_the_way);
    const json one = counts_of(folder, words, "none"), both = counts_of(folder, words, "side-by-side");
    const auto more = [&](const char* key) { return both.at(key).get<double>() / one.at(key).get<double>() - 1; };
    EXPECT_LT(more("gather_points"), 1.1);
    EXPECT_GT(more("gather_points"), 0.7) << "the look before the first frame is one eye's";
    EXPECT_LT(more("shadow_rays"), 0.5);
    EXPECT_LT(more("gather_rays"), 0.5);
    EXPECT_GT(more("shadow_rays"), 0.02) << "rims are lit anew";
}

TEST(StereoFilmSlow, HasTheSameBytesForAnyNumberOfThreads) {
    const Folder folder;
    const std::string words =
        two_eyes(folder, on_the_way, R"(, "frames": 5, "stereo": "side-by-side")") + " --size 64x48 --quantiser 8 -o ";
    const std::string one = path(folder, "one.mkv"), four = path(folder, "four.mkv");
    ASSERT_EQ(render(words + one + " --threads 1").status, 0);
    ASSERT_EQ(render(words + four + " --threads 4").status, 0);
    EXPECT_EQ(contents(one), contents(four));
    const auto shown = run(program() + " info --summary " + one);
    EXPECT_NE(shown.output.find("128x48"), std::string::npos) << shown.output;
    EXPECT_NE(shown.output.find("two, side-by-side"), std::string::npos) << shown.output;
}

TEST(StereoFilmSlow, OfAPanoramaIsMadeWithAllThatMovesAndBlurs) {
    const Folder folder;
    std::ofstream(folder / "film.json")
        << "{ " << things << R"(, "frames": 3, "shutter": 180, "glare": "static", "stereo": "top-bottom", "camera": {
            "projection": "equirectangular", "stereo": { "interocular_distance": 0.1 },
            "keys": [{ "at": 0, "position": [0, 0.5, 2], "rotate": 0 }, { "at": 0.12, "position": [0, 0.5, 2], "rotate": 20 }] } })";
    const auto made = render(path(folder, "film.json") + " --size 64x32 --samples 1 -o " + path(folder, "film.mp4"));
    EXPECT_EQ(made.status, 0) << made.output;
    EXPECT_EQ(made.output, "");
    const auto shown = run(program() + " info --summary " + path(folder, "film.mp4"));
    EXPECT_NE(shown.output.find("64x64"), std::string::npos) << shown.output;
    EXPECT_NE(shown.output.find("equirectangular, 360 by 180 degrees"), std::string::npos) << shown.output;
    EXPECT_NE(shown.output.find("two, top-bottom"), std::string::npos) << shown.output;
}

/// What FFmpeg says of the eyes of a film: of its container, and of its first picture.
std::string eyes_in(const std::string& file) {
    return run("ffprobe -v error -select_streams v:0 -show_streams -show_frames -read_intervals '%+#1' " + file).output;
}

TEST(StereoFilm, SaysHowItsPicturesHoldBothEyesWhereItCanSlow) {
    const Folder folder;
    const std::string words =
        two_eyes(folder, at_rest) + " --frames 0:0 --size 64x64 --samples 1 --stereo top-bottom -o ";
    for (const char* name : {"film.mp4", "film.mkv"}) {
        EXPECT_EQ(render(words + path(folder, name)).output, "") << name;
        EXPECT_NE(eyes_in(path(folder, name)).find("type=top and bottom"), std::string::npos) << name;
    }
    // H.264 says it itself; MPEG-2 cannot, and that is told.
    const std::string stream = path(folder, "film.ts");
    EXPECT_EQ(render(words + stream + " --codec h264").output, "");
    EXPECT_NE(eyes_in(stream).find("stereo_mode=top_bottom"), std::string::npos) << eyes_in(stream);
    const auto told = run(program() + " render " + words + path(folder, "film.mpg"));
    EXPECT_EQ(told.status, 0);
    EXPECT_NE(told.output.find("such files cannot say that they are for two eyes; .mp4, .mkv and .webm do"),
              std::string::npos)
        << told.output;
    const auto beside = run(program() + " render " + words + path(folder, "film.mkv") + " --overwrite --also neutral " +
                            path(folder, "also.mpg"));
    EXPECT_EQ(beside.status, 0);
    EXPECT_NE(beside.output.find("also.mpg: such files cannot say that they are for two eyes"), std::string::npos)
        << beside.output;
}

TEST(StereoFilm, RefusesPicturesThatCannotHoldBothEyes) {
    const Folder folder;
    const auto refused = [](const std::string& words, const std::string& why) {
        const auto outcome = run(program() + " " + words);
        EXPECT_EQ(outcome.status, 2) << outcome.output;
        EXPECT_NE(outcome.output.find(why), std::string::npos) << outcome.output;
        EXPECT_EQ(std::ranges::count(outcome.output, '\n'), 1) << outcome.output;
    };
    const std::string plain = two_eyes(folder, at_rest), both = plain + " --stereo side-by-side";
    refused("plan " + both + " --size 65x64", "65x64 for each eye: take an even width");
    refused("plan " + plain + " --stereo top-bottom --size 64x65", "take an even height");
    refused("plan " + both + " --for dvd-pal -o " + path(folder, "film.mpg"), "are for one eye");
    refused("render " + both + " --audit 5 -o " + path(folder, "film.mp4"), "--audit: with --stereo side-by-side");
    refused("compare " + both, "stereo: settings are tried on films for one eye; say --stereo none");
    refused("plan " + plain + " --stereo crossed", "--stereo");
    std::ofstream(folder / "film.json") << "{ " << things << R"(, "camera": { "height": 2 } })";
    refused("plan " + plain + " --stereo side-by-side", "parallel rays, which see no depth");
}

TEST(StereoFilm, RefusesEyesThatCannotBe) {
    const Folder folder;
    const auto refused = [&](const std::string& eyes, const std::string& why) {
        const auto outcome =
            run(program() + " plan --within 0 " + two_eyes(folder, at_rest + R"(, "stereo": )" + eyes));
        EXPECT_EQ(outcome.status, 1) << outcome.output;
        EXPECT_NE(outcome.output.find(why), std::string::npos) << outcome.output;
    };
    refused(R"({ "interocular_distance": -0.1 })", "interocular_distance");
    refused(R"({ "convergence_distance": 0 })", "convergence_distance");
    refused(R"({ "convergence": "crossed" })", "convergence");
    refused(R"({ "pole_merge": [80, 70] })", "from the lower to the higher");
    refused(R"("side-by-side")", "stereo");
}

}  // namespace
}  // namespace render2mpeg::test
