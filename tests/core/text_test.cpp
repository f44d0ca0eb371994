#include "core/text.h"

#include <gtest/gtest.h>

#include <string>

namespace render2mpeg::core {
namespace {

TEST(Endings, AreInLowerCaseWithTheirDot) {
    EXPECT_EQ(ending_of("a/B.c/Film.TS"), ".ts");
    EXPECT_EQ(ending_of("frames.%04d.Exr"), ".exr");
    EXPECT_EQ(ending_of("film"), "");
    EXPECT_EQ(ending_of(".hidden"), "");
    EXPECT_EQ(lower_case("ABCXYZ[\\]\xc4@"), "abcxyz[\\]\xc4@") << "letters of ASCII alone";
}

TEST(Printable, IsTextThatOnlyShows) {
    const std::string plain = "Stuhl \"Größe\" 椅子 🪑 ~";
    EXPECT_EQ(printable(plain), plain);
}

TEST(Printable, HasNoCodesForTerminals) {
    EXPECT_EQ(printable("a\x1b[31mb\r\n\tc\x7f"), "a?[31mb???c?");
    EXPECT_EQ(printable("\xc2\x9b"
                        "31m"),
              "?31m")
        << "the control code CSI";
    EXPECT_EQ(printable("a\xe2\x80\xaeoda\xe2\x80\xa8"), "a?oda?") << "writing from right to left, a line separator";
    EXPECT_EQ(printable(std::string("a\0b", 3)), "a?b");
    EXPECT_EQ(printable_lines("one\ntwo\x1b\n"), "one\ntwo?\n");
}

TEST(Printable, HasNoBytesThatAreNoUtf8) {
    EXPECT_EQ(printable("caf\xe9"), "caf?");
    EXPECT_EQ(printable("\xe9t\xe9"), "?t?") << "a lead byte takes nothing with it";
    EXPECT_EQ(printable("\x9b"
                        "a"),
              "?a");
    EXPECT_EQ(printable("\xc0\x8a"), "??") << "longer than it has to be";
    EXPECT_EQ(printable("\xed\xa0\x80"), "?") << "half of a pair of UTF-16";
    EXPECT_EQ(printable("\xf4\x90\x80\x80"), "?") << "beyond Unicode";
    EXPECT_EQ(printable("\xf0\x9f\xaa"), "???") << "cut";
}

}  // namespace
}  // namespace render2mpeg::core
