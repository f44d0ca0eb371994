#include "core/film_grain.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>

/// Film grain against the closed forms of its model.
namespace render2mpeg::core {
namespace {

/// Mean product of a plane and itself moved by `across` and `down`.
double product(const Plane<float>& a, const Plane<float>& b, int across, int down) {
    double sum = 0;
    for (int y = 0; y + down < a.height(); ++y)
        for (int x = 0; x + across < a.width(); ++x)
            sum += static_cast<double>(a.at(x, y)) * static_cast<double>(b.at(x + across, y + down));
    return sum / ((a.width() - across) * (a.height() - down));
}

TEST(FilmGrain, IsThatOfLoneGrainsInTheDarkAndOfLoneGapsNowhereNearWhite) {
    // Grains that hardly overlap: the variance is the share that they cover times a grain's share of the blur.
    const FilmGrain grain(400, 1080);
    const double pixel = 18660.0 / 1080, radius = 2 * 0.55, blur = 4 * std::numbers::pi * grain.spot() * grain.spot();
    const double share = 1.0 / 219, of_grain = std::numbers::pi * radius * radius / (pixel * pixel * blur);
    EXPECT_NEAR(grain.deviation(17), 219 * std::sqrt(share * of_grain), 0.01 * grain.deviation(17));
    EXPECT_EQ(grain.deviation(16), 0);
    EXPECT_EQ(grain.deviation(10), 0);
    EXPECT_EQ(grain.deviation(235), 0);
    float most = 0, where = 0;
    for (float luma = 16; luma <= 235; ++luma)
        if (grain.deviation(luma) > most) most = grain.deviation(where = luma);
    EXPECT_GT(where, 80);
    EXPECT_LT(where, 180);
    EXPECT_NEAR(most, 4, 0.5);
    EXPECT_LT(grain.deviation(225), 0.5f * most);
}

TEST(FilmGrain, HasTheDeviationAndCorrelationThatItTellsAndIsNewInEachFrame) {
    for (const int iso : {least_iso, 800, most_iso}) {
        const FilmGrain grain(iso, 1080);
        const Plane<float> noise = grain.noise(320, 256, 7), other = grain.noise(320, 256, 8);
        EXPECT_NEAR(product(noise, noise, 0, 0), 1, 0.05) << iso;
        for (const auto& [across, down] : {std::pair{1, 0}, {0, 1}, {2, 0}, {1, 2}}) {
            const double expected = std::exp(-(across * across + down * down) / (4 * grain.spot() * grain.spot()));
            EXPECT_NEAR(product(noise, noise, across, down), expected, 0.05) << iso;
        }
        EXPECT_NEAR(product(noise, other, 0, 0), 0, 0.05) << iso;
        EXPECT_EQ(noise, grain.noise(320, 256, 7));
    }
}

TEST(FilmGrain, GrowsWithSpeedAndWithThePicture) {
    EXPECT_GT(FilmGrain(3200, 1080).spot(), FilmGrain(100, 1080).spot());
    EXPECT_GT(FilmGrain(800, 2160).spot(), FilmGrain(800, 1080).spot());
    EXPECT_GT(FilmGrain(200, 1080).deviation(110), FilmGrain(100, 1080).deviation(110));
}

TEST(FilmGrain, IsAddedToLumaThatIsNotRoundedAndElseToThatWhichIs) {
    Picture exact;
    exact.number = 3;
    exact.y = Plane<std::uint8_t>(64, 48, 120);
    Picture rounded = exact, none = exact;
    exact.luma = Plane<float>(64, 48, 119.75f);
    const FilmGrain grain(6400, 48);
    const Plane<float> noise = grain.noise(64, 48, 3);
    add_grain(exact, 6400);
    add_grain(rounded, 6400);
    add_grain(none, 0);
    EXPECT_EQ(none.y, Plane<std::uint8_t>(64, 48, 120));
    for (std::size_t i = 0; i < noise.size(); ++i) {
        const float expected = 119.75f + grain.deviation(119.75f) * noise.values()[i];
        EXPECT_NEAR(exact.luma.values()[i], expected, 1e-4);
        EXPECT_NEAR(exact.y.values()[i], expected, 0.501);
        EXPECT_NEAR(rounded.y.values()[i], expected + 0.25f, 0.51);
    }
}

TEST(FilmGrain, IsTakenOutOfPicturesAgain) {
    Picture exact;
    exact.number = 5;
    exact.y = Plane<std::uint8_t>(64, 48);
    exact.luma = Plane<float>(64, 48);
    for (std::size_t i = 0; i < exact.y.size(); ++i) {
        exact.y.values()[i] = static_cast<std::uint8_t>(40 + i % 160);
        exact.luma.values()[i] = static_cast<float>(exact.y.values()[i]);
    }
    Picture rounded = exact;
    rounded.luma = {};
    const Plane<std::uint8_t> before = exact.y;
    for (Picture* picture : {&exact, &rounded}) {
        add_grain(*picture, 400);
        EXPECT_NE(picture->y, before);
        take_grain(*picture, 400);
    }
    EXPECT_EQ(exact.y, before);
    for (std::size_t i = 0; i < before.size(); ++i) EXPECT_NEAR(rounded.y.values()[i], before.values()[i], 1);
}

}  // namespace
}  // namespace render2mpeg::core
