#include "encoder/av/coders.h"

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <numeric>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "av/coded_film.h"
#include "core/error.h"
#include "encoder/av/access_unit.h"
#include "encoder/av/av1_grain.h"
#include "encoder/codec.h"

/// Coders of libavcodec behind the interface of ours.
namespace render2mpeg::test {
namespace {

using encoder::Codec;
using encoder::PictureType;

/// Texture that moves, with some noise of its own in every picture so that macroblocks have something to code.
core::Picture textured(int width, int height, std::int64_t number) {
    core::Picture p;
    p.number = number;
    p.y = core::Plane<std::uint8_t>(width, height);
    p.cb = core::Plane<std::uint8_t>(width / 2, height / 2, 110);
    p.cr = core::Plane<std::uint8_t>(width / 2, height / 2, 140);
    std::uint32_t random = 1 + static_cast<std::uint32_t>(number);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            random = random * 1664525u + 1013904223u;
            const double wave = std::sin(0.37 * (x + 2.0 * static_cast<double>(number))) * std::cos(0.23 * y);
            p.y.at(x, y) = static_cast<std::uint8_t>(120 + 60 * wave + static_cast<double>(random >> 28));
        }
    p.luma = core::Plane<float>(width, height);
    for (std::size_t i = 0; i < p.y.size(); ++i) p.luma.values()[i] = p.y.values()[i];
    return p;
}

encoder::Settings settings_of(Codec codec) {
    encoder::Settings settings;
    settings.codec = codec;
    settings.width = 96;
    settings.height = 80;
    settings.rate = core::frame_rate_from("25");
    settings.gop = 12;
    settings.quantiser = static_cast<int>(std::lround(encoder::quantiser_like(codec, 4)));
    settings.effort = encoder::Effort::fast;
    settings.b_pictures = std::min(settings.b_pictures, encoder::facts_of(codec).most_b_pictures);
    return settings;
}

bool is_there(Codec codec) {
    try {
        av::check(settings_of(codec));
        return true;
    } catch (const core::Error&) {
        return false;
    }
}

using CodedPictures = std::vector<encoder::CodedPicture>;

void append(CodedPictures& all, CodedPictures more) {
    for (encoder::CodedPicture& picture : more) all.push_back(std::move(picture));
}

/// Codes pictures `first` to `last` as one chunk; what is still held back comes from flush().
void code_chunk(encoder::Coder& coder, const encoder::Settings& s, int first, int last, CodedPictures& coded,
                const encoder::Hints& hints = {}) {
    for (int n = first; n <= last; ++n) {
        encoder::PictureFacts facts;
        facts.frames_left = last - n;
        const encoder::PicturePlan plan = coder.plan(n, facts, n == first);
        append(coded, coder.push(textured(s.width, s.height, n), plan, {}, hints));
    }
}

TEST(Coders, OfH264HaveTheQuantiserOfEachMacroblockAsPlanned) {
    const encoder::Settings s = settings_of(Codec::h264);
    core::Plane<float> factors((s.width + 15) / 16, (s.height + 15) / 16);
    for (std::size_t i = 0; i < factors.size(); ++i)
        factors.values()[i] = std::exp2(static_cast<float>((7 * i) % 5) / 3 - 2.0f / 3);
    const auto coder = av::make_coder(s);
    CodedPictures coded;
    encoder::Hints hints;
    hints.quantiser_factors = &factors;
    code_chunk(*coder, s, 0, 23, coded, hints);
    append(coded, coder->flush());
    ASSERT_EQ(coded.size(), 24u);
    std::set<int> seen;
    std::set<PictureType> types;
    for (const encoder::CodedPicture& picture : coded) {
        types.insert(picture.plan.type);
        for (std::size_t i = 0; i < factors.size(); ++i) {
            const double offset = 2 * std::round(3 * std::log2(factors.values()[i]));
            const encoder::MacroblockRecord& record = picture.macroblocks.values()[i];
            EXPECT_EQ(record.quantiser, picture.plan.quantiser + static_cast<int>(offset))
                << "picture " << picture.plan.number << ", macroblock " << i;
            seen.insert(record.quantiser);
            EXPECT_TRUE(record.intra || picture.plan.type != PictureType::intra);
        }
    }
    EXPECT_EQ(types.size(), 3u);
    EXPECT_GE(seen.size(), 5u);
}

TEST(Coders, OfH264KeepTypesAndBeginGroupsWhereTheyWerePlanned) {
    const encoder::Settings s = settings_of(Codec::h264);
    const auto coder = av::make_coder(s);
    CodedPictures coded;
    for (int n = 0; n < 20; ++n) {
        encoder::PictureFacts facts;
        facts.cut_before = n == 7;
        facts.frames_left = n < 7 ? 6 - n : 19 - n;
        const encoder::PicturePlan plan = coder->plan(n, facts, n == 0);
        append(coded, coder->push(textured(s.width, s.height, n), plan, {}));
    }
    append(coded, coder->flush());
    ASSERT_EQ(coded.size(), 20u);
    for (std::size_t i = 0; i < coded.size(); ++i) {
        const encoder::CodedPicture& c = coded[i];
        EXPECT_EQ(c.coding_order, static_cast<std::int64_t>(i));
        EXPECT_EQ(c.plan.starts_gop, c.plan.number == 0 || c.plan.number == 7 || c.plan.number == 19);
        EXPECT_EQ(av::taken_apart(Codec::h264, c.bytes).headers.empty(), !c.plan.starts_gop);
    }
}

/// A film in one coder, and its second chunk alone in another.
void expect_chunk_alone(const encoder::Settings& s) {
    CodedPictures whole, alone;
    const auto coder = av::make_coder(s), other = av::make_coder(s);
    code_chunk(*coder, s, 0, 11, whole);
    code_chunk(*coder, s, 12, 20, whole);
    append(whole, coder->flush());
    code_chunk(*other, s, 12, 20, alone);
    append(alone, other->flush());
    ASSERT_EQ(whole.size(), 21u);
    ASSERT_EQ(alone.size(), 9u);
    for (std::size_t i = 0; i < alone.size(); ++i) EXPECT_EQ(whole[12 + i].bytes, alone[i].bytes) << i;
}

class EveryCoder : public testing::TestWithParam<Codec> {
  protected:
    void SetUp() override {
        if (!is_there(GetParam())) GTEST_SKIP() << "this libavcodec has no encoder for it";
    }
};

TEST_P(EveryCoder, CodesAChunkAlikeWhateverCameBefore) {
    expect_chunk_alone(settings_of(GetParam()));
}

TEST(Coders, OfAv1TellGrainByThePicturesNumbersAndChangeNothingElse) {
    encoder::Settings s = settings_of(Codec::av1);
    if (!is_there(s.codec)) GTEST_SKIP() << "this libavcodec has no encoder for it";
    CodedPictures plain, grained;
    for (const int grain : {0, 400}) {
        s.grain = grain;
        const auto coder = av::make_coder(s);
        code_chunk(*coder, s, 0, s.gop - 1, grain == 0 ? plain : grained);
        append(grain == 0 ? plain : grained, coder->flush());
    }
    expect_chunk_alone(s);
    std::size_t more = 0;
    for (std::size_t i = 0; i < plain.size(); ++i) {
        EXPECT_EQ(plain[i].reconstruction.y, grained[i].reconstruction.y);
        more += grained[i].bytes.size() - plain[i].bytes.size();
    }
    EXPECT_GT(more, 2u * plain.size());
    EXPECT_LT(more, 80 + 12u * plain.size());
}

TEST(Coders, OfAv1RefuseToTellGrainInStreamsThatTheyDoNotKnow) {
    av::Av1Grain grain;
    // Units with sizes: sequence headers of profile 1 and of a still picture, an end of one, a frame without any.
    for (const std::vector<std::uint8_t>& unit : {std::vector<std::uint8_t>{0x0a, 4, 0x20, 0, 0, 0},
                                                  {0x0a, 4, 0x18, 0, 0, 0},
                                                  {0x0a, 1, 0},
                                                  {0x32, 2, 0x10, 0}})
        EXPECT_THROW(grain.with_grain(unit, 0), core::Error);
}

TEST(GradientDither, IsOfTheLumaThatHasStepsAndOfNoOther) {
    core::Plane<std::uint8_t> luma(256, 64);
    const auto table_of = [&](const auto& value) {
        for (int y = 0; y < luma.height(); ++y)
            for (int x = 0; x < luma.width(); ++x) luma.at(x, y) = static_cast<std::uint8_t>(value(x, y));
        av::GradientDither dither;
        dither.add(luma);
        return dither.table();
    };
    EXPECT_TRUE(table_of([](int, int) { return 90; }).points.empty()) << "an even wall has no steps";
    EXPECT_TRUE(table_of([](int x, int y) { return 90 + (37 * x + 11 * y) % 7; }).points.empty()) << "a texture";
    EXPECT_TRUE(table_of([](int x, int) { return 40 + x; }).points.empty()) << "a ramp without bands";
    EXPECT_TRUE(table_of([](int x, int y) { return y < 48 ? 60 + 60 * (x / 4 % 2) : 60 + x / 20; }).points.empty())
        << "mostly others";
    const av::GrainTable dither = table_of([](int x, int) { return x < 192 ? 80 + x / 12 : 160 + 20 * (x % 3); });
    const int scaling = dither.points.at(1).scaling;
    EXPECT_EQ(dither.points, (std::vector<av::GrainTable::Point>{{56, 0}, {76, scaling}, {98, scaling}, {120, 0}}));
    EXPECT_NEAR(scaling * av::GrainTable::unfiltered / (1 << (dither.scaling_shift + dither.noise_shift)),
                std::sqrt(1.0 / 12), 0.005)
        << "the deviation of rounding";
}

/// What each push gives, with a pause before each.
std::vector<std::size_t> deliveries(const encoder::Settings& s, std::chrono::milliseconds pause) {
    const auto coder = av::make_coder(s);
    std::vector<std::size_t> counts;
    for (int n = 0; n < s.gop; ++n) {
        std::this_thread::sleep_for(pause);
        encoder::PictureFacts facts;
        facts.frames_left = s.gop - 1 - n;
        const encoder::PicturePlan plan = coder->plan(n, facts, n == 0);
        counts.push_back(coder->push(textured(s.width, s.height, n), plan, {}).size());
    }
    counts.push_back(coder->flush().size());
    return counts;
}

TEST_P(EveryCoder, GivesPicturesByCountAndNotByTime) {
    encoder::Settings s = settings_of(GetParam());
    s.gop = 48;  // longer than any library holds pictures back
    const auto at_once = deliveries(s, std::chrono::milliseconds(0));
    EXPECT_EQ(at_once, deliveries(s, std::chrono::milliseconds(5)));
    EXPECT_EQ(std::accumulate(at_once.begin(), at_once.end(), std::size_t{0}), static_cast<std::size_t>(s.gop));
}

/// Bits over those that a chunk of `s.gop` pictures was allocated, `allocated` of them with a quantiser of `guess`.
double ratio_of_bits(const encoder::Settings& s, double allocated, double guess) {
    const auto coder = av::make_coder(s);
    CodedPictures coded;
    for (int n = 0; n < s.gop; ++n) {
        encoder::PictureFacts facts;
        facts.frames_left = s.gop - 1 - n;
        facts.allocation = {guess, allocated / s.gop, allocated * (s.gop - n) / s.gop};
        const encoder::PicturePlan plan = coder->plan(n, facts, n == 0);
        append(coded, coder->push(textured(s.width, s.height, n), plan, {}));
    }
    append(coded, coder->flush());
    double bits = 0;
    for (std::size_t i = 0; i < coded.size(); ++i) {
        EXPECT_EQ(coded[i].coding_order, static_cast<std::int64_t>(i));
        bits += 8.0 * static_cast<double>(coded[i].bytes.size());
    }
    return bits / allocated;
}

TEST_P(EveryCoder, ComesToTheBitsOfItsChunkFromAnyGuess) {
    encoder::Settings s = settings_of(GetParam());
    s.gop = 24;
    s.rate_control = {.mode = encoder::RateMode::variable, .bit_rate = 200'000};
    const double allocated = 200'000.0 * s.gop / 25;
    // One quantiser for all pictures is half a step off at most.
    const double near = s.codec == Codec::av1 ? 0.015 : s.codec == Codec::vp9 ? 0.06 : 0.01;
    for (const double guess : {1.5, 5.0, 29.0}) EXPECT_NEAR(ratio_of_bits(s, allocated, guess), 1, near) << guess;
}

/// Sum of squared errors of luma left and right of the middle.
std::array<double, 2> errors_of_halves(const CodedPictures& coded, const encoder::Settings& s) {
    std::array<double, 2> sums{};
    for (const encoder::CodedPicture& picture : coded) {
        const core::Picture source = textured(s.width, s.height, picture.plan.number);
        for (int y = 0; y < s.height; ++y)
            for (int x = 0; x < s.width; ++x) {
                const double error = source.y.at(x, y) - picture.reconstruction.y.at(x, y);
                sums[x < s.width / 2 ? 0 : 1] += error * error;
            }
    }
    return sums;
}

TEST(Coders, OfHevcCodeBlocksFinerWhereTheyAreToldTo) {
    if (!is_there(Codec::hevc)) GTEST_SKIP() << "this libavcodec has no encoder for it";
    encoder::Settings s = settings_of(Codec::hevc);
    s.width = 128;
    core::Plane<float> factors((s.width + 15) / 16, (s.height + 15) / 16, 1.0f);
    for (int row = 0; row < factors.height(); ++row)
        for (int column = 0; column < factors.width() / 2; ++column) factors.at(column, row) = 0.5f;
    encoder::Hints hints;
    hints.quantiser_factors = &factors;
    const auto coder = av::make_coder(s);
    CodedPictures coded;
    code_chunk(*coder, s, 0, 11, coded, hints);
    append(coded, coder->flush());
    const std::array<double, 2> errors = errors_of_halves(coded, s);
    EXPECT_LT(2 * errors[0], errors[1]) << "half the step has a quarter of the error";
}

TEST(Coders, HaveCoarserQuantisersWhereMoreIsHidden) {
    for (const Codec codec : {Codec::mpeg2, Codec::h264, Codec::hevc}) {
        if (!is_there(codec)) continue;
        encoder::Settings s = settings_of(codec);
        s.width = 128;
        s.quantiser = static_cast<int>(std::lround(encoder::quantiser_like(codec, 2)));  // that noise does not vanish
        core::Plane<float> hidden((s.width + 15) / 16, (s.height + 15) / 16, 0.0f);
        for (int row = 0; row < hidden.height(); ++row)
            for (int column = hidden.width() / 2; column < hidden.width(); ++column) hidden.at(column, row) = 4.0f;
        encoder::Hints hints;
        hints.hidden = &hidden;
        const auto coder = av::make_coder(s);
        CodedPictures coded;
        code_chunk(*coder, s, 0, 11, coded, hints);
        append(coded, coder->flush());
        const std::array<double, 2> errors = errors_of_halves(coded, s);
        EXPECT_LT(1.5 * errors[0], errors[1]) << encoder::facts_of(codec).name;
    }
}

TEST_P(EveryCoder, CodesWithTheFinestAndTheCoarsestQuantiser) {
    for (const int quantiser : {encoder::facts_of(GetParam()).finest, encoder::facts_of(GetParam()).coarsest}) {
        encoder::Settings s = settings_of(GetParam());
        s.quantiser = quantiser;
        const auto coder = av::make_coder(s);
        CodedPictures coded;
        code_chunk(*coder, s, 0, 11, coded);
        append(coded, coder->flush());
        EXPECT_EQ(coded.size(), 12u) << quantiser;
    }
}

TEST(Coders, OfOneQuantiserCodeGroupsWithTheirOwn) {
    const Codec codec = Codec::av1;
    if (!is_there(codec)) GTEST_SKIP() << "this libavcodec has no encoder for it";
    encoder::Settings s = settings_of(codec);
    s.rate_control.mode = encoder::RateMode::constant_quality;
    // Between two sixteenths of quantisers, so that groups have now one and now the other.
    s.rate_control.quality = 100 - 20 * std::log2(encoder::mpeg2_quantiser_like(codec, s.quantiser + 0.48));
    CodedPictures whole, alone;
    const auto coder = av::make_coder(s), other = av::make_coder(s);
    code_chunk(*coder, s, 0, 2 * s.gop - 1, whole);
    append(whole, coder->flush());
    code_chunk(*other, s, s.gop, 2 * s.gop - 1, alone);
    append(alone, other->flush());
    const auto gop = static_cast<std::size_t>(s.gop);
    ASSERT_EQ(whole.size(), 2 * gop);
    EXPECT_NE(whole[0].quantiser, whole[gop].quantiser);
    for (std::size_t i = 0; i < gop; ++i) EXPECT_EQ(whole[i].plan.quantiser, whole[0].plan.quantiser) << i;
    for (std::size_t i = 0; i < gop; ++i) EXPECT_TRUE(whole[gop + i].bytes == alone[i].bytes) << i;
}

TEST_P(EveryCoder, SaysWhatEveryContainerDecodesTo) {
    const Folder folder;
    CodedFilm film;
    film.settings = settings_of(GetParam());
    const auto coder = av::make_coder(film.settings);
    CodedPictures coded;
    code_chunk(*coder, film.settings, 0, 17, coded);
    append(coded, coder->flush());
    std::vector<const core::Picture*> shown(coded.size());
    for (const encoder::CodedPicture& c : coded) {
        film.pictures.push_back({c.bytes, c.plan.number, c.plan.starts_gop});
        shown[static_cast<std::size_t>(c.plan.number)] = &c.reconstruction;
    }
    const encoder::CodecFacts& facts = encoder::facts_of(GetParam());
    for (const std::string ending : {"mp4", "mkv", "webm", "mov", "ts"}) {
        if (!facts.has_ending("." + ending)) continue;
        SCOPED_TRACE(ending);
        std::size_t n = 0;
        av::decode(film.mux(folder / ("film." + ending)), [&](const core::Picture& p) {
            ASSERT_LT(n, shown.size());
            EXPECT_TRUE(p.y == shown[n]->y && p.cb == shown[n]->cb) << "picture " << p.number;
            ++n;
        });
        EXPECT_EQ(n, shown.size());
    }
    EXPECT_THROW(film.mux(folder / "film.mpg"), core::Error);
}

TEST_P(EveryCoder, CodesAFilmThatEndsEarly) {
    const encoder::Settings s = settings_of(GetParam());
    const auto coder = av::make_coder(s);
    CodedPictures coded;
    for (int n = 0; n < 7; ++n) {
        encoder::PictureFacts facts;
        facts.frames_left = 20 - n;
        const encoder::PicturePlan plan = coder->plan(n, facts, n == 0);
        append(coded, coder->push(textured(s.width, s.height, n), plan, {}));
    }
    append(coded, coder->flush());
    ASSERT_EQ(coded.size(), 7u);
    for (const encoder::CodedPicture& c : coded) {
        EXPECT_TRUE(c.plan.number != 6 || c.plan.type == PictureType::predicted);
    }
    // Only a chunk follows.
    append(coded, coder->push(textured(s.width, s.height, 30), coder->plan(30, {}, true), {}));
    append(coded, coder->flush());
    EXPECT_EQ(coded.back().plan.type, PictureType::intra);
}

INSTANTIATE_TEST_SUITE_P(Codecs, EveryCoder, testing::Values(Codec::h264, Codec::hevc, Codec::av1, Codec::vp9),
                         [](const auto& codec) { return std::string(encoder::facts_of(codec.param).word); });

TEST(Coders, RefuseWhatOnlyMpeg2Does) {
    const auto refusal = [](auto change) {
        encoder::Settings s = settings_of(Codec::h264);
        change(s);
        try {
            av::check(s);
        } catch (const core::Error& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_EQ(refusal([](encoder::Settings&) {}), "");
    EXPECT_NE(refusal([](auto& s) { s.rate_control.mode = encoder::RateMode::constant; }).find("--cbr"),
              std::string::npos);
    EXPECT_NE(refusal([](auto& s) { s.rate_control.buffer_bits = 1'000'000; }).find("--vbv"), std::string::npos);
    EXPECT_NE(refusal([](auto& s) { s.cadence = encoder::Cadence::fields; }).find("fields"), std::string::npos);
    EXPECT_NE(refusal([](auto& s) { s.width = 95; }).find("95x80"), std::string::npos);
}

TEST(AccessUnits, KeepHeadersApartAndDropComments) {
    // A delimiter, parameter sets, a message and a slice.
    const std::vector<std::uint8_t> bytes{0,    0, 0, 1, 9, 0xf0, 0,    0,    1, 0x67, 1, 2,    0, 0, 0, 1,
                                          0x68, 3, 0, 0, 1, 6,    0x05, 0x80, 0, 0,    1, 0x65, 7, 8, 0};
    const av::AccessUnit unit = av::taken_apart(Codec::h264, bytes);
    EXPECT_EQ(unit.headers, (std::vector<std::uint8_t>{0, 0, 0, 1, 0x67, 1, 2, 0, 0, 0, 1, 0x68, 3}));
    EXPECT_EQ(unit.pictures, (std::vector<std::uint8_t>{0, 0, 0, 1, 0x65, 7, 8}));
    EXPECT_THROW(av::taken_apart(Codec::h264, std::vector<std::uint8_t>{1, 2, 3}), core::Error);
}

TEST(AccessUnits, OfAv1MustHaveSizes) {
    const std::vector<std::uint8_t> bytes{0x12, 0, 0x0a, 2, 9, 9, 0x32, 3, 1, 2, 3};
    const av::AccessUnit unit = av::taken_apart(Codec::av1, bytes);
    EXPECT_EQ(unit.headers, (std::vector<std::uint8_t>{0x0a, 2, 9, 9}));
    EXPECT_EQ(unit.pictures, (std::vector<std::uint8_t>{0x32, 3, 1, 2, 3}));
    EXPECT_THROW(av::taken_apart(Codec::av1, std::vector<std::uint8_t>{0x32, 9, 1}), core::Error);
    EXPECT_THROW(av::taken_apart(Codec::av1, std::vector<std::uint8_t>{0x30, 1}), core::Error);
}

TEST(Codecs, HaveInverseScales) {
    for (const encoder::CodecFacts& facts : encoder::all_codecs) {
        EXPECT_EQ(encoder::facts_of(facts.codec).word, facts.word);
        if (facts.master) continue;
        for (const double q : {2.0, 4.0, 8.0}) {
            const double own = encoder::quantiser_like(facts.codec, q);
            EXPECT_NEAR(encoder::mpeg2_quantiser_like(facts.codec, own), q, 1e-9) << facts.word;
            EXPECT_GT(encoder::step_of(facts.codec, own + 1), encoder::step_of(facts.codec, own));
        }
    }
    // Six quantisers of H.264 are a doubling.
    EXPECT_NEAR(encoder::step_of(Codec::h264, 30) / encoder::step_of(Codec::h264, 24), 2, 1e-12);
}

}  // namespace
}  // namespace render2mpeg::test
