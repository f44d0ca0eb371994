#include "encoder/quality_control.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace render2mpeg::encoder {
namespace {

/// PSNR-HVS-M of a film of whole quantisers whose errors are `content` times the wanted one at the usual quantiser,
/// grow with its power `slope`, and are `bidirectional` times as large in B pictures.
double held(double quality, double content, double slope, double bidirectional) {
    const double usual = std::exp2((100 - quality) / 20);
    const double wanted_error = 255 * 255 * std::pow(10.0, -psnr_of_quality(quality) / 10);
    QualityControl control(quality);
    double error = 0;
    constexpr int pictures = 60;
    for (int n = 0; n < pictures; ++n) {
        const PictureType type = n == 0       ? PictureType::intra
                                 : n % 3 == 0 ? PictureType::predicted
                                              : PictureType::bidirectional;
        const double ratio = type == PictureType::intra ? 0.8 : type == PictureType::predicted ? 0.9 : 1.5;
        const double wanted = usual * ratio * control.factor();
        const double base = std::clamp(std::round(wanted), 1.0, 31.0) / ratio;
        const double its = content * wanted_error * std::pow(base / usual, slope) *
                           (type == PictureType::bidirectional ? bidirectional : 1.0);
        control.learn(type, base, its);
        error += its;
    }
    return 10 * std::log10(255.0 * 255.0 * pictures / error);
}

TEST(QualityControl, FilmsOfAnyContentComeToTheSameQuality) {
    for (const double quality : {20.0, 40.0, 60.0, 80.0})
        for (const double content : {0.6, 1.0, 2.5})
            for (const double slope : {1.6, 2.2})
                for (const double bidirectional : {0.7, 1.4})
                    EXPECT_NEAR(held(quality, content, slope, bidirectional), psnr_of_quality(quality), 0.7)
                        << quality << ' ' << content << ' ' << slope << ' ' << bidirectional;
}

TEST(QualityControl, BeginsWithTheUsualQuantiserAndForgetsAFilmAtACut) {
    QualityControl control(60);
    EXPECT_EQ(control.factor(), 1);
    control.learn(PictureType::intra, 4, 0.01);
    EXPECT_GT(control.factor(), 1.2) << "this film can be coarser";
    QualityControl next(60);
    next.expect(control);
    EXPECT_GT(next.factor(), 1.2) << "known, but not shown";
    control.forget();
    EXPECT_EQ(control.factor(), 1);
}

}  // namespace
}  // namespace render2mpeg::encoder
