#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/error.h"
#include "encoder/mpeg2/macroblock/overrides.h"
#include "film.h"

// What callers ask of single macroblocks (Hints).

namespace render2mpeg::encoder::testing {
namespace {

/// A sliding texture, with the same hints for all pictures; the motion is exact.
Film hinted_film(const Settings& s, int count, const Hints& hints) {
    Film film{s, {}};
    Encoder encoder(s);
    for (int n = 0; n < count; ++n) {
        const PicturePlan plan = encoder.plan(n, {.frames_left = count - 1 - n}, n == 0);
        const std::vector<core::MotionField> motion = steady_motion(s, plan, {1.5f, 0.5f});
        for (CodedPicture& coded : encoder.push(textured(s, n, {1.5, 0.5}), plan, motion, hints))
            film.coded.push_back(std::move(coded));
    }
    return film;
}

TEST(Overrides, FactorsMultiplyTheQuantiserOfEachMacroblock) {
    const Settings s = settings(88, 56, 6, 4, 3, 2);  // 6 x 4 macroblocks, the last ones padded
    core::Plane<float> factors(6, 4, 1.0f);
    factors.at(1, 1) = 0.5f;
    factors.at(4, 2) = 1.75f;
    factors.at(2, 3) = 100.0f;
    factors.at(3, 3) = 1e-6f;
    Hints hints;
    hints.quantiser_factors = &factors;
    const Film film = hinted_film(s, 4, hints);
    expect_decoders_agree(film, 0.25);
    for (const CodedPicture& coded : film.coded)
        for (int row = 0; row < 4; ++row)
            for (int column = 0; column < 6; ++column) {
                const long wanted = std::lround(static_cast<float>(coded.quantiser) * factors.at(column, row));
                if (coded.plan.type != PictureType::intra) continue;  // elsewhere those without coefficients have none
                EXPECT_EQ(coded.macroblocks.at(column, row).quantiser, std::clamp(wanted, 1l, 31l));
            }
}

TEST(Overrides, FinerFactorsBuyQuality) {
    const Settings s = settings(96, 64, 12, 4, 3, 1);
    core::Plane<float> factors(6, 4, 1.0f);
    for (int row = 0; row < 4; ++row)
        for (int column = 0; column < 3; ++column) factors.at(column, row) = 0.25f;
    Hints hints;
    hints.quantiser_factors = &factors;
    const Film film = hinted_film(s, 4, hints);
    for (const CodedPicture& coded : film.coded) {
        const core::Picture source = textured(s, coded.plan.number, {1.5, 0.5});
        double left = 0, right = 0;
        for (int y = 0; y < 64; ++y)
            for (int x = 0; x < 96; ++x) {
                const double d = source.y.at(x, y) - coded.reconstruction.y.at(x, y);
                (x < 48 ? left : right) += d * d;
            }
        EXPECT_LT(3 * left, right) << coded.plan.number;
    }
}

TEST(Overrides, QuantisersGrowWithAPowerOfWhatIsHiddenWhateverThePicture) {
    const auto factors_of = [](const std::vector<float>& octaves, const core::Plane<float>* asked) {
        core::Plane<float> hidden(static_cast<int>(octaves.size()), 1);
        std::copy(octaves.begin(), octaves.end(), hidden.values().begin());
        Hints hints;
        hints.hidden = &hidden;
        hints.quantiser_factors = asked;
        return mpeg2::overrides_from(hints, hidden.width(), 1, 4).quantiser_factors;
    };
    const core::Plane<float> calm = factors_of({0, 0, 1}, nullptr), busy = factors_of({1, 2, 4}, nullptr);
    const float ratio = calm.at(2, 0) / calm.at(0, 0);
    EXPECT_GT(ratio, 1.1f);
    EXPECT_LT(ratio, 2.0f) << "less than all that is hidden";
    EXPECT_LT(calm.at(0, 0), 1.0f);
    EXPECT_FLOAT_EQ(calm.at(0, 0), calm.at(1, 0));
    EXPECT_FLOAT_EQ(busy.at(0, 0), calm.at(2, 0)) << "where the same is hidden in another picture";
    EXPECT_NEAR(busy.at(1, 0) / busy.at(0, 0), ratio, 1e-5f);
    EXPECT_NEAR(busy.at(2, 0) / busy.at(1, 0), ratio * ratio, 1e-5f);
    const core::Plane<float> asked(3, 1, 0.5f);
    EXPECT_FLOAT_EQ(factors_of({0, 0, 1}, &asked).at(2, 0), 0.5f * calm.at(2, 0));
}

TEST(Overrides, ForcedMacroblocksAreIntraOrSkippedInAllPicturesThatCan) {
    const Settings s = settings(96, 64, 4, 7, 3, 2);
    core::Plane<Force> forced(6, 4, Force::none);
    forced.at(0, 0) = forced.at(3, 1) = forced.at(5, 3) = Force::intra;
    forced.at(1, 2) = forced.at(2, 2) = forced.at(0, 3) = forced.at(5, 2) = Force::skip;
    Hints hints;
    hints.forced = &forced;
    const Film film = hinted_film(s, 7, hints);
    expect_decoders_agree(film, 0.25);
    for (const CodedPicture& coded : film.coded) {
        const auto& records = coded.macroblocks;
        EXPECT_TRUE(records.at(0, 0).intra && records.at(3, 1).intra && records.at(5, 3).intra);
        const bool after_intra = records.at(0, 2).intra;
        const bool may_skip = coded.plan.type == PictureType::predicted ||
                              (coded.plan.type == PictureType::bidirectional && !after_intra);
        EXPECT_EQ(records.at(1, 2).skipped, may_skip) << coded.plan.number;
        EXPECT_EQ(records.at(2, 2).skipped, may_skip) << coded.plan.number;
        EXPECT_FALSE(records.at(0, 3).skipped || records.at(5, 2).skipped);  // a slice begins and ends with a coded one
    }
}

TEST(Overrides, MapsOfOnesAndOfNothingChangeNothing) {
    const Settings s = settings(96, 64, 4, 7, 3, 2);
    const core::Plane<float> ones(6, 4, 1.0f);
    const core::Plane<Force> nothing(6, 4, Force::none);
    Hints hints;
    hints.quantiser_factors = &ones;
    hints.forced = &nothing;
    EXPECT_EQ(hinted_film(s, 7, hints).bytes(), hinted_film(s, 7, {}).bytes());
}

TEST(Overrides, MapsOfAnotherSizeOrWithoutMeaningAreRefused) {
    const Settings s = settings(96, 64, 4, 7, 3, 2);
    const core::Plane<float> narrow(5, 4, 1.0f);
    const core::Plane<Force> low(6, 3, Force::none);
    for (const bool of_factors : {true, false}) {
        Hints hints;
        if (of_factors)
            hints.quantiser_factors = &narrow;
        else
            hints.forced = &low;
        EXPECT_THROW(hinted_film(s, 1, hints), core::ContractViolation);
    }
    for (const float wrong : {-1.0f, std::nanf(""), std::numeric_limits<float>::infinity()}) {
        core::Plane<float> hidden(6, 4, 1.0f);
        hidden.at(2, 2) = wrong;
        Hints hints;
        hints.hidden = &hidden;
        EXPECT_THROW(hinted_film(s, 1, hints), core::ContractViolation) << wrong;
    }
    for (const float wrong : {0.0f, -1.0f, std::nanf(""), std::numeric_limits<float>::infinity()}) {
        core::Plane<float> factors(6, 4, 1.0f);
        factors.at(2, 2) = wrong;
        Hints hints;
        hints.quantiser_factors = &factors;
        EXPECT_THROW(hinted_film(s, 1, hints), core::ContractViolation) << wrong;
    }
}

}  // namespace
}  // namespace render2mpeg::encoder::testing
