#include "encoder/cadence.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "film.h"

/// Repeated fields: what is declared, what decoders make of it.
namespace render2mpeg::encoder::testing {
namespace {

Settings shown_as(Cadence cadence, int rate_code, int width = 64, int height = 64) {
    Settings s = settings(width, height, 4, 6, rate_code, 2);
    s.cadence = cadence;
    return s;
}

TEST(Cadence, PulldownDeclaresFiveFramesForFourPictures) {
    EXPECT_EQ(declared_rate(shown_as(Cadence::pulldown, 1)).code, 4);
    EXPECT_EQ(declared_rate(shown_as(Cadence::pulldown, 2)).code, 5);
    for (int code = 1; code <= 8; ++code) {
        EXPECT_EQ(declared_rate(shown_as(Cadence::frames, code)).code, code);
        EXPECT_EQ(declared_rate(shown_as(Cadence::fields, code)).code, code);
    }
    EXPECT_NO_THROW(check(shown_as(Cadence::pulldown, 1)));
    for (int code = 3; code <= 8; ++code) EXPECT_THROW(check(shown_as(Cadence::pulldown, code)), core::Error);
}

TEST(Cadence, FieldsAlternateAndAddUp) {
    for (const Cadence cadence : {Cadence::fields, Cadence::pulldown})
        for (const std::int64_t first : {0, 7, 101}) {
            Settings s = shown_as(cadence, 1);
            s.first_number = first;
            bool top = true;
            std::int64_t fields = 0;
            for (std::int64_t i = 0; i < 40; ++i) {
                const ShownFields f = fields_of(s, first + i);
                EXPECT_EQ(f.top_first, top) << i;
                EXPECT_EQ(f.count, f.repeat_first ? 3 : 2);
                EXPECT_EQ(fields_before(cadence, i), fields);
                fields += f.count;
                if (f.count % 2 == 1) top = !top;
            }
            EXPECT_EQ(fields, cadence == Cadence::pulldown ? 100 : 80);
        }
    EXPECT_EQ(fields_before(Cadence::pulldown, -1), -2);
    EXPECT_EQ(fields_before(Cadence::pulldown, -4), -10);
}

TEST(Cadence, DecodersFindTheFieldsAndThePictures) {
    // 80 lines: five rows of macroblocks as frames, six as fields.
    for (const Cadence cadence : {Cadence::frames, Cadence::fields, Cadence::pulldown}) {
        const Settings s = shown_as(cadence, 1, 64, 80);
        const Film film = encode(
            s, 19,
            [&](std::int64_t n) {
                return textured(s, n, {1.5, 0.5});
            },
            [&](const PicturePlan& plan) {
                return steady_motion(s, plan, {1.5f, 0.5f});
            });
        EXPECT_EQ(film.coded[0].macroblocks.height(), cadence == Cadence::frames ? 5 : 6);
        expect_decoders_agree(film, 0.1);

        Libavcodec decoder;
        for (const CodedPicture& coded : film.coded) decoder.push(coded.bytes);
        decoder.finish();
        const double hertz = av_q2d(decoder.context().framerate);
        EXPECT_NEAR(hertz, cadence == Cadence::pulldown ? 29.97 : 23.976, 0.001);
        ASSERT_EQ(decoder.fields().size(), 19u);
        for (std::int64_t n = 0; n < 19; ++n) {
            const ShownFields f = fields_of(s, n);
            EXPECT_EQ(decoder.fields()[static_cast<std::size_t>(n)], std::pair(f.count, f.top_first)) << n;
        }
    }
}

TEST(Cadence, APictureIsShownTheSameInWhateverChunkItIsCoded) {
    Settings s = shown_as(Cadence::pulldown, 1);
    s.first_number = 3;
    for (const std::int64_t start : {3, 6, 10, 13}) {
        Encoder encoder(s);
        for (std::int64_t n = start; n < start + 6; ++n) {
            const PicturePlan plan = encoder.plan(n, {.frames_left = start + 5 - n}, n == start);
            for (const CodedPicture& coded :
                 encoder.push(textured(s, n, {0, 0}), plan, steady_motion(s, plan, {0, 0}))) {
                // picture_coding_extension: top_field_first is bit 24 after its identifier, repeat_first_field bit 30.
                const auto& b = coded.bytes;
                std::size_t at = 0;
                for (std::size_t i = 0; i + 9 < b.size() && at == 0; ++i)
                    if (b[i] == 0 && b[i + 1] == 0 && b[i + 2] == 1 && b[i + 3] == 0xb5 && b[i + 4] >> 4 == 8) at = i;
                ASSERT_GT(at, 0u);
                const ShownFields f = fields_of(s, coded.plan.number);
                EXPECT_EQ(b[at + 7] >> 7 != 0, f.top_first) << coded.plan.number;
                EXPECT_EQ((b[at + 7] >> 1 & 1) != 0, f.repeat_first) << coded.plan.number;
            }
        }
    }
}

TEST(Plan, AKeyframeBeginsAGop) {
    Encoder encoder(settings(32, 32, 4, 12, 3, 2));
    std::string types;
    for (int n = 0; n < 12; ++n) {
        PictureFacts facts{.frames_left = n < 4 ? 3 - n : n < 5 ? 0 : 11 - n, .keyframe = n == 4 || n == 5};
        types += "-IPB"[static_cast<int>(encoder.plan(n, facts, n == 0).type)];
    }
    EXPECT_EQ(types, "IBBPIIBBPBBP");
}

}  // namespace
}  // namespace render2mpeg::encoder::testing
