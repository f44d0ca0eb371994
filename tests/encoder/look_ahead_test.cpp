#include "encoder/look_ahead.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <memory>

#include "film.h"

namespace render2mpeg::encoder {
namespace {

using namespace testing;

constexpr int width = 192, height = 128;

/// Knows so many pictures, and that no more follow.
std::unique_ptr<LookAhead> looks_at(int pictures, const std::function<core::Picture(std::int64_t)>& picture) {
    auto ahead = std::make_unique<LookAhead>(width, height, 3);
    for (int n = 0; n < pictures; ++n) ahead->add(picture(n));
    ahead->end();
    return ahead;
}

/// Clouds that slide; others in each scene.
core::Picture scene(std::int64_t n, int which, double step = 2) {
    return paint(width, height, n, [&](int plane, double x, double y) {
        return clouds(plane, x + 777 * which - step * static_cast<double>(n), y + 313 * which);
    });
}

TEST(LookAhead, FindsCuts) {
    const auto ahead = looks_at(8, [](std::int64_t n) { return scene(n, n < 3 ? 0 : n < 6 ? 1 : 2); });
    for (int n = 0; n < 8; ++n) EXPECT_EQ(ahead->cut_before(n), n == 3 || n == 6) << n;
    EXPECT_EQ(ahead->frames_left(0), 2);
    EXPECT_EQ(ahead->frames_left(3), 2);
    EXPECT_EQ(ahead->frames_left(7), 0);
}

TEST(LookAhead, PromisesNoEndThatItDoesNotSee) {
    LookAhead ahead(width, height, 3);
    for (int n = 0; n < 6; ++n) ahead.add(scene(n, n < 3 ? 0 : 1));
    EXPECT_EQ(ahead.frames_left(1), 1) << "a cut";
    EXPECT_EQ(ahead.frames_left(4), std::nullopt) << "not seen";
    ahead.end();
    EXPECT_EQ(ahead.frames_left(4), 1) << "the end";
}

TEST(LookAhead, TakesAFlashAFadeOrNoiseForNoCut) {
    const auto flash = [](std::int64_t n) { return n == 4 ? scene(n, 5) : scene(n, 0); };
    const auto fade = [](std::int64_t n) {
        core::Picture picture = scene(n, 0);
        for (std::uint8_t& v : picture.y.values()) v = static_cast<std::uint8_t>(16 + (v - 16) * n / 8);
        return picture;
    };
    const auto grain = [](std::int64_t n) { return noise(width, height, n, static_cast<std::uint64_t>(n)); };
    for (const auto& picture : {std::function<core::Picture(std::int64_t)>(flash), {fade}, {grain}}) {
        const auto ahead = looks_at(9, picture);
        for (int n = 0; n < 9; ++n) EXPECT_FALSE(ahead->cut_before(n)) << n << ", alone " << int{picture(n).y.at(9, 9)};
        EXPECT_EQ(ahead->frames_left(0), 8);
    }
}

TEST(LookAhead, PutsBPicturesWhereTheyPay) {
    EXPECT_EQ(looks_at(9, [](std::int64_t n) { return scene(n, 0); })->b_pictures(0, 8), 3);
    EXPECT_EQ(looks_at(9, [](std::int64_t n) { return scene(n, 0); })->b_pictures(0, 2), 1);
    // Each picture is the one before with more of another: what lies between two is no better than what lies before.
    EXPECT_EQ(looks_at(9, [](std::int64_t n) { return scene(n, static_cast<int>(n)); })->b_pictures(7, 8), 0);
}

TEST(LookAhead, PutsOneBPictureBetweenTwoOthersWhereLightChangesNotWhereNoiseDoes) {
    const auto lit = [](std::int64_t n, double more, int grain) {
        core::Picture picture = scene(n, 0, 0);
        const core::Picture speckles = noise(width, height, n, static_cast<std::uint64_t>(n));
        for (std::size_t i = 0; i < picture.y.size(); ++i) {
            const double v = picture.y.values()[i] * (1 + more * static_cast<double>(n)) +
                             grain * (speckles.y.values()[i] - 128) / 128.0;
            picture.y.values()[i] = static_cast<std::uint8_t>(std::clamp(v, 16.0, 235.0));
        }
        return picture;
    };
    EXPECT_EQ(looks_at(9, [&](std::int64_t n) { return lit(n, 0.01, 0); })->b_pictures(0, 8), 1);
    EXPECT_EQ(looks_at(9, [&](std::int64_t n) { return lit(n, 0.01, 12); })->b_pictures(0, 8), 1);
    EXPECT_EQ(looks_at(9, [&](std::int64_t n) { return lit(n, 0, 12); })->b_pictures(0, 8), 3);
}

TEST(LookAhead, FindsMotion) {
    const auto ahead = looks_at(5, [](std::int64_t n) { return scene(n, 0, 6); });
    for (const std::int64_t reference : {0, 1, 3, 4}) {
        const core::MotionField field = ahead->motion(2, reference);
        EXPECT_EQ(field.reference, reference);
        int right = 0;
        for (int y = 32; y < 96; y += 32)
            for (int x = 32; x < 160; x += 32)
                right +=
                    glm::distance(field.vector.at(x, y), glm::vec2(6 * static_cast<float>(reference - 2), 0)) < 2.1f;
        EXPECT_GE(right, 7) << reference;
    }
}

}  // namespace
}  // namespace render2mpeg::encoder
