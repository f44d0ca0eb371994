#include "app/options/shape.h"

#include <gtest/gtest.h>

#include <fstream>

#include "app/job/render_job.h"
#include "app/options/film.h"
#include "app/options/mistakes.h"
#include "app/options/option_text.h"
#include "core/error.h"
#include "encoder/cadence.h"
#include "encoder/encoder.h"
#include "support/program.h"

/// Sizes, rates and shapes of films, with and without a preset.
namespace render2mpeg::app {
namespace {

ShapeWishes scene(std::optional<Size> size, const char* rate, std::optional<core::Rational> shown = {}) {
    ShapeWishes wishes;
    wishes.source = "scene";
    wishes.source_size = size;
    if (rate != nullptr) wishes.source_rate = core::frame_rate_from(rate);
    wishes.source_display_aspect = shown;
    return wishes;
}

ShapeWishes frames(Size size, const char* rate, std::optional<core::Rational> shown = {}) {
    ShapeWishes wishes = scene(size, rate, shown);
    wishes.source = "frames.y4m";
    wishes.finished = true;
    return wishes;
}

void expect_refused(const ShapeWishes& wishes, const char* preset, std::initializer_list<const char*> words) {
    try {
        settle_shape(wishes, preset != nullptr ? preset_from(preset) : nullptr);
        FAIL() << "not refused: " << *words.begin();
    } catch (const core::Error& error) {
        const std::string line = error.what();
        for (const char* word : words) EXPECT_NE(line.find(word), std::string::npos) << line << " lacks " << word;
        EXPECT_EQ(line.find('\n'), std::string::npos);
    }
}

TEST(Shape, FollowsTheScenesCameraWhereNobodySaysASize) {
    const std::pair<core::Rational, Size> shapes[] = {
        {{16, 9}, {640, 360}}, {{4, 3}, {640, 480}}, {{1, 1}, {640, 640}}, {{9, 16}, {360, 640}}};
    for (const auto& [shape, size] : shapes) {
        ShapeWishes wishes = scene({}, nullptr);
        wishes.framed = shape;
        const Size settled = settle_shape(wishes, nullptr).size;
        EXPECT_EQ(settled.width, size.width);
        EXPECT_EQ(settled.height, size.height);
        wishes.source_size = Size{320, 200};
        EXPECT_EQ(settle_shape(wishes, nullptr).size.width, 320) << "the animation file says more";
    }
}

TEST(Shape, WithoutAPresetPixelsAreSquareUnlessSomebodySaysOtherwise) {
    const Shape plain = settle_shape(scene({}, nullptr), nullptr);
    EXPECT_EQ(plain.size.width, 512);
    EXPECT_EQ(plain.rate.code, 3);
    EXPECT_EQ(plain.pixel_aspect, (core::Rational{1, 1}));
    EXPECT_EQ(plain.aspect_ratio_code, 1);

    ShapeWishes wishes = scene(Size{720, 576}, "25");
    wishes.display_aspect = core::Rational{16, 9};
    EXPECT_EQ(settle_shape(wishes, nullptr).pixel_aspect, (core::Rational{64, 45}));
    EXPECT_EQ(settle_shape(wishes, nullptr).aspect_ratio_code, 3);
    wishes = scene(Size{720, 480}, "30", core::Rational{4, 3});
    EXPECT_EQ(settle_shape(wishes, nullptr).pixel_aspect, (core::Rational{8, 9}));
    EXPECT_EQ(settle_shape(wishes, nullptr).aspect_ratio_code, 2);
    // The command line wins over the file; broadcasting's 12:11 is 4:3 on 704 of the 720 columns.
    wishes.pixel_aspect = core::Rational{12, 11};
    wishes.size = Size{704, 576};
    EXPECT_EQ(settle_shape(wishes, nullptr).pixel_aspect, (core::Rational{12, 11}));
    EXPECT_EQ(settle_shape(wishes, nullptr).aspect_ratio_code, 2);
}

TEST(Shape, OnlyMpeg2HasButFour) {
    ShapeWishes wishes = scene(Size{720, 576}, "12.5");
    wishes.display_aspect = core::Rational{239, 100};
    const Shape shape = settle_shape(wishes, nullptr);
    EXPECT_NEAR(shape.pixel_aspect.value() * 720 / 576, 2.39, 1e-12);
    encoder::Settings film = coding_settings({}, shape, 0, "film.mp4");
    EXPECT_EQ(film.codec, encoder::Codec::h264);
    EXPECT_EQ(film.pixel_aspect, shape.pixel_aspect);
    EXPECT_EQ(film.rate.hertz, (core::Rational{25, 2}));
    const auto refused = [&](const char* word) {
        try {
            encoder::check(film);
            FAIL() << "not refused: " << word;
        } catch (const core::Error& error) {
            EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
        }
    };
    film = coding_settings({}, shape, 0, "film.mpg");
    refused("2.39:1");
    film.aspect_ratio_code = 1;
    refused("frame rate 12.5: MPEG-2 has 23.976");
    film.rate = core::frame_rate_from("25");
    EXPECT_NO_THROW(encoder::check(film));
}

TEST(Shape, APresetTakesTheNearestOfItsRatesAndShapesForAScene) {
    const auto settled = [](const char* preset, const ShapeWishes& wishes) {
        return settle_shape(wishes, preset_from(preset));
    };
    const Shape pal = settled("dvd-pal", scene(Size{1280, 720}, "60", core::Rational{1280, 720}));
    EXPECT_EQ(pal.size.width, 720);
    EXPECT_EQ(pal.size.height, 576);
    EXPECT_EQ(pal.rate.code, 3);
    EXPECT_EQ(pal.aspect_ratio_code, 3);
    EXPECT_EQ(pal.pixel_aspect, (core::Rational{64, 45}));
    EXPECT_EQ(settled("dvd-pal", scene(Size{512, 512}, "25", core::Rational{1, 1})).aspect_ratio_code, 2);
    EXPECT_EQ(settled("dvd-ntsc", scene({}, "24")).rate.code, 1);
    EXPECT_EQ(settled("dvd-ntsc", scene({}, "25")).rate.code, 1);
    EXPECT_EQ(settled("dvd-ntsc", scene({}, "30")).rate.code, 4);
    EXPECT_EQ(settled("dvd-ntsc", scene({}, "60")).rate.code, 4);
    EXPECT_EQ(settled("dvd-ntsc", scene({}, "25")).aspect_ratio_code, 3);
    const Shape hd = settled("atsc", scene({}, "60"));
    EXPECT_EQ(hd.size.height, 720);
    EXPECT_EQ(hd.rate.code, 8);
    EXPECT_EQ(hd.pixel_aspect, (core::Rational{1, 1}));
    EXPECT_EQ(hd.aspect_ratio_code, 3);
    ShapeWishes full = scene({}, "60");
    full.size = Size{1920, 1080};
    EXPECT_EQ(settled("atsc", full).rate.code, 5) << "no 60 pictures of this size";
    full.size = Size{704, 480};
    full.display_aspect = core::Rational{4, 3};
    EXPECT_EQ(settled("atsc", full).pixel_aspect, (core::Rational{10, 11}));
}

TEST(Shape, WhatContradictsAPresetIsRefusedByOneLineThatNamesBoth) {
    ShapeWishes wishes = scene({}, "25");
    wishes.size = Size{640, 480};
    expect_refused(wishes, "dvd-pal", {"--size 640x480", "--for dvd-pal", "720x576"});
    wishes = scene({}, "25");
    wishes.rate = core::frame_rate_from("25");
    expect_refused(wishes, "dvd-ntsc", {"--fps 25", "--for dvd-ntsc", "23.976", "29.97"});
    wishes = scene({}, "25");
    wishes.display_aspect = core::Rational{221, 100};
    expect_refused(wishes, "dvd-pal", {"--display-aspect 2.21:1", "--for dvd-pal", "16:9 and 4:3"});
    wishes = scene({}, "25");
    wishes.pixel_aspect = core::Rational{1, 1};
    expect_refused(wishes, "dvd-pal", {"--pixel-aspect 1:1", "--for dvd-pal", "--display-aspect"});
    // Finished frames are as they are.
    expect_refused(frames({512, 512}, "25"), "dvd-pal", {"frames.y4m", "512x512", "--for dvd-pal"});
    expect_refused(frames({720, 576}, "24", core::Rational{16, 9}), "dvd-pal", {"frames.y4m", "24", "--for dvd-pal"});
    expect_refused(frames({720, 576}, "25"), "dvd-pal", {"frames.y4m", "--for dvd-pal", "--display-aspect"});
    expect_refused(frames({720, 576}, "25", core::Rational{5, 4}), "dvd-pal", {"5:4", "--for dvd-pal"});
    EXPECT_EQ(settle_shape(frames({720, 576}, "25", core::Rational{4, 3}), preset_from("dvd-pal")).aspect_ratio_code,
              2);
    EXPECT_EQ(settle_shape(frames({1280, 720}, nullptr), preset_from("atsc")).aspect_ratio_code, 3);
}

TEST(Preset, GopsStayWithinTheirFields) {
    CodingOptions options;
    const auto coding = [&](const char* preset, const char* rate) {
        options.preset = preset_from(preset);
        ShapeWishes wishes = scene({}, rate);
        const encoder::Settings s = coding_settings(options, settle_shape(wishes, preset_from(preset)), 0, {});
        EXPECT_NO_THROW(encoder::check(s));
        return s;
    };
    const encoder::Settings film = coding("dvd-ntsc", "23.976"), video = coding("dvd-ntsc", "29.97"),
                            pal = coding("dvd-pal", "25"), hd = coding("atsc", "59.94");
    EXPECT_EQ(film.cadence, encoder::Cadence::pulldown);
    EXPECT_EQ(film.gop, 12);
    EXPECT_EQ(video.cadence, encoder::Cadence::fields);
    EXPECT_EQ(video.gop, 18);
    EXPECT_EQ(pal.gop, 15);
    EXPECT_EQ(hd.cadence, encoder::Cadence::frames);
    EXPECT_EQ(hd.gop, 30);
    for (const encoder::Settings& s : {film, video, pal})
        EXPECT_LE(encoder::fields_before(s.cadence, s.gop), s.height == 480 ? 36 : 30);
    EXPECT_EQ(film.rate_control.max_rate, 9'000'000);
    EXPECT_EQ(pal.rate_control.buffer_bits, 1'835'008);
    EXPECT_LE(hd.rate_control.buffer_bits, 7'995'392);

    // ATSC: bits wait at most half a second.
    options.bitrate = 4'000'000;
    options.constant_rate = true;
    EXPECT_EQ(coding("atsc", "59.94").rate_control.buffer_bits, 2'000'000);
    EXPECT_EQ(coding("dvd-pal", "25").rate_control.buffer_bits, 1'835'008);
    options.bitrate = 9'900'000;
    EXPECT_THROW(coding("dvd-pal", "25"), core::Error);
    options.bitrate.reset();
    options.constant_rate = false;
    options.vbv = 1'836'000;
    EXPECT_THROW(coding("dvd-pal", "25"), core::Error);
    options.vbv.reset();

    options.gop = 14;
    EXPECT_EQ(coding("dvd-ntsc", "23.976").gop, 14);
    options.gop = 15;
    EXPECT_THROW(coding("dvd-ntsc", "23.976"), core::Error);
    options.gop = 60;
    EXPECT_EQ(coding("atsc", "60").gop, 60);
    options.gop.reset();
    options.b_pictures = 3;
    EXPECT_THROW(coding("dvd-pal", "25"), core::Error);
    EXPECT_EQ(coding("atsc", "60").b_pictures, 3);
}

TEST(Gops, AreLongWhereNobodySaysAndChunksAreNoLongerForIt) {
    const encoder::Settings s = coding_settings({}, settle_shape(scene({}, "30"), nullptr), 0, {});
    EXPECT_EQ(s.gop, 60);
    const std::vector<Chunk> chunks = chunks_of({0, 129}, s.gop), of_short_gops = chunks_of({0, 129}, 15);
    ASSERT_EQ(chunks.size(), 3u);
    ASSERT_EQ(of_short_gops.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(chunks[i].last, of_short_gops[i].last);
}

TEST(Preset, TakesTheContainersOfItsWorld) {
    for (const char* good : {"a.mpg", "a.VOB", "a.m2v", "a.y4m", "f.%04d.exr", ""})
        EXPECT_NO_THROW(preset_from("dvd-pal")->check_output(good)) << good;
    for (const char* bad : {"a.ts", "a.mkv", "a.mp4"})
        EXPECT_THROW(preset_from("dvd-pal")->check_output(bad), core::Error) << bad;
    EXPECT_NO_THROW(preset_from("atsc")->check_output("a.ts"));
    EXPECT_THROW(preset_from("atsc")->check_output("a.mpg"), core::Error);
    EXPECT_THROW(preset_from("vcd"), core::Error);
}

TEST(Keyframes, AreReadFromListsAndFiles) {
    using Frames = std::vector<std::int64_t>;
    EXPECT_EQ(keyframes_from("48,0,96,48").frames, (Frames{0, 48, 96}));
    EXPECT_EQ(keyframes_from("7").frames, Frames{7});
    const support::Folder folder;
    std::ofstream(folder / "k.txt") << "# chapters\n0 48,\n  96 # the door opens\n\n120";
    EXPECT_EQ(keyframes_from((folder / "k.txt").string()).frames, (Frames{0, 48, 96, 120}));
    std::ofstream(folder / "bad.txt") << "0 48 x96";
    std::ofstream(folder / "none.txt") << "# 48\n \n";
    for (const std::string& wrong :
         {std::string("1,-2"), std::string("99999999999"), std::string("no such file"), std::string(""),
          std::string(","), (folder / "bad.txt").string(), (folder / "none.txt").string(), (folder / ".").string()})
        EXPECT_THROW(keyframes_from(wrong), core::Error) << wrong;
}

TEST(Keyframes, OfADvdThatAreTooCloseForAChapterAreTold) {
    Film film;
    film.frames = {0, 99};
    film.coding.rate = core::frame_rate_from("25");
    film.keyframes = {{5, 20, 29, 50, 60}};
    film.coding.gop = 10;
    EXPECT_EQ(keyframes_without_chapter(film), "") << "no DVD";
    film.disc = true;
    // Groups begin at 0, 5, 15, 20, 29, 39, 49, 50 and 60; units at 0, 15, 29, 39, 49 and 60.
    EXPECT_NE(keyframes_without_chapter(film).find("begin at 5, 20, 50:"), std::string::npos)
        << keyframes_without_chapter(film);
    film.keyframes = {{0, 20, 30, 90}};
    EXPECT_EQ(keyframes_without_chapter(film), "");
}

TEST(Keyframes, EndWhatIsPromised) {
    const Keyframes keyframes{{4, 5, 9}};
    const std::vector<std::int64_t> left{3, 2, 1, 0, 0, 3, 2, 1, 0, 2, 1, 0};
    for (std::int64_t n = 0; n < 12; ++n) {
        EXPECT_EQ(keyframes.frames_left(n, 11 - n), left[static_cast<std::size_t>(n)]) << n;
        EXPECT_EQ(keyframes.begins_at(n), n == 4 || n == 5 || n == 9);
    }
    EXPECT_EQ(Keyframes{}.frames_left(3, 8), 8);
}

TEST(Sizes, OfSmallerPicturesAreThoseThatTheirCodecTakes) {
    const auto expect = [](Size whole, double scale, std::optional<encoder::Codec> codec, Size right) {
        const Size found = scaled(whole, scale, codec);
        EXPECT_EQ(found.width, right.width);
        EXPECT_EQ(found.height, right.height);
    };
    const Size whole{320, 180};
    expect(whole, 0.25, encoder::Codec::mpeg2, {80, 46});
    expect(whole, 0.25, encoder::Codec::h264, {80, 46});
    expect(whole, 0.1, encoder::Codec::h264, {32, 18});
    expect(whole, 0.05, encoder::Codec::h264, {16, 16});
    expect(whole, 0.1, encoder::Codec::av1, {114, 64});
    expect(whole, 0.5, encoder::Codec::dnxhr, {256, 144});
    expect(whole, 0.01, {}, {3, 2});
    expect({640, 20}, 0.5, encoder::Codec::h264, {320, 16});
    EXPECT_DOUBLE_EQ(scale_taken(whole, 0.5, encoder::Codec::dnxhr), 0.8);
    EXPECT_DOUBLE_EQ(scale_taken({200, 100}, 0.5, encoder::Codec::dnxhr), 1) << "the codec refuses the whole one";
}

TEST(Sizes, OfDraftsAreThoseThatTheirCodecTakes) {
    const auto expect = [](const char* codec, const char* output, Size whole, Size right) {
        const support::Folder folder;
        std::ofstream(folder / "film.json")
            << "{\"size\": [" << whole.width << ", " << whole.height << R"(], "objects": [{"shape": "box"}]})";
        RenderOptions options;
        options.input = folder / "film.json";
        options.preview = true;
        options.coding.codec = codec_from(codec);
        options.output = output;
        const RenderJob film = prepare(options);
        EXPECT_EQ(film.size().width, right.width) << codec;
        EXPECT_EQ(film.size().height, right.height) << codec;
    };
    expect("h264", "draft.mp4", {320, 176}, {160, 88});
    expect("av1", "draft.mp4", {160, 80}, {128, 64});
    expect("dnxhr", "draft.mov", {1920, 1080}, {1280, 720});
}

}  // namespace
}  // namespace render2mpeg::app
