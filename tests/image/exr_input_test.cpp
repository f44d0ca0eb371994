#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <ImfTiledOutputFile.h>
#include <gtest/gtest.h>
#include <half.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <vector>

#include "core/error.h"
#include "core/sampling.h"
#include "image/image.h"
#include "support/program.h"

namespace render2mpeg::image {
namespace {

using support::Folder;

/// Every channel's value at (x, y) is `base` + x + 100 y.
struct Written {
    std::string name;
    float base;
};

/// A file as other programs write it: windows of their own, tiles, any channels.
void write(const std::filesystem::path& path, Imf::Header header, const std::vector<Written>& channels,
           bool tiled = false) {
    const auto data = header.dataWindow();
    const auto width = static_cast<std::size_t>(data.max.x - data.min.x + 1);
    const auto height = static_cast<std::size_t>(data.max.y - data.min.y + 1);
    std::vector<std::vector<float>> values;
    Imf::FrameBuffer frame;
    values.reserve(channels.size());
    for (const Written& channel : channels) {
        header.channels().insert(channel.name, Imf::Channel(Imf::FLOAT));
        std::vector<float>& plane = values.emplace_back();
        for (std::size_t y = 0; y < height; ++y)
            for (std::size_t x = 0; x < width; ++x)
                plane.push_back(channel.base + static_cast<float>(data.min.x) + static_cast<float>(x) +
                                100.0f * (static_cast<float>(data.min.y) + static_cast<float>(y)));
        frame.insert(channel.name,
                     Imf::Slice::Make(Imf::FLOAT, plane.data(), data, sizeof(float), sizeof(float) * width));
    }
    if (tiled) {
        header.setTileDescription(Imf::TileDescription(4, 4, Imf::ONE_LEVEL));
        Imf::TiledOutputFile file(path.c_str(), header);
        file.setFrameBuffer(frame);
        file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
    } else {
        Imf::OutputFile file(path.c_str(), header);
        file.setFrameBuffer(frame);
        file.writePixels(static_cast<int>(height));
    }
}

Imf::Header header(int display_width, int display_height, int x0, int y0, int x1, int y1) {
    using Box = std::remove_cvref_t<decltype(Imf::Header().dataWindow())>;
    using Point = decltype(Box::min);
    return Imf::Header(Box(Point(0, 0), Point(display_width - 1, display_height - 1)),
                       Box(Point(x0, y0), Point(x1, y1)));
}

bool any(const std::string&) {
    return true;
}

TEST(ExrInput, GivesTheWantedChannelsOnly) {
    const Folder folder;
    for (const bool tiled : {false, true}) {
        write(folder / "f.exr", header(9, 7, 0, 0, 8, 6), {{"a.u", 1000}, {"a.v", 2000}, {"b", 3000}}, tiled);
        const ExrChannels read = read_exr(folder / "f.exr", [](const std::string& name) { return name[0] == 'a'; });
        EXPECT_EQ(read.width, 9);
        EXPECT_EQ(read.height, 7);
        ASSERT_EQ(read.channels.size(), 2u);
        EXPECT_EQ(read.channels[0].name, "a.u");
        EXPECT_FALSE(read.channels[0].half);
        for (std::size_t i = 0; i < 63; ++i)
            EXPECT_EQ(read.channels[1].values[i], 2000.0f + static_cast<float>(i % 9 + 100 * (i / 9)));
        EXPECT_TRUE(read_exr(folder / "f.exr", [](const std::string&) { return false; }).channels.empty());
    }
}

TEST(ExrInput, CoversTheDisplayWindowWhereverTheDataLie) {
    // Compositors store only what is not empty, and what hangs over the edges.
    const Folder folder;
    for (const auto& [x0, y0, x1, y1] :
         {std::tuple{2, 1, 4, 3}, {-3, -2, 12, 9}, {5, -1, 20, 2}, {-9, -9, -2, -2}, {0, 0, 7, 5}}) {
        write(folder / "f.exr", header(8, 6, x0, y0, x1, y1), {{"Z", 5000}});
        const ExrChannels read = read_exr(folder / "f.exr", any);
        ASSERT_EQ(read.width, 8);
        ASSERT_EQ(read.height, 6);
        ASSERT_EQ(read.channels[0].values.size(), 48u);
        for (int y = 0; y < 6; ++y)
            for (int x = 0; x < 8; ++x) {
                const bool inside = x >= x0 && x <= x1 && y >= y0 && y <= y1;
                EXPECT_EQ(read.channels[0].values[static_cast<std::size_t>(8 * y + x)],
                          inside ? 5000.0f + static_cast<float>(x + 100 * y) : 0.0f);
            }
    }
}

TEST(ExrInput, ReadsBackWhatIsWritten) {
    const Folder folder;
    const std::vector<Channel> channels{{"one", {1, 2, 3, 4, 5, 6}, false}, {"two", {0.5f, 0, 0, 0, 0, -1}, true}};
    write_exr(folder / "f.exr", 3, 2, channels);
    const ExrChannels read = read_exr(folder / "f.exr", any);
    ASSERT_EQ(read.channels.size(), 2u);
    for (std::size_t c = 0; c < 2; ++c) {
        EXPECT_EQ(read.channels[c].name, channels[c].name);
        EXPECT_EQ(read.channels[c].values, channels[c].values);
        EXPECT_EQ(read.channels[c].half, channels[c].half);
    }
}

/// Halves, floats and whole numbers that OpenEXR packed: smooth ones, and others that no packing makes smaller, so that
/// they lie in the file as they are.
TEST(ExrInput, UnpacksWhatOpenExrPacked) {
    const Folder folder;
    constexpr int width = 37, height = 50, count = width * height;
    for (const Imf::Compression packing : {Imf::ZIP_COMPRESSION, Imf::ZIPS_COMPRESSION, Imf::PIZ_COMPRESSION})
        for (const bool smooth : {true, false}) {
            std::vector<half> halves;
            std::vector<float> floats;
            std::vector<unsigned> numbers;
            for (unsigned i = 0; i < count; ++i) {
                const unsigned die = smooth ? i / 7 : static_cast<unsigned>(core::uniform(1, 2, i) * 4294967040.0);
                numbers.push_back(die);
                halves.emplace_back();
                halves.back().setBits(static_cast<std::uint16_t>(die & 0x7bffu));  // finite
                floats.push_back(std::bit_cast<float>(die & 0x7f7fffffu));
            }
            Imf::Header head(width, height);
            head.compression() = packing;
            Imf::FrameBuffer frame;
            const auto add = [&](const char* name, Imf::PixelType type, auto& values) {
                head.channels().insert(name, Imf::Channel(type));
                frame.insert(name, Imf::Slice(type, reinterpret_cast<char*>(values.data()), sizeof(values[0]),
                                              width * sizeof(values[0])));
            };
            add("f", Imf::FLOAT, floats);
            add("h", Imf::HALF, halves);
            add("n", Imf::UINT, numbers);
            {
                Imf::OutputFile file((folder / "f.exr").c_str(), head);
                file.setFrameBuffer(frame);
                file.writePixels(height);
            }
            const ExrChannels read = read_exr(folder / "f.exr", any);
            ASSERT_EQ(read.channels.size(), 3u);
            for (std::size_t i = 0; i < count; ++i) {
                ASSERT_EQ(read.channels[0].values[i], floats[i]) << packing << ", " << i;
                ASSERT_EQ(read.channels[1].values[i], static_cast<float>(halves[i])) << packing << ", " << i;
                ASSERT_EQ(read.channels[2].values[i], static_cast<float>(numbers[i])) << packing << ", " << i;
            }
        }
}

TEST(ExrInput, DamageIsToldInOneLine) {
    const Folder folder;
    const auto refused = [&](const std::string& words) {
        try {
            read_exr(folder / "f.exr", any);
            FAIL() << words;
        } catch (const core::Error& error) {
            const std::string line = error.what();
            EXPECT_NE(line.find("f.exr"), std::string::npos) << line;
            EXPECT_NE(line.find(words), std::string::npos) << line;
            EXPECT_EQ(line.find('\n'), std::string::npos) << line;
        }
    };
    refused("no such file");
    std::ofstream(folder / "f.exr") << "P6 1 1 255 xyz";
    refused("not an OpenEXR file");

    write(folder / "f.exr", header(40, 30, 0, 0, 39, 29), {{"Z", 0}});
    const std::string whole = support::contents(folder / "f.exr");
    for (std::size_t keep = 4; keep < whole.size(); keep += 37) {
        std::ofstream(folder / "f.exr", std::ios::binary) << whole.substr(0, keep);
        refused("f.exr");
    }
    // A header that claims what no such file could hold.
    write(folder / "f.exr", header(1 << 15, 1 << 15, 0, 0, 3, 3), {{"Z", 0}});
    refused("pixels");
}

TEST(ExrInput, AttributesThatAreLargerThanTheFileAreRefusedBeforeThereIsRoomForThem) {
    const Folder folder;
    Imf::Header described = header(4, 3, 0, 0, 3, 2);
    described.insert("comments", Imf::StringAttribute("who made it"));
    write(folder / "f.exr", described, {{"Z", 0}});
    std::string bytes = support::contents(folder / "f.exr");
    const std::size_t size = bytes.find("string") + 7;
    ASSERT_LT(size, bytes.size());
    bytes.replace(size, 4, "\xff\xff\xff\x7f");
    std::ofstream(folder / "f.exr", std::ios::binary) << bytes;
    const auto expect_refused = [](const auto& read) {
        try {
            read();
            FAIL();
        } catch (const core::Error& error) {
            EXPECT_NE(std::string(error.what()).find("\"comments\" says 2147483647 bytes"), std::string::npos)
                << error.what();
        }
    };
    expect_refused([&] { read_exr(folder / "f.exr", any); });
    expect_refused([&] { read_image(folder / "f.exr", {}, "f.exr"); });
    expect_refused([&] { read_image_header(folder / "f.exr", {}, "f.exr"); });
}

TEST(ExrInput, FilesThatAreTooShortForTheirPackingAreRefusedByTheirHeader) {
    const Folder folder;
    Imf::Header plain = header(64, 64, 0, 0, 63, 63);
    plain.compression() = Imf::NO_COMPRESSION;
    write(folder / "f.exr", plain, {{"Z", 0}});
    EXPECT_EQ(read_exr(folder / "f.exr", any).width, 64);
    const std::string bytes = support::contents(folder / "f.exr");
    std::ofstream(folder / "f.exr", std::ios::binary) << bytes.substr(0, bytes.size() / 2);
    try {
        read_exr(folder / "f.exr", any);
        FAIL();
    } catch (const core::Error& error) {
        EXPECT_NE(std::string(error.what()).find("too short"), std::string::npos) << error.what();
    }
}

TEST(ExrFrame, HasTheColoursOfTheImageAndWhatElseIsWanted) {
    const Folder folder;
    const std::filesystem::path file = folder / "frame.exr";
    const auto channel = [](const std::string& name, float first) {
        return Channel{name, {first, first + 1, first + 2, first + 3, first + 4, first + 5}, false};
    };
    for (const auto& channels :
         {std::vector{channel("L.Combined.A", 0), channel("L.Combined.B", 1), channel("L.Combined.G", 2),
                      channel("L.Combined.R", 3), channel("L.Vector.X", 4), channel("L.Depth.Z", 5)},
          {channel("R", 1), channel("G", 2), channel("B", 3), channel("L.Vector.X", 7)},
          {channel("Y", 1), channel("L.Vector.X", 7)}}) {
        write_exr(file, 3, 2, channels);
        const ExrFrame frame = read_exr_frame(file, [](const std::string& name) { return name == "L.Vector.X"; });
        const Image image = read_image(file, {}, "frame");
        EXPECT_EQ(frame.image.pixels.width(), 3);
        EXPECT_TRUE(std::ranges::equal(frame.image.pixels.values(), image.pixels.values())) << channels[0].name;
        EXPECT_EQ(frame.image.has_alpha, image.has_alpha);
        EXPECT_EQ(frame.image.high_range, image.high_range);
        ASSERT_EQ(frame.others.channels.size(), 1u);
        EXPECT_EQ(frame.others.channels[0].values[5], channels[0].name == "L.Combined.A" ? 9 : 12);
    }
}

}  // namespace
}  // namespace render2mpeg::image
