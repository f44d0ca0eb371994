#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "av/coded_film.h"
#include "core/error.h"
#include "encoder/av/access_unit.h"
#include "encoder/av/coders.h"
#include "encoder/av/gif_palette.h"
#include "support/program.h"

/// Films of GIF.
namespace render2mpeg::test {
namespace {

encoder::Settings gif_of(int width, int height, const char* rate = "25") {
    encoder::Settings settings;
    settings.codec = encoder::Codec::gif;
    settings.width = width;
    settings.height = height;
    settings.rate = core::frame_rate_from(rate);
    settings.b_pictures = 0;
    return settings;
}

/// A slow gradient in three colours; a noisy square moves over it where `moves`.
core::Picture gradient(int width, int height, std::int64_t number, bool moves) {
    core::Picture p;
    p.number = number;
    p.y = core::Plane<std::uint8_t>(width, height);
    p.cb = core::Plane<std::uint8_t>((width + 1) / 2, (height + 1) / 2, 120);
    p.cr = p.cb;
    p.luma = p.exact_cb = p.exact_cr = core::Plane<float>(width, height);
    std::uint32_t random = 7 + static_cast<std::uint32_t>(number);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            random = random * 1664525u + 1013904223u;
            const std::int64_t left = 2 * number;
            const bool inside = moves && x >= left && x < left + 12 && y >= 4 && y < 16;
            const auto noise = static_cast<float>(random >> 26);
            p.luma.at(x, y) = inside ? 60 + noise : 90 + 0.4f * static_cast<float>(x + y);
            p.exact_cb.at(x, y) = inside ? 100 + noise : 128 + 0.1f * static_cast<float>(x);
            p.exact_cr.at(x, y) = 128 - 0.1f * static_cast<float>(y);
            p.y.at(x, y) = static_cast<std::uint8_t>(std::lround(p.luma.at(x, y)));
        }
    return p;
}

using CodedPictures = std::vector<encoder::CodedPicture>;

CodedPictures coded(encoder::Coder& coder, const encoder::Settings& s, int first, int last, bool moves) {
    CodedPictures all;
    for (int n = first; n <= last; ++n) {
        const encoder::PicturePlan plan = coder.plan(n, {}, n == first);
        for (encoder::CodedPicture& picture : coder.push(gradient(s.width, s.height, n, moves), plan, {}))
            all.push_back(std::move(picture));
    }
    return all;
}

TEST(Gif, DecodesToWhatItsCoderSays) {
    const Folder folder;
    for (const auto& [width, height] : {std::pair(96, 64), std::pair(2, 2), std::pair(62, 34)}) {
        const encoder::Settings s = gif_of(width, height);
        const auto coder = av::make_coder(s);
        CodedPictures pictures = coded(*coder, s, 0, 9, true);
        for (encoder::CodedPicture& more : coded(*coder, s, 10, 15, true)) pictures.push_back(std::move(more));
        CodedFilm film{s, {}, 0, {}};
        for (const encoder::CodedPicture& c : pictures)
            film.pictures.push_back({c.bytes, c.plan.number, c.plan.starts_gop});
        std::size_t n = 0;
        av::decode(film.mux(folder / "film.gif"), [&](const core::Picture& p) {
            ASSERT_LT(n, pictures.size());
            const core::Picture& told = pictures[n].reconstruction;
            EXPECT_TRUE(p.y == told.y && p.cb == told.cb && p.cr == told.cr) << width << " picture " << n;
            ++n;
        });
        EXPECT_EQ(n, pictures.size());
    }
}

TEST(Gif, IsDitheredAboutWhatIsWanted) {
    const encoder::Settings s = gif_of(128, 96);
    const auto coder = av::make_coder(s);
    const core::Picture wanted = gradient(s.width, s.height, 0, false);
    const core::Picture shown = coded(*coder, s, 0, 0, false).front().reconstruction;
    double most = 0, sum = 0;
    for (int y = 0; y < 96; y += 8)
        for (int x = 0; x < 128; x += 8) {
            double error = 0;
            for (int i = 0; i < 64; ++i) {
                const int column = x + i % 8, row = y + i / 8;
                const double one = shown.y.at(column, row) - static_cast<double>(wanted.luma.at(column, row));
                error += one / 64;
                sum += std::abs(one) / (128 * 96);
            }
            most = std::max(most, std::abs(error));
        }
    EXPECT_LT(most, 1.0) << "means of 8x8";
    EXPECT_LT(sum, 1.5);
    EXPECT_GT(sum, 0.1) << "255 colours are not enough without dither";
}

TEST(Gif, PaintsOnlyWhatChanges) {
    const encoder::Settings s = gif_of(128, 96);
    const auto still = av::make_coder(s), moving = av::make_coder(s);
    const CodedPictures rests = coded(*still, s, 0, 7, false), moves = coded(*moving, s, 0, 7, true);
    for (std::size_t i = 1; i < rests.size(); ++i) {
        EXPECT_LT(av::taken_apart(s.codec, rests[i].bytes).pictures.size(), 48u);
        EXPECT_TRUE(rests[i].reconstruction.y == rests[0].reconstruction.y);
        EXPECT_LT(moves[i].bytes.size(), moves[0].bytes.size() / 4);
    }
}

TEST(Gif, CodesAChunkAlikeWhateverCameBefore) {
    const encoder::Settings s = gif_of(64, 48);
    const auto whole = av::make_coder(s), other = av::make_coder(s);
    coded(*whole, s, 0, 5, true);
    const CodedPictures second = coded(*whole, s, 6, 9, true), alone = coded(*other, s, 6, 9, true);
    for (std::size_t i = 0; i < alone.size(); ++i) EXPECT_EQ(second[i].bytes, alone[i].bytes);
}

TEST(Gif, LastsAsLongAsItsFilm) {
    const encoder::Settings s = gif_of(16, 16, "30");
    const auto coder = av::make_coder(s);
    int hundredths = 0;
    for (const encoder::CodedPicture& c : coded(*coder, s, 0, 29, true)) {
        const std::vector<std::uint8_t> image = av::taken_apart(s.codec, c.bytes).pictures;
        ASSERT_EQ(image[0], 0x21);
        const int delay = image[4] + 256 * image[5];
        EXPECT_TRUE(delay == 3 || delay == 4);
        hundredths += delay;
    }
    EXPECT_EQ(hundredths, 100);
    EXPECT_THROW(av::check(gif_of(16, 16, "60")), core::Error);
}

TEST(Gif, LeavesOpenWhatAlphaDoes) {
    encoder::Settings s = gif_of(16, 16);
    s.alpha = true;
    const auto coder = av::make_coder(s);
    for (int n = 0; n < 2; ++n) {
        core::Picture picture = gradient(16, 16, n, false);
        picture.alpha = core::Plane<float>(16, 16, 1.0f);
        for (int y = 0; y < 16; ++y)
            for (int x = 0; x < 8; ++x) picture.alpha.at(x, y) = n == 0 ? 0.2f : 1.0f;
        const auto c = coder->push(picture, coder->plan(n, {}, n == 0), {});
        const std::vector<std::uint8_t> image = av::taken_apart(s.codec, c.front().bytes).pictures;
        EXPECT_EQ(image[3] >> 2, 2) << "it goes before the next one comes";
        EXPECT_EQ(image[9] + 256 * image[10], n == 0 ? 8 : 0) << "left of what is painted";
        EXPECT_EQ(c.front().reconstruction.y.at(2, 2) == 16, n == 0);
    }
}

TEST(GifPalettes, KeepColoursThatAreFew) {
    std::vector<av::Rgb> pixels;
    for (int i = 0; i < 900; ++i) pixels.push_back({static_cast<float>(i % 9 * 31), static_cast<float>(i % 5 * 60), 7});
    const av::GifPalette palette(pixels);
    EXPECT_EQ(palette.colors().size(), 45u);
    for (const av::Rgb& pixel : pixels) {
        const auto found = palette.colors()[palette.nearest(pixel)];
        for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(static_cast<float>(found[c]), pixel[c]);
    }
}

TEST(GifPalettes, KeepAColourThatMillionsOfPixelsHave) {
    // Behind 2^28 sums in float would take each pixel for a multiple of 32.
    const std::vector<av::Rgb> pixels(2'000'000, av::Rgb{203.4f, 17.8f, 254.6f});
    const av::GifPalette palette(pixels);
    ASSERT_EQ(palette.colors().size(), 1u);
    EXPECT_EQ(palette.colors()[0], (std::array<std::uint8_t, 3>{203, 18, 255}));
}

TEST(GifPalettes, FindTheNearestOfAll) {
    std::vector<av::Rgb> pixels;
    std::uint32_t random = 3;
    const auto next = [&] { return static_cast<float>((random = random * 1664525u + 1013904223u) >> 24); };
    for (int i = 0; i < 4000; ++i) pixels.push_back({next(), next(), next()});
    const av::GifPalette palette(pixels);
    EXPECT_EQ(palette.colors().size(), 255u);
    const auto difference = [&](std::size_t i, const av::Rgb& to) {
        const auto& color = palette.colors()[i];
        const float r = color[0] - to[0], g = color[1] - to[1], b = color[2] - to[2];
        return 2 * r * r + 4 * g * g + 3 * b * b;
    };
    for (int i = 0; i < 300; ++i) {
        const av::Rgb wanted{next(), next(), next()};
        float least = difference(0, wanted);
        for (std::size_t k = 1; k < 255; ++k) least = std::min(least, difference(k, wanted));
        EXPECT_EQ(difference(palette.nearest(wanted), wanted), least);
    }
}

}  // namespace
}  // namespace render2mpeg::test
