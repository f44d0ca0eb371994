#include "image/png_jpeg.h"

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/module.h"
#include "image/encoded.h"
#include "image/module/codec.h"
#include "support/program.h"

/// PNG and JPEG files that are read without OpenImageIO are read as it would.
namespace render2mpeg::image {
namespace {

using encoded::Bytes;

const Codec& open_image_io() {
    return *core::module_function<const Codec*()>("image", "render2mpeg_image_codec")();
}

/// Holds what is read of a file against OpenImageIO's reading of it.
void expect_alike(const Bytes& file, Format format, const std::string& what) {
    const std::span<const std::byte> bytes = std::as_bytes(std::span(file));
    const std::optional<StoredImage> read = decode_png_or_jpeg(bytes, format, "a");
    ASSERT_TRUE(read) << what;
    const Image image = open_image_io().decode(bytes, format, "a");
    ASSERT_EQ(read->width, image.pixels.width()) << what;
    ASSERT_EQ(read->height, image.pixels.height()) << what;
    EXPECT_EQ(read->has_alpha, image.has_alpha) << what;
    EXPECT_EQ(read->pixel_aspect, image.pixel_aspect) << what;
    EXPECT_FALSE(read->high_range);
    for (int y = 0; y < read->height; ++y)
        for (int x = 0; x < read->width; ++x)
            ASSERT_EQ(read->at(x, y), image.pixels.at(x, y)) << what << " at " << x << ", " << y;
    const std::optional<ImageHeader> header = header_of_png_or_jpeg(bytes, format, "a");
    ASSERT_TRUE(header);
    EXPECT_EQ(header->width, read->width);
    EXPECT_EQ(header->height, read->height);
    EXPECT_TRUE(header->bytes);
}

Bytes counting(std::size_t count) {
    Bytes bytes(count);
    for (std::size_t i = 0; i < count; ++i) bytes[i] = static_cast<std::uint8_t>(37 * i + i / 7);
    return bytes;
}

TEST(PngOrJpeg, PngsOfEveryKindAreReadAsByOpenImageIO) {
    for (const auto& [bits, type, bytes] :
         {std::tuple(8, 0, 16), std::tuple(8, 2, 48), std::tuple(8, 4, 32), std::tuple(8, 6, 64), std::tuple(1, 0, 2),
          std::tuple(2, 0, 4), std::tuple(4, 0, 8)}) {
        const auto row = static_cast<std::size_t>(bytes);
        const Bytes all = counting(2 * row);
        const auto middle = all.begin() + static_cast<std::ptrdiff_t>(row);
        expect_alike(encoded::png(16, 2, bits, type, {Bytes(all.begin(), middle), Bytes(middle, all.end())}),
                     Format::png, "type " + std::to_string(type) + ", bits " + std::to_string(bits));
    }
    const encoded::Chunk palette{"PLTE", {255, 0, 3, 0, 255, 9, 1, 2, 3}};
    expect_alike(encoded::png(3, 1, 8, 3, {{2, 0, 1}}, {palette}), Format::png, "palette");
    expect_alike(encoded::png(3, 1, 8, 3, {{2, 0, 1}}, {palette, {"tRNS", {7, 255, 128}}}), Format::png,
                 "palette with alpha");
    expect_alike(encoded::png(2, 1, 8, 2, {{1, 2, 3, 4, 5, 6}}, {{"tRNS", {0, 1, 0, 2, 0, 3}}}), Format::png,
                 "one colour is transparent");
    expect_alike(encoded::png(2, 1, 8, 0, {{1, 9}}, {{"tRNS", {0, 9}}}), Format::png, "one grey is transparent");
    expect_alike(encoded::png(2, 1, 8, 0, {{1, 9}}, {{"pHYs", {0, 0, 0, 100, 0, 0, 0, 150, 0}}}), Format::png,
                 "pixels that are no squares");
}

TEST(PngOrJpeg, JpegsAreReadAsByOpenImageIOSlow) {
    expect_alike(encoded::grey_jpeg(), Format::jpeg, "grey");
    const support::Folder folder;
    for (const char* how : {"", " --compression jpeg:30", " --attrib jpeg:subsampling 4:2:0",
                            " --attrib jpeg:subsampling 4:4:4 --attrib jpeg:progressive 1"}) {
        const support::Outcome made =
            support::run("oiiotool --pattern noise:type=uniform:min=0:max=1 37x29 3 -d uint8" + std::string(how) +
                         " -o " + (folder / "a.jpg").string());
        ASSERT_EQ(made.status, 0) << made.output;
        std::ifstream file(folder / "a.jpg", std::ios::binary);
        expect_alike({std::istreambuf_iterator<char>(file), {}}, Format::jpeg, how);
    }
}

TEST(PngOrJpeg, OtherKindsAreLeftToOpenImageIO) {
    const Bytes deep = encoded::png(1, 1, 16, 0, {{0x12, 0x34}});
    EXPECT_FALSE(decode_png_or_jpeg(std::as_bytes(std::span(deep)), Format::png, "a"));
    EXPECT_FALSE(decode_png_or_jpeg(std::as_bytes(std::span(deep)), Format::tga, "a"));
}

}  // namespace
}  // namespace render2mpeg::image
