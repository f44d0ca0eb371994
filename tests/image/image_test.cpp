#include "image/image.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <thread>

#include "core/error.h"
#include "core/sampling.h"
#include "image/format.h"
#include "reading.h"
#include "tests/support/program.h"

namespace render2mpeg::image {
namespace {

namespace fs = std::filesystem;
using encoded::Bytes;
using support::Folder;
using test::read;
using test::refusal;

Bytes bytes_of(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

void expect_pixel(const Image& image, int x, int y, glm::vec4 value) {
    for (int c = 0; c < 4; ++c) EXPECT_NEAR(image.pixels.at(x, y)[c], value[c], 1e-6f) << x << " " << y << " " << c;
}

TEST(ReadImage, FillsInWhatAPngLacks) {
    const Image grey = read(encoded::png(2, 1, 8, 0, {{0, 51}}));
    expect_pixel(grey, 0, 0, {0, 0, 0, 1});
    expect_pixel(grey, 1, 0, {0.2f, 0.2f, 0.2f, 1});
    EXPECT_FALSE(grey.has_alpha);
    EXPECT_FALSE(grey.high_range);

    const Image grey_alpha = read(encoded::png(1, 1, 8, 4, {{51, 102}}));
    expect_pixel(grey_alpha, 0, 0, {0.2f, 0.2f, 0.2f, 0.4f});
    EXPECT_TRUE(grey_alpha.has_alpha);

    const Image one_bit = read(encoded::png(3, 2, 1, 0, {{0b10100000}, {0b01000000}}));
    for (int y = 0; y < 2; ++y)
        for (int x = 0; x < 3; ++x) expect_pixel(one_bit, x, y, glm::vec4(glm::vec3((x + y) % 2 ? 0 : 1), 1));

    const Image rgb = read(encoded::png(1, 2, 8, 2, {{255, 51, 0}, {0, 102, 255}}));
    expect_pixel(rgb, 0, 0, {1, 0.2f, 0, 1});
    expect_pixel(rgb, 0, 1, {0, 0.4f, 1, 1});
}

TEST(ReadImage, KeepsAllBitsOfDeepPngs) {
    const Image deep = read(encoded::png(1, 1, 16, 6, {{0x12, 0x34, 0x00, 0x01, 0xff, 0xff, 0x80, 0x00}}));
    expect_pixel(deep, 0, 0, {0x1234 / 65535.0f, 1 / 65535.0f, 1, 0x8000 / 65535.0f});
    EXPECT_FALSE(deep.high_range);
}

TEST(ReadImage, ResolvesPalettesWithTransparency) {
    const Image image =
        read(encoded::png(3, 1, 8, 3, {{2, 0, 1}}, {{"PLTE", {255, 0, 0, 0, 255, 0, 0, 0, 51}}, {"tRNS", {255, 102}}}));
    expect_pixel(image, 0, 0, {0, 0, 0.2f, 1});
    expect_pixel(image, 1, 0, {1, 0, 0, 1});
    expect_pixel(image, 2, 0, {0, 1, 0, 0.4f});
    EXPECT_TRUE(image.has_alpha);
}

TEST(ReadImage, NeverTouchesColoursWhateverTheFileSaysOfThem) {
    // Alpha is not multiplied in, gamma and gamut are ignored.
    Bytes gamma, gamut;
    encoded::append_big(gamma, 100000);
    for (const std::uint32_t v : {31270, 32900, 70800, 29200, 17000, 79700, 13100, 4600}) encoded::append_big(gamut, v);
    const Image image = read(encoded::png(1, 1, 8, 6, {{255, 102, 51, 51}}, {{"gAMA", gamma}, {"cHRM", gamut}}));
    expect_pixel(image, 0, 0, {1, 0.4f, 0.2f, 0.2f});
    expect_pixel(read(encoded::png(1, 1, 8, 6, {{255, 102, 51, 0}})), 0, 0, {1, 0.4f, 0.2f, 0});
}

TEST(ReadImage, ReadsJpeg) {
    const Image image = read(encoded::grey_jpeg());
    ASSERT_EQ(image.pixels.width(), 8);
    ASSERT_EQ(image.pixels.height(), 8);
    for (int i = 0; i < 8; ++i) expect_pixel(image, i, 7 - i, glm::vec4(glm::vec3(228 / 255.0f), 1));
}

TEST(ReadImage, ReadsTgaInEitherDirection) {
    const Bytes samples{1, 2, 51, 3, 4, 102};  // the first row, then the second: blue, green, red
    const Image downwards = read(encoded::tga(1, 2, 24, 0x20, samples), "a.TGA");
    expect_pixel(downwards, 0, 0, {0.2f, 2 / 255.0f, 1 / 255.0f, 1});
    expect_pixel(downwards, 0, 1, {0.4f, 4 / 255.0f, 3 / 255.0f, 1});
    const Image upwards = read(encoded::tga(1, 2, 24, 0, samples), "a.tga");
    expect_pixel(upwards, 0, 0, {0.4f, 4 / 255.0f, 3 / 255.0f, 1});
    expect_pixel(upwards, 0, 1, {0.2f, 2 / 255.0f, 1 / 255.0f, 1});
    const Image with_alpha = read(encoded::tga(1, 1, 32, 0x28, {10, 20, 30, 51}), "a.tga");
    expect_pixel(with_alpha, 0, 0, {30 / 255.0f, 20 / 255.0f, 10 / 255.0f, 0.2f});
    EXPECT_TRUE(with_alpha.has_alpha);
}

TEST(ReadImage, ReadsBmpAndPnm) {
    const Image bmp = read(encoded::bmp(1, 2, {{1, 2, 51}, {3, 4, 102}}));
    expect_pixel(bmp, 0, 1, {0.2f, 2 / 255.0f, 1 / 255.0f, 1});
    expect_pixel(bmp, 0, 0, {0.4f, 4 / 255.0f, 3 / 255.0f, 1});
    Bytes pnm;
    encoded::append(pnm, std::string("P6\n2 1\n255\n"));
    encoded::append(pnm, Bytes{51, 0, 255, 0, 102, 0});
    expect_pixel(read(pnm), 0, 0, {0.2f, 0, 1, 1});
    expect_pixel(read(pnm), 1, 0, {0, 0.4f, 0, 1});
}

TEST(ReadImage, ReadsRadianceFilesAsFloats) {
    const Image sun = read(encoded::hdr(2, 1, {128, 64, 0, 148, 0, 0, 0, 0}));
    expect_pixel(sun, 0, 0, {524288, 262144, 0, 1});
    expect_pixel(sun, 1, 0, {0, 0, 0, 1});
    EXPECT_TRUE(sun.high_range);
}

TEST(ReadImage, ReadsWhatItWrote) {
    const Folder folder;
    std::vector<Channel> channels;
    for (const char* name : {"A", "B", "G", "R", "Z"}) {
        Channel channel{name, std::vector<float>(15), std::string(name) == "A"};
        for (std::size_t i = 0; i < 15; ++i)
            channel.values[i] = static_cast<float>(i) * 1e6f + static_cast<float>(*name) / 128.0f;
        channels.push_back(channel);
    }
    channels[0].values.assign(15, 0.5f);
    write_exr(folder / "a.exr", 5, 3, channels);
    const Image image = read_image(folder / "a.exr", {}, "a.exr");
    ASSERT_EQ(image.pixels.width(), 5);
    EXPECT_TRUE(image.high_range && image.has_alpha);
    for (int i = 0; i < 15; ++i) {
        const auto value = [&](int c) {
            return channels[static_cast<std::size_t>(c)].values[static_cast<std::size_t>(i)];
        };
        EXPECT_EQ(image.pixels.values()[static_cast<std::size_t>(i)], glm::vec4(value(3), value(2), value(1), 0.5f));
    }

    std::vector<unsigned char> rgb(7 * 4 * 3);
    for (std::size_t i = 0; i < rgb.size(); ++i) rgb[i] = static_cast<unsigned char>(i * 3);
    write_png(folder / "a.png", 7, 4, rgb);
    const Image png = read_image(folder / "a.png", {}, "a.png");
    for (std::size_t i = 0; i < rgb.size(); ++i)
        EXPECT_EQ(std::lround(png.pixels.values()[i / 3][static_cast<int>(i % 3)] * 255), rgb[i]);
}

TEST(Image, APngSaysThatItsCodesAreSrgb) {
    const Folder folder;
    write_png(folder / "a.png", 2, 1, std::vector<unsigned char>(6, 39));
    std::ifstream file(folder / "a.png", std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    // Chunk sRGB: a length of 1, its name, the rendering intent. It stands before the pixels. [PNG, 11.3.3.5]
    const std::size_t at = bytes.find("sRGB");
    ASSERT_NE(at, std::string::npos);
    EXPECT_EQ(bytes.substr(at - 4, 4), std::string("\0\0\0\1", 4));
    EXPECT_LE(bytes[at + 4], 3);
    EXPECT_LT(at, bytes.find("IDAT"));
    // gAMA says 1/2.2 in 100,000ths. [PNG, 11.3.3.2]
    const std::size_t gamma = bytes.find("gAMA");
    ASSERT_NE(gamma, std::string::npos);
    EXPECT_EQ(bytes.substr(gamma + 4, 4), std::string("\0\0\xb1\x8f", 4));
}

TEST(PixelAspect, StandsInTheFilesThatAreWritten) {
    const Folder folder;
    const std::vector<Channel> channels{{"R", std::vector<float>(6, 1.0f), false}};
    const std::vector<unsigned char> rgb(18, 100);
    for (const float aspect : {1.0f, 64.0f / 45.0f, 8.0f / 9.0f}) {
        write_exr(folder / "a.exr", 3, 2, channels, {aspect});
        EXPECT_EQ(read_exr(folder / "a.exr", [](const std::string&) { return true; }).pixel_aspect, aspect);
        EXPECT_EQ(read_image(folder / "a.exr", {}, "a.exr").pixel_aspect, aspect);

        // pHYs: pixels per unit along x and y, 4 bytes each; the unit 0 is none.
        write_png(folder / "a.png", 3, 2, rgb, aspect);
        std::ifstream file(folder / "a.png", std::ios::binary);
        const std::string bytes{std::istreambuf_iterator<char>(file), {}};
        const std::size_t at = bytes.find("pHYs");
        ASSERT_EQ(at == std::string::npos, aspect == 1.0f);
        if (aspect == 1.0f) continue;
        const auto number = [&](std::size_t from) {
            double value = 0;
            for (std::size_t i = from; i < from + 4; ++i) value = 256 * value + static_cast<unsigned char>(bytes[i]);
            return value;
        };
        EXPECT_NEAR(number(at + 8) / number(at + 4), aspect, 1e-4);
        EXPECT_EQ(bytes[at + 12], 0);
        EXPECT_NEAR(read_image(folder / "a.png", {}, "a.png").pixel_aspect, aspect, 1e-4);
    }
}

TEST(ReadImage, TakesColoursOfAnExrUnderAnyName) {
    const Folder folder;
    const auto written = [&](std::initializer_list<const char*> names) {
        std::vector<Channel> channels;
        float value = 1;
        for (const char* name : names) channels.push_back({name, {value++}, false});
        write_exr(folder / "a.exr", 1, 1, channels);
        return read_image(folder / "a.exr", {}, "a.exr").pixels.at(0, 0);
    };
    EXPECT_EQ(written({"R", "G", "B"}), glm::vec4(1, 2, 3, 1));
    EXPECT_EQ(written({"Y"}), glm::vec4(1, 1, 1, 1));
    EXPECT_EQ(written({"Y", "A"}), glm::vec4(1, 1, 1, 2));
    EXPECT_EQ(written({"depth.Z", "sky.G", "sky.R", "sky.B"}), glm::vec4(3, 2, 4, 1));
    EXPECT_EQ(written({"sky.G", "sky.R", "sky.B", "R", "G", "B"}), glm::vec4(4, 5, 6, 1));
    EXPECT_EQ(written({"red", "green", "blue", "alpha"}), glm::vec4(1, 2, 3, 4));
    EXPECT_EQ(written({"density"}), glm::vec4(1, 1, 1, 1));
}

TEST(ReadImage, TruncatedFilesAreRefusedByName) {
    const Folder folder;
    std::vector<Channel> channels{{"R", std::vector<float>(4000), false}};
    for (std::size_t i = 0; i < 4000; ++i) channels[0].values[i] = core::uniform(6, i);
    write_exr(folder / "a.exr", 40, 100, channels);
    const Bytes rows(300, 77);
    const std::pair<Bytes, const char*> files[] = {{encoded::png(100, 3, 8, 2, {rows, rows, rows}), "a.png"},
                                                   {encoded::grey_jpeg(), "a.jpg"},
                                                   {encoded::bmp(100, 2, {rows, rows}), "a.bmp"},
                                                   {encoded::hdr(25, 3, rows), "a.hdr"},
                                                   {encoded::tga(100, 1, 24, 0x20, rows), "a.tga"},
                                                   {bytes_of(folder / "a.exr"), "a.exr"}};
    for (const auto& [bytes, name] : files) {
        ASSERT_EQ(refusal(bytes, name), "") << name;
        for (std::size_t size = 1; size + 20 < bytes.size(); size += 1 + size / 5) {
            const std::string what =
                refusal(Bytes(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)), name);
            EXPECT_NE(what.find(name), std::string::npos) << name << " cut to " << size << ": " << what;
            EXPECT_EQ(what.find('\n'), std::string::npos);
        }
    }
}

TEST(ReadImage, ManyThreadsMayReadAtOnce) {
    std::vector<std::thread> threads;
    std::atomic<int> right = 0;
    for (int t = 0; t < 4; ++t)
        threads.emplace_back([&, t] {
            for (int i = 0; i < 50; ++i) {
                const auto code = static_cast<std::uint8_t>(50 * t + i);
                const Image png = read(encoded::png(1, 1, 8, 0, {{code}})), jpeg = read(encoded::grey_jpeg());
                const bool png_is_right = std::lround(png.pixels.at(0, 0).x * 255) == code;
                if (png_is_right && jpeg.pixels.width() == 8 && refusal({1, 2, 3}) != "") ++right;
            }
        });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(right, 200);
}

TEST(ReadImage, DamagedFilesNeverCrash) {
    const Bytes rows(300, 77);
    const std::pair<Bytes, const char*> files[] = {
        {encoded::png(100, 3, 8, 2, {rows, rows, rows}), "a.png"},
        {encoded::png(3, 1, 8, 3, {{2, 0, 1}}, {{"PLTE", {255, 0, 0, 0, 255, 0}}}), "a.png"},
        {encoded::grey_jpeg(), "a.jpg"},
        {encoded::bmp(100, 2, {rows, rows}), "a.bmp"},
        {encoded::hdr(25, 3, rows), "a.hdr"},
        {encoded::tga(100, 1, 24, 0x20, rows), "a.tga"}};
    for (const auto& [bytes, name] : files)
        for (std::uint64_t i = 0; i < 60; ++i) {
            Bytes damaged = bytes;
            const auto at = static_cast<std::size_t>(core::uniform(5, i, 1) *
                                                     static_cast<float>(std::min<std::size_t>(bytes.size(), 80)));
            damaged[at] = static_cast<std::uint8_t>(core::uniform(5, i, 2) * 256);
            const std::string what = refusal(damaged, name);
            EXPECT_TRUE(what.empty() || what.find(name) != std::string::npos) << what;
        }
}

TEST(ReadImage, BombsAreRefusedByTheirHeader) {
    EXPECT_NE(refusal(encoded::png(20000, 20000, 8, 6, {{0}})).find("limit"), std::string::npos);
    EXPECT_NE(refusal(encoded::png(16384, 8192, 8, 6, {{0}})).find("too short"), std::string::npos);
    EXPECT_NE(refusal(encoded::hdr(2000000, 2000000, {1, 2, 3, 4}), "a.hdr"), "");
    EXPECT_NE(refusal(encoded::tga(65535, 65535, 24, 0, {1, 2, 3}), "a.tga").find("limit"), std::string::npos);
    EXPECT_NE(refusal(encoded::bmp(0x7fffffff, 0x7fffffff, {{1, 2, 3}}), "a.bmp"), "");
    EXPECT_NE(refusal(encoded::hdr(11000, 11000, Bytes(1000, 7)), "a.hdr").find("too short"), std::string::npos);
    EXPECT_NE(refusal(encoded::png(0, 5, 8, 2, {})), "");
}

TEST(ReadImage, PixelsThatFewBytesStandForAreBounded) {
    // Rows of one colour are packed a thousandfold: 16384 x 16384 of them are a file of less than a megabyte.
    const std::string what = refusal(encoded::png(16384, 16384, 1, 0, {{0}}), "bomb.png");
    EXPECT_NE(what.find("bomb.png: 16384 x 16384 pixels: the limit is 134217728 in all"), std::string::npos) << what;
}

TEST(ReadImage, PackedBmpFilesAreRefused) {
    Bytes file = encoded::bmp(2, 2, {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {10, 11, 12}});
    EXPECT_EQ(refusal(file, "a.bmp"), "");
    file.at(30) = 2;  // runs of 4 bits in a file of 24
    EXPECT_NE(refusal(file, "a.bmp").find("packed"), std::string::npos);
}

TEST(ReadImage, WhatIsNoImageIsRefused) {
    const Folder folder;
    const auto message = [](const fs::path& path) -> std::string {
        try {
            read_image(path, {}, path.filename().string());
        } catch (const core::Error& error) {
            return error.what();
        }
        return "";
    };
    EXPECT_EQ(message(folder / "none.png"), "reading none.png: no such file");
    EXPECT_NE(message(folder.path()), "");
    std::ofstream(folder / "empty.png").close();
    EXPECT_NE(message(folder / "empty.png").find("empty"), std::string::npos);
    std::ofstream(folder / "text.png") << "this is not an image, whatever its name says";
    EXPECT_NE(message(folder / "text.png").find("known kind"), std::string::npos);
    EXPECT_EQ(message("/dev/zero"), "reading zero: it is a device; plain files alone are read");
}

TEST(WriteImage, GivesTheSameBytesEachTimeAndLeavesNoTemporaryFile) {
    const Folder folder;
    const std::vector<Channel> forward{{"R", {1, 2}, true}, {"Z", {3, 4}, false}}, backward{forward[1], forward[0]};
    write_exr(folder / "a.exr", 2, 1, forward);
    write_exr(folder / "b.exr", 2, 1, backward);
    EXPECT_EQ(bytes_of(folder / "a.exr"), bytes_of(folder / "b.exr"));
    const std::vector<unsigned char> rgb{1, 2, 3, 4, 5, 6};
    write_png(folder / "a.png", 2, 1, rgb);
    write_png(folder / "b.png", 2, 1, rgb);
    EXPECT_EQ(bytes_of(folder / "a.png"), bytes_of(folder / "b.png"));
    EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 4);
}

TEST(WriteImage, SaysWhereItCannotWrite) {
    const std::vector<unsigned char> rgb{1, 2, 3};
    try {
        write_png("/nowhere/at/all.png", 1, 1, rgb);
        FAIL();
    } catch (const core::Error& error) {
        EXPECT_NE(std::string(error.what()).find("writing /nowhere/at/all.png"), std::string::npos);
    }
    EXPECT_THROW(write_png("/tmp/never.png", 2, 1, rgb), core::ContractViolation);
    EXPECT_THROW(write_exr("/tmp/never.exr", 1, 1, std::vector<Channel>{{"R", {1}, false}, {"R", {1}, false}}),
                 core::ContractViolation);
}

/// Whether this process has loaded a library.
bool is_loaded(const std::string& library) {
    std::ifstream maps("/proc/self/maps");
    for (std::string line; std::getline(maps, line);)
        if (line.find(library) != std::string::npos) return true;
    return false;
}

TEST(Module, IsNotOpenedBeforeAnImageIs) {
    // Each suite runs in a process of its own under ctest; in one process, others may have been first.
    if (is_loaded("libOpenImageIO")) GTEST_SKIP() << "another test has opened it";
    EXPECT_NE(refusal({1, 2, 3, 4}), "");
    EXPECT_NE(refusal({0xff, 0xd8, 0xff}), "");
    read(encoded::grey_jpeg());
    EXPECT_FALSE(is_loaded("libOpenImageIO")) << "libjpeg does";
    EXPECT_FALSE(is_loaded("render2mpeg_exr_module"));
    const std::filesystem::path exr = std::filesystem::temp_directory_path() / "render2mpeg_module_test.exr";
    write_exr(exr, 1, 1, std::vector<Channel>{{"Y", {1.0f}, false}});
    read_exr(exr, [](const std::string&) { return true; });
    std::filesystem::remove(exr);
    EXPECT_TRUE(is_loaded("render2mpeg_exr_module"));
    EXPECT_FALSE(is_loaded("libOpenImageIO")) << "OpenEXR does";
    EXPECT_FALSE(is_loaded("render2mpeg_image_module"));
    read(encoded::bmp(1, 1, {{1, 2, 3}}));
    EXPECT_TRUE(is_loaded("libOpenImageIO"));
}

TEST(ChannelChoice, FallsBackToTheOrderOfUnknownNames) {
    EXPECT_EQ(choose_channels({"a1", "a2", "a3"}, -1).channel, (std::array{0, 1, 2, -1}));
    EXPECT_EQ(choose_channels({"x", "first", "second", "third"}, 0).channel, (std::array{1, 2, 3, 0}));
    EXPECT_EQ(choose_channels({"x", "y1"}, 1).channel, (std::array{0, -1, -1, 1}));
    EXPECT_EQ(choose_channels({"ViewLayer.Combined.A", "ViewLayer.Combined.B", "ViewLayer.Combined.G",
                               "ViewLayer.Combined.R", "ViewLayer.Emit.B", "ViewLayer.Emit.G", "ViewLayer.Emit.R"},
                              -1)
                  .channel,
              (std::array{3, 2, 1, 0}));
    EXPECT_TRUE(choose_channels({"R", "G", "B", "A"}, 3).consecutive());
    EXPECT_FALSE(choose_channels({"A", "B", "G", "R"}, 0).consecutive());
}

}  // namespace
}  // namespace render2mpeg::image
