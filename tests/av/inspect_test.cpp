#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "av/coded_film.h"
#include "core/error.h"
#include "core/motion_field.h"
#include "encoder/av/inspect.h"
#include "encoder/encoder.h"

/// What libavcodec tells of a film is what the encoder put into it.
namespace render2mpeg::test {
namespace {

constexpr int width = 112, height = 80;

/// A texture that slides to the right by three pixels and a half a picture, over a ground that stands still.
core::Picture sliding(std::int64_t number) {
    core::Picture p;
    p.number = number;
    p.y = core::Plane<std::uint8_t>(width, height);
    p.cb = core::Plane<std::uint8_t>(width / 2, height / 2, 110);
    p.cr = core::Plane<std::uint8_t>(width / 2, height / 2, 140);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const double place = y < height / 2 ? x - 3.5 * static_cast<double>(number) : x;
            p.y.at(x, y) = static_cast<std::uint8_t>(120 + 60 * std::sin(0.35 * place) * std::cos(0.4 * y));
        }
    p.luma = core::Plane<float>(width, height);
    for (std::size_t i = 0; i < p.y.size(); ++i) p.luma.values()[i] = p.y.values()[i];
    return p;
}

core::MotionField motion_of(std::int64_t number, std::int64_t reference) {
    core::MotionField field{number, reference, {}, {}, {}};
    field.vector = core::Plane<glm::vec2>(width, height, glm::vec2(0));
    field.kind = core::Plane<core::PixelClass>(width, height, core::PixelClass::surface);
    for (int y = 0; y < height / 2; ++y)
        for (int x = 0; x < width; ++x) field.vector.at(x, y) = {3.5f * static_cast<float>(reference - number), 0.0f};
    return field;
}

struct Coded {
    std::vector<encoder::CodedPicture> pictures;  ///< in coding order
    fs::path file;
};

Coded coded_film_of(const Folder& folder, int count) {
    encoder::Settings settings;
    settings.width = width;
    settings.height = height;
    settings.rate = core::frame_rate_from("25");
    settings.gop = 9;
    encoder::Encoder encoder(settings);
    Coded film;
    const auto take = [&](std::vector<encoder::CodedPicture> pictures) {
        for (encoder::CodedPicture& p : pictures) film.pictures.push_back(std::move(p));
    };
    for (int n = 0; n < count; ++n) {
        encoder::PictureFacts facts;
        facts.frames_left = count - 1 - n;
        facts.left_in_chunk = count - 1 - n;
        facts.last_chunk = true;
        const encoder::PicturePlan plan = encoder.plan(n, facts, n == 0);
        std::vector<core::MotionField> motion;
        for (const std::int64_t reference : plan.references) motion.push_back(motion_of(n, reference));
        take(encoder.push(sliding(n), plan, motion));
    }
    take(encoder.flush());
    film.file = folder / "f.m2v";
    std::vector<std::uint8_t> bytes;
    for (const encoder::CodedPicture& p : film.pictures) bytes.insert(bytes.end(), p.bytes.begin(), p.bytes.end());
    for (const std::uint8_t byte : encoder::sequence_end()) bytes.push_back(byte);
    write_bytes(film.file, bytes);
    return film;
}

/// What the encoder's own records say of one direction.
av::VectorFacts vectors_of(const encoder::CodedPicture& picture, bool forward) {
    av::VectorFacts facts;
    int moving = 0, predicted = 0;
    for (const encoder::MacroblockRecord& m : picture.macroblocks.values()) {
        if (forward ? !m.forward : !m.backward) continue;
        ++predicted;
        const double length =
            forward ? 0.5 * std::hypot(m.motion_x, m.motion_y) : 0.5 * std::hypot(m.backward_x, m.backward_y);
        if (length == 0) continue;
        ++moving;
        facts.mean += length;
        facts.longest = std::max(facts.longest, length);
    }
    const auto all = static_cast<double>(picture.macroblocks.size());
    if (moving > 0) facts.mean /= moving;
    facts.share = predicted / all;
    facts.moving = moving / all;
    return facts;
}

void expect_same(const av::VectorFacts& told, const av::VectorFacts& known, std::int64_t picture) {
    EXPECT_NEAR(told.share, known.share, 1e-9) << picture;
    EXPECT_NEAR(told.moving, known.moving, 1e-9) << picture;
    EXPECT_NEAR(told.mean, known.mean, 1e-9) << picture;
    EXPECT_NEAR(told.longest, known.longest, 1e-9) << picture;
}

TEST(Inspection, TellsWhatTheEncoderPutIntoEveryMacroblock) {
    const Folder folder;
    const Coded film = coded_film_of(folder, 14);
    const av::Inspection told = av::inspect(film.file);
    ASSERT_EQ(told.pictures.size(), film.pictures.size());
    double longest = 0;
    for (std::size_t n = 0; n < told.pictures.size(); ++n) {
        const av::PictureFacts& picture = told.pictures[n];
        EXPECT_EQ(picture.number, static_cast<std::int64_t>(n));
        const encoder::CodedPicture& known = film.pictures[static_cast<std::size_t>(picture.coded)];
        ASSERT_EQ(known.plan.number, picture.number) << "in display order";
        EXPECT_EQ(picture.type, "-IPB"[static_cast<int>(known.plan.type)]);
        EXPECT_EQ(picture.random_access, known.plan.starts_gop);
        EXPECT_EQ(picture.damage, "");
        double quantiser = 0, intra = 0;
        for (const encoder::MacroblockRecord& m : known.macroblocks.values()) {
            quantiser += m.quantiser;
            intra += m.intra ? 1 : 0;
        }
        const auto all = static_cast<double>(known.macroblocks.size());
        EXPECT_NEAR(picture.mean_quantiser, quantiser / all, 1e-9) << n;
        EXPECT_NEAR(picture.intra, intra / all, 1e-9) << n;
        expect_same(picture.forward, vectors_of(known, true), picture.number);
        expect_same(picture.backward, vectors_of(known, false), picture.number);
        longest = std::max(longest, picture.forward.longest);
    }
    EXPECT_GE(longest, 3.5) << "the texture moves";
    EXPECT_EQ(told.unshown, 0);
    EXPECT_EQ(told.stream.width, width);
    EXPECT_EQ(told.stream.rate, (core::Rational{25, 1}));
}

TEST(Inspection, CountsWhatAFilmWithoutItsBeginningCannotShow) {
    const Folder folder;
    CodedFilm film = coded_film(folder, 96, 64, "25", 24, "-g 12 -bf 2 -q:v 6");
    // From the second GOP on: ffmpeg's first B pictures there refer to what is before.
    const auto second =
        std::find_if(film.pictures.begin() + 1, film.pictures.end(), [](const auto& p) { return p.starts_gop; });
    ASSERT_NE(second, film.pictures.end());
    std::vector<std::uint8_t> bytes;
    for (auto p = second; p != film.pictures.end(); ++p) bytes.insert(bytes.end(), p->bytes.begin(), p->bytes.end());
    write_bytes(folder / "cut.m2v", bytes);
    const av::Inspection told = av::inspect(folder / "cut.m2v");
    EXPECT_EQ(told.unshown + static_cast<std::int64_t>(told.pictures.size()), film.pictures.end() - second);
    EXPECT_LE(told.unshown, 2);
    EXPECT_EQ(told.pictures.front().type, 'I');
}

TEST(Inspection, OfBrokenBytesNeverCrashesAndNeverPrints) {
    const Folder folder;
    const std::vector<std::uint8_t> whole = bytes_of(coded_film(folder, 96, 64, "25", 8, "-g 4 -bf 1 -q:v 6").source);
    std::mt19937 random(7);
    testing::internal::CaptureStderr();
    int damaged = 0;
    for (int round = 0; round < 60; ++round) {
        std::vector<std::uint8_t> bytes = whole;
        for (int i = 0; i < 1 + round % 7; ++i)
            bytes[random() % bytes.size()] ^= static_cast<std::uint8_t>(1u << random() % 8);
        if (round % 5 == 0) bytes.resize(random() % bytes.size());
        write_bytes(folder / "broken.m2v", bytes);
        try {
            const av::Inspection told = av::inspect(folder / "broken.m2v");
            damaged += std::any_of(told.pictures.begin(), told.pictures.end(),
                                   [](const auto& p) { return !p.damage.empty(); }) ||
                               told.unshown > 0
                           ? 1
                           : 0;
            for (const av::PictureFacts& picture : told.pictures) {
                EXPECT_TRUE(std::isfinite(picture.mean_quantiser) && std::isfinite(picture.forward.mean));
                EXPECT_LE(picture.intra, 1.0);
            }
        } catch (const core::Error&) {
            ++damaged;
        }
    }
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    EXPECT_GE(damaged, 20) << "most flips hurt";
}

}  // namespace
}  // namespace render2mpeg::test
