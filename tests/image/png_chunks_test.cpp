#include "image/format.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "reading.h"

namespace render2mpeg::image {
namespace {

using encoded::Bytes;
using test::read;
using test::refusal;

TEST(PixelAspect, OfAPngIsLeftOutWhereItIsBroken) {
    // Too short, twice (then the first counts), and no number of pixels.
    const Bytes wide{0, 0, 0, 1, 0, 0, 0, 2, 0}, tall{0, 0, 0, 2, 0, 0, 0, 1, 0}, none{0, 0, 0, 0, 0, 0, 0, 0, 0};
    EXPECT_EQ(read(encoded::png(1, 1, 8, 2, {{1, 2, 3}}, {{"pHYs", wide}})).pixel_aspect, 2.0f);
    EXPECT_EQ(read(encoded::png(1, 1, 8, 2, {{1, 2, 3}}, {{"pHYs", wide}, {"pHYs", tall}})).pixel_aspect, 2.0f);
    EXPECT_EQ(read(encoded::png(1, 1, 8, 2, {{1, 2, 3}}, {{"pHYs", {0, 0, 0, 1}}})).pixel_aspect, 1.0f);
    EXPECT_EQ(read(encoded::png(1, 1, 8, 2, {{1, 2, 3}}, {{"pHYs", none}})).pixel_aspect, 1.0f);
}

TEST(Png, KeepsItsPixelsAndTheirShapeAlone) {
    const Bytes plain = encoded::png(1, 1, 8, 2, {{1, 2, 3}}),
                chatty = encoded::png(1, 1, 8, 2, {{1, 2, 3}}, {{"iCCP", {'x', 0, 0, 1}}, {"tEXt", {'a'}}});
    const std::vector<std::byte> kept = essential_png(std::as_bytes(std::span(chatty)), "a.png");
    EXPECT_TRUE(std::equal(kept.begin(), kept.end(), std::as_bytes(std::span(plain)).begin(),
                           std::as_bytes(std::span(plain)).end()));
    EXPECT_NE(refusal(encoded::png(1, 1, 8, 2, {{1, 2, 3}}, {{"CgBI", {0}}})).find("not known"), std::string::npos);
    Bytes damaged = plain;
    damaged[damaged.size() - 20] ^= 1;
    EXPECT_NE(refusal(damaged).find("IDAT"), std::string::npos);
}

}  // namespace
}  // namespace render2mpeg::image
