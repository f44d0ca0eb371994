#include "rate_films.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace render2mpeg::encoder::testing {
namespace {

/// 50 films; RENDER2MPEG_RATE_FILMS asks for more.
std::uint64_t films() {
    const char* wanted = std::getenv("RENDER2MPEG_RATE_FILMS");
    return wanted ? std::strtoull(wanted, nullptr, 10) : 50;
}

TEST(RateFilms, NoFilmBreaksBufferLevelVectorsOrMacroblockBits) {
    int tight = 0;
    for (std::uint64_t seed = 0; seed < films(); ++seed) {
        const RateCase c = random_case(seed);
        const Film film = encode_chunks(c);
        EXPECT_EQ(violations(c, film), "") << c.text();
        for (const CodedPicture& coded : film.coded) tight += coded.tries > 1 ? 1 : 0;
    }
    EXPECT_GT(tight, 20) << "the parameters must provoke what is tested";
}

}  // namespace
}  // namespace render2mpeg::encoder::testing
