#include "encoder/av/sequence_facts.h"

#include <gtest/gtest.h>

#include "av/coded_film.h"
#include "core/error.h"

namespace render2mpeg::test {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// Appends values with their numbers of bits.
class BitString {
  public:
    BitString& put(std::uint32_t value, int bits) {
        for (int i = bits - 1; i >= 0; --i) {
            if (count_ % 8 == 0) bytes.push_back(0);
            bytes.back() = static_cast<std::uint8_t>(bytes.back() | (value >> i & 1) << (7 - count_++ % 8));
        }
        return *this;
    }
    BitString& code(std::uint8_t c) { return put(0x100 | c, 32); }
    Bytes bytes;

  private:
    std::size_t count_ = 0;
};

/// A sequence whose every field needs its extension: 5000x4100, 999,999,600 bit/s, a buffer of 3 Gbit. [H262, 6.2.2]
BitString sequence() {
    BitString s;
    s.code(0xb3).put(5000 & 0xfff, 12).put(4100 & 0xfff, 12).put(3, 4).put(5, 4).put(2499999 & 0x3ffff, 18).put(1, 1);
    s.put(200000 & 0x3ff, 10).put(0, 1).put(0, 1).put(0, 1).put(0, 0);
    return s;
}
void extension(BitString& s, bool low_delay) {
    s.code(0xb5)
        .put(1, 4)
        .put(0x44, 8)
        .put(1, 1)
        .put(1, 2)
        .put(5000 >> 12, 2)
        .put(4100 >> 12, 2)
        .put(2499999 >> 18, 12);
    s.put(1, 1).put(200000 >> 10, 8).put(low_delay, 1).put(0, 7);
}
void display(BitString& s) {
    s.code(0xb5).put(2, 4).put(5, 3).put(1, 1).put(1, 8).put(6, 8).put(5, 8).put(720, 14).put(1, 1).put(576, 14).put(0,
                                                                                                                     3);
}

TEST(SequenceFacts, JoinsHeaderAndExtensions) {
    for (const bool low_delay : {false, true}) {
        BitString s = sequence();
        extension(s, low_delay);
        display(s);
        const std::size_t headers = s.bytes.size();
        s.code(0xb8).put(0, 32).code(0x00).put(0, 32);
        const av::SequenceFacts facts = av::read_sequence(s.bytes);
        EXPECT_EQ(facts.width, 5000);
        EXPECT_EQ(facts.height, 4100);
        EXPECT_EQ(facts.pixel_aspect, core::product({16, 9}, {4100, 5000}));
        EXPECT_EQ(facts.bit_rate, 2499999 * std::int64_t{400});
        EXPECT_EQ(facts.buffer_bits, 200000 * std::int64_t{16384});
        EXPECT_TRUE(facts.progressive);
        EXPECT_EQ(facts.decoding_delay, low_delay ? 0 : 1);
        EXPECT_EQ(facts.color_primaries, 1);
        EXPECT_EQ(facts.transfer_characteristics, 6);
        EXPECT_EQ(facts.matrix_coefficients, 5);
        EXPECT_EQ(facts.headers, Bytes(s.bytes.begin(), s.bytes.begin() + static_cast<std::ptrdiff_t>(headers)));
    }
}

TEST(SequenceFacts, LeavesUnsaidWhatTheStreamDoesNotSay) {
    BitString s = sequence();
    extension(s, true);
    s.code(0x00);
    const av::SequenceFacts facts = av::read_sequence(s.bytes);
    EXPECT_EQ(facts.color_primaries, 2);
    EXPECT_EQ(facts.matrix_coefficients, 2);
}

TEST(SequenceFacts, RefusesEveryBeginningThatIsNone) {
    BitString s = sequence();
    extension(s, true);
    // Every cut before the extension's last byte that is read lacks something.
    for (std::size_t n = 0; n + 1 < s.bytes.size(); ++n)
        EXPECT_THROW(av::read_sequence(Bytes(s.bytes.begin(), s.bytes.begin() + static_cast<std::ptrdiff_t>(n))),
                     core::Error)
            << n;
    EXPECT_NO_THROW(av::read_sequence(s.bytes));
    Bytes shifted = s.bytes;
    shifted.insert(shifted.begin(), 0);
    EXPECT_THROW(av::read_sequence(shifted), core::Error);
    BitString mpeg1 = sequence();
    mpeg1.code(0xb8).put(0, 32);
    EXPECT_THROW(av::read_sequence(mpeg1.bytes), core::Error);
}

TEST(SequenceFacts, ReadsWhatFfmpegWrites) {
    const Folder folder;
    const CodedFilm film =
        coded_film(folder, 352, 288, "25", 2, "-b:v 3M -maxrate 4M -bufsize 1835008 -colorspace bt709");
    const av::SequenceFacts facts = av::read_sequence(film.pictures.at(0).bytes);
    EXPECT_EQ(facts.width, 352);
    EXPECT_EQ(facts.height, 288);
    EXPECT_EQ(facts.bit_rate, 4000000);
    EXPECT_EQ(facts.buffer_bits, 1835008);
    EXPECT_TRUE(facts.progressive);
    EXPECT_EQ(facts.matrix_coefficients, 1);
}

}  // namespace
}  // namespace render2mpeg::test
