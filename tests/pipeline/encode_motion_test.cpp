#include <gtest/gtest.h>

#include <fstream>
#include <limits>

#include "app/files/file_io.h"
#include "app/loop/motion_source.h"
#include "app/options/output_kind.h"
#include "core/error.h"
#include "core/sampling.h"
#include "encoder/encoder.h"
#include "image/image.h"
#include "image/layers.h"
#include "image/motion_file.h"
#include "support/program.h"

/// Motion that comes from files: which way vectors point, and how steps are joined.
namespace render2mpeg::app {
namespace {

using image::FrameMotion;
using image::read_motion;
using support::Folder;

constexpr int layer_width = 64, layer_height = 48;

struct Values {
    std::string name;
    float value;
};

/// A file in which each channel has one value everywhere.
void write_motion(const std::filesystem::path& file, const std::vector<Values>& values, int w = layer_width,
                  int h = layer_height) {
    std::vector<image::Channel> channels;
    for (const Values& v : values)
        channels.push_back({v.name, std::vector<float>(static_cast<std::size_t>(w * h), v.value), false});
    image::write_exr(file, w, h, channels);
}

void expect_everywhere(const core::MotionField& field, std::int64_t picture, std::int64_t reference, glm::vec2 v) {
    EXPECT_EQ(field.picture, picture);
    EXPECT_EQ(field.reference, reference);
    ASSERT_EQ(field.vector.size(), static_cast<std::size_t>(layer_width * layer_height));
    for (std::size_t i = 0; i < field.vector.size(); ++i) {
        ASSERT_EQ(field.kind.values()[i], core::PixelClass::surface);
        ASSERT_EQ(field.vector.values()[i], v);
    }
}

// In all of these something came 4 pixels to the right and 2 up, and goes on 6 to the right and 3 up: in the frame
// before it was at (-4, +2) from here, in the next one it will be at (+6, -3), y down.
const glm::vec2 before{-4, 2}, after{6, -3};

TEST(MotionConvention, BlendersVectorPointsFromThePreviousFrameAndToTheNext) {
    const Folder folder;
    for (const std::string layer : {"ViewLayer.", "Some Layer.", ""}) {
        write_motion(folder / "f.exr", {{layer + "Vector.X", -4},
                                        {layer + "Vector.Y", -2},
                                        {layer + "Vector.Z", -6},
                                        {layer + "Vector.W", -3},
                                        {layer + "Combined.R", 1}});
        const FrameMotion motion =
            read_motion(folder / "f.exr", 7, layer_width, layer_height, MotionConvention::blender);
        expect_everywhere(motion.to_previous, 7, 6, before);
        expect_everywhere(motion.to_next, 7, 8, after);
    }
}

TEST(MotionConvention, NukesLayersPointToTheOtherFrames) {
    const Folder folder;
    const auto file = folder / "f.exr";
    const auto read = [&] { return read_motion(file, 7, layer_width, layer_height, MotionConvention::nuke); };
    write_motion(file, {{"forward.u", 6}, {"forward.v", 3}, {"backward.u", -4}, {"backward.v", -2}});
    expect_everywhere(read().to_previous, 7, 6, before);
    expect_everywhere(read().to_next, 7, 8, after);

    // One direction alone is taken for even motion.
    for (const std::string layer : {"forward", "motion", "rgba.motion"}) {
        write_motion(file, {{layer + ".u", 6}, {layer + ".v", 3}});
        expect_everywhere(read().to_previous, 7, 6, -after);
        expect_everywhere(read().to_next, 7, 8, after);
    }
    write_motion(file, {{"backward.u", -4}, {"backward.v", -2}});
    expect_everywhere(read().to_previous, 7, 6, before);
    expect_everywhere(read().to_next, 7, 8, -before);
}

TEST(MotionConvention, LayersOfOursComeBackExactly) {
    const Folder folder;
    core::Visible visible(3, layer_width, layer_height);
    core::MotionField to_previous, to_next;
    to_previous.vector = to_next.vector = core::Plane<glm::vec2>(layer_width, layer_height);
    for (std::size_t i = 0; i < visible.kind.size(); ++i) {
        visible.kind.values()[i] = static_cast<core::PixelClass>(i % 4);
        to_previous.vector.values()[i] = {core::uniform(1, i) * 40 - 20, core::uniform(2, i) * 40 - 20};
        to_next.vector.values()[i] = {core::uniform(3, i) * 40 - 20, core::uniform(4, i) * 40 - 20};
    }
    to_previous.kind = to_next.kind = visible.kind;
    core::Radiance radiance;
    radiance.combined = core::Plane<glm::vec3>(layer_width, layer_height, glm::vec3(0.5f));
    image::write_layers(folder / "f.exr", visible, radiance, &to_previous, &to_next);

    const FrameMotion motion = read_motion(folder / "f.exr", 3, layer_width, layer_height, MotionConvention::blender);
    EXPECT_TRUE(motion.to_previous.kind == visible.kind);
    EXPECT_TRUE(motion.to_next.kind == visible.kind);
    for (std::size_t i = 0; i < visible.kind.size(); ++i)
        if (visible.kind.values()[i] != core::PixelClass::none) {
            ASSERT_EQ(motion.to_previous.vector.values()[i], to_previous.vector.values()[i]);
            ASSERT_EQ(motion.to_next.vector.values()[i], to_next.vector.values()[i]);
        }
}

TEST(MotionConvention, WhatIsMissingIsToldByName) {
    const Folder folder;
    const auto refused = [&](MotionConvention convention, const std::string& words) {
        try {
            read_motion(folder / "f.exr", 0, layer_width, layer_height, convention);
            FAIL() << words;
        } catch (const core::Error& error) {
            EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
            EXPECT_NE(std::string(error.what()).find("f.exr"), std::string::npos) << error.what();
        }
    };
    refused(MotionConvention::blender, "no such file");
    write_motion(folder / "f.exr", {{"R", 1}, {"motion.u", 1}, {"motion.v", 1}});
    refused(MotionConvention::blender, "Vector.X");
    write_motion(folder / "f.exr", {{"a.Vector.X", 1}, {"b.Vector.Y", 1}, {"a.Vector.Z", 1}, {"a.Vector.W", 1}});
    refused(MotionConvention::blender, "Vector.X");
    refused(MotionConvention::nuke, "forward.u");
    write_motion(folder / "f.exr", {{"motion.u", 1}, {"motion.v", 1}}, layer_width, layer_height + 1);
    refused(MotionConvention::nuke, "64x49");
}

TEST(VectorLayers, NumbersThatAreNoneHaveNoMotion) {
    const Folder folder;
    std::vector<image::Channel> channels;
    for (const char* name : {"motion.u", "motion.v"})
        channels.push_back({name, std::vector<float>(layer_width * layer_height, 1.0f), false});
    channels[1].values[5] = std::numeric_limits<float>::quiet_NaN();
    image::write_exr(folder / "f.exr", layer_width, layer_height, channels);
    const FrameMotion motion = read_motion(folder / "f.exr", 0, layer_width, layer_height, MotionConvention::nuke);
    EXPECT_EQ(motion.to_next.kind.at(5, 0), core::PixelClass::none);
    EXPECT_EQ(motion.to_next.kind.at(6, 0), core::PixelClass::surface);
}

TEST(VectorLayers, StepsOverSeveralFramesAreJoinedAlongTheWay) {
    // Frame n moves on by n pixels to the right and came n - 1.
    const Folder folder;
    for (int n = 1; n <= 5; ++n) {
        const auto step = static_cast<float>(n);
        write_motion(folder / ("f." + std::to_string(n) + ".exr"),
                     {{"forward.u", step}, {"forward.v", 0}, {"backward.u", 1 - step}, {"backward.v", 0}});
    }
    VectorLayers layers(folder / "f.%d.exr", MotionConvention::nuke, layer_width, layer_height);
    const core::MotionField back = layers.between(5, 2), on = layers.between(2, 5);
    EXPECT_EQ(back.picture, 5);
    EXPECT_EQ(back.reference, 2);
    for (int x = 0; x < layer_width; x += 2) {
        // 5 -> 4 -> 3 -> 2: -4, -3, -2. The way ends where the steps leave the picture: the last may.
        EXPECT_EQ(back.kind.at(x, 8), x >= 7 ? core::PixelClass::surface : core::PixelClass::none) << x;
        if (x >= 7) {
            EXPECT_EQ(back.vector.at(x, 8), glm::vec2(-9, 0));
        }
        // 2 -> 3 -> 4 -> 5: 2, 3, 4.
        EXPECT_EQ(on.kind.at(x, 8), x + 5 < layer_width ? core::PixelClass::surface : core::PixelClass::none) << x;
        if (x + 5 < layer_width) {
            EXPECT_EQ(on.vector.at(x, 8), glm::vec2(9, 0));
        }
        EXPECT_EQ(back.kind.at(x, 9), core::PixelClass::none) << "nobody looks there";
    }
}

TEST(VectorLayers, AWayEndsWhereItMeetsAnotherClass) {
    const Folder folder;
    const auto file = [&](int n, float kind) {
        write_motion(
            folder / ("f." + std::to_string(n) + ".exr"),
            {{"Vector.X", 1}, {"Vector.Y", 0}, {"Vector.Z", 1}, {"Vector.W", 0}, {"render2mpeg.Class.X", kind}});
    };
    file(4, 1);
    file(3, 2);
    VectorLayers layers(folder / "f.%d.exr", MotionConvention::blender, layer_width, layer_height);
    EXPECT_EQ(layers.between(4, 3).kind.at(8, 8), core::PixelClass::surface);
    EXPECT_EQ(layers.between(4, 2).kind.at(8, 8), core::PixelClass::none) << "the sky is no part of a surface";
}

TEST(VectorLayers, MotionFilesHoldAFrameToAThirtySecondOfAPixel) {
    const Folder folder;
    core::MotionField back{7, 6, core::Plane<glm::vec2>(5, 3), {}, core::Plane<core::PixelClass>(5, 3)}, on = back;
    on.reference = 8;
    for (int x = 0; x < 5; ++x)
        for (int y = 0; y < 3; ++y) {
            back.vector.at(x, y) = {0.3f * static_cast<float>(x) - 900, static_cast<float>(y) + 0.01f};
            on.vector.at(x, y) = -back.vector.at(x, y);
            back.kind.at(x, y) = on.kind.at(x, y) = core::PixelClass::surface;
        }
    const core::Plane<core::PixelClass> kinds = back.kind;
    back.kind.at(1, 1) = core::PixelClass::none;
    on.vector.at(2, 2).x = 2000;
    write_whole(folder / "f.7.motion", image::motion_file(back, on, kinds));
    VectorLayers layers(folder / "f.%d.motion", MotionConvention::blender, 5, 3);
    const core::MotionField read = layers.between(7, 6), onward = layers.between(7, 8);
    EXPECT_EQ(read.kind.at(1, 1), core::PixelClass::none);
    EXPECT_EQ(onward.kind.at(2, 2), core::PixelClass::none) << "too long";
    for (int x = 0; x < 5; ++x) {
        EXPECT_EQ(read.kind.at(x, 0), core::PixelClass::surface);
        EXPECT_NEAR(read.vector.at(x, 0).x, back.vector.at(x, 0).x, 1.0 / 64 + 1e-4);
        EXPECT_NEAR(onward.vector.at(x, 0).y, on.vector.at(x, 0).y, 1.0 / 64 + 1e-4);
    }
    std::filesystem::resize_file(folder / "f.7.motion", 40);
    VectorLayers cut(folder / "f.%d.motion", MotionConvention::blender, 5, 3);
    EXPECT_THROW(cut.between(7, 6), core::Error);
}

TEST(VectorLayers, ASyntheticPanGivesTheEncoderItsExactVectors) {
    // Noise that moves 5.5 pixels to the left and 3 down with each frame: no predictor could guess it.
    const Folder folder;
    encoder::Settings settings;
    settings.width = layer_width;
    settings.height = layer_height;
    settings.rate = core::frame_rate_from("25");
    settings.b_pictures = 0;
    settings.quantiser = 2;
    for (const MotionConvention convention : {MotionConvention::blender, MotionConvention::nuke}) {
        encoder::Encoder encoder(settings);
        if (convention == MotionConvention::blender)
            write_motion(folder / "f.1.exr",
                         {{"Vector.X", 5.5f}, {"Vector.Y", 3}, {"Vector.Z", 5.5f}, {"Vector.W", 3}});
        else
            write_motion(folder / "f.1.exr",
                         {{"backward.u", 5.5f}, {"backward.v", 3}, {"forward.u", -5.5f}, {"forward.v", -3}});
        VectorLayers layers(folder / "f.%d.exr", convention, layer_width, layer_height);
        for (std::int64_t n = 0; n < 2; ++n) {
            core::Picture picture;
            picture.number = n;
            picture.y = core::Plane<std::uint8_t>(layer_width, layer_height);
            picture.cb = picture.cr = core::Plane<std::uint8_t>(layer_width / 2, layer_height / 2, std::uint8_t{128});
            const auto noise = [](int x, int y) {
                return core::uniform(9, static_cast<std::uint64_t>(1000 * (y / 2 + 100) + (x / 4 + 100)));
            };
            // In half pixels: frame 1 shows at (x, y) what frame 0 showed at (x + 5.5, y - 3).
            for (int y = 0; y < layer_height; ++y)
                for (int x = 0; x < layer_width; ++x) {
                    const int at = 2 * x + (n == 0 ? 0 : 11), row = n == 0 ? y : y - 3;
                    picture.y.at(x, y) = static_cast<std::uint8_t>(60 + 60 * (noise(at, row) + noise(at + 1, row)));
                }
            const encoder::PicturePlan plan = encoder.plan(n, {}, n == 0);
            std::vector<core::MotionField> motion;
            for (const std::int64_t reference : plan.references) motion.push_back(layers.between(n, reference));
            const auto coded = encoder.push(picture, plan, motion);
            ASSERT_EQ(coded.size(), 1u);
            if (n == 0) continue;
            // The middle of the picture, whose reference is inside.
            for (int row = 1; row < layer_height / 16; ++row)
                for (int column = 0; column + 1 < layer_width / 16; ++column) {
                    const encoder::MacroblockRecord& record = coded[0].macroblocks.at(column, row);
                    EXPECT_FALSE(record.intra);
                    EXPECT_EQ(record.motion_x, 11) << column << " " << row;
                    EXPECT_EQ(record.motion_y, -6) << column << " " << row;
                }
        }
    }
}

TEST(ImageSequence, NumbersOnDiskAreThoseThatThePatternWrites) {
    const Folder folder;
    EXPECT_TRUE(is_numbered("a.%04d.exr"));
    EXPECT_FALSE(is_numbered("a.exr"));
    for (const char* name :
         {"a.0003.exr", "a.0010.exr", "a.4.exr", "a.0005.png", "b.0006.exr", "a..exr", "a.x007.exr", "a.12345.exr"})
        std::ofstream(folder / name).close();
    EXPECT_EQ(numbers_on_disk(folder / "a.%04d.exr"), (std::vector<std::int64_t>{3, 10, 12345}));
    EXPECT_EQ(numbers_on_disk(folder / "a.%d.exr"), (std::vector<std::int64_t>{4, 12345}));
    EXPECT_TRUE(numbers_on_disk(folder / "none/a.%d.exr").empty());
}

}  // namespace
}  // namespace render2mpeg::app
