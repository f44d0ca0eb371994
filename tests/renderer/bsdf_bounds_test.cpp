#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/color.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "renderer/base/lobe.h"
#include "renderer/surface/bsdf.h"

namespace render2mpeg::renderer {
namespace {

/// Counter-based random numbers of one test.
class Dice {
  public:
    explicit Dice(std::uint64_t seed) : seed_(seed) {}
    float operator()() { return core::uniform(seed_, counter_++); }
    float between(float low, float high) { return low + (high - low) * (*this)(); }
    glm::vec3 direction() { return core::sample_sphere({(*this)(), (*this)()}); }
    glm::vec3 color() { return {(*this)(), (*this)(), (*this)()}; }
    glm::vec3 point() { return {between(-1, 1), between(-1, 1), between(-1, 1)}; }

  private:
    std::uint64_t seed_;
    std::uint64_t counter_ = 0;
};

Bsdf random_bsdf(Dice& dice, int kind) {
    Bsdf b;
    if (kind != 1) b.diffuse = 0.8f * dice.color();
    if (kind != 0) {
        b.f0 = dice() < 0.5f ? glm::vec3(0.04f) : dice.color();
        b.alpha = std::pow(10.0f, dice.between(-2, 0));
        b.f90 = glm::vec3(1) + dice.between(0, 2) * b.f0;  // as multiple scattering does
    }
    return b;
}

/// Cosine bound between a unit axis and the vectors of a box about `middle`.
float box_cosine(glm::vec3 axis, glm::vec3 middle, glm::vec3 half) {
    glm::vec3 t, b;
    core::make_frame(axis, t, b);
    return lobe::cosine_bound(glm::dot(axis, middle), glm::dot(glm::abs(axis), half), glm::dot(t, middle),
                              glm::dot(glm::abs(t), half), glm::dot(b, middle), glm::dot(glm::abs(b), half));
}

/// An upper bound of luminance(f_s) x cosine over all directions to points of the box [low, high] as seen from
/// `position` [Walter2005, 5.1], from lobe.h's bounds as cuts take them; > 0 unless the box lies wholly behind the
/// surface.
float upper_bound(const Bsdf& bsdf, glm::vec3 position, glm::vec3 normal, glm::vec3 outgoing, glm::vec3 low,
                  glm::vec3 high) {
    const glm::vec3 middle = 0.5f * (low + high) - position;
    const glm::vec3 half = 0.5f * (high - low);
    const float nl = std::max(box_cosine(normal, middle, half), 0.0f);
    float bound = core::luminance(bsdf.diffuse) * lobe::inverse_pi * nl;
    if (bsdf.has_glossy()) {
        const float nv = glm::dot(normal, outgoing);
        if (!(nv > 0.0f)) return 0.0f;
        const glm::vec3 mirrored = core::normalize_or(2.0f * nv * normal - outgoing, normal);
        const lobe::BoxCosines box{nl, box_cosine(mirrored, middle, half), box_cosine(-outgoing, middle, half)};
        const float a2 = bsdf.alpha * bsdf.alpha;
        const lobe::GlossyBound glossy = lobe::glossy_bound(box, nv, a2, a2);
        bound += glossy.cosine * core::luminance(bsdf.f0 * (1.0f - glossy.schlick) + bsdf.f90 * glossy.schlick);
    }
    return bound;
}

struct Setting {
    glm::vec3 position, normal, outgoing, low, high;
};

/// A box of a size between a thousandth and the scene's, sometimes flat, about as far away or around the point.
Setting random_setting(Dice& dice) {
    Setting s;
    s.position = dice.point();
    s.normal = dice.direction();
    do s.outgoing = dice.direction();
    while (!(glm::dot(s.normal, s.outgoing) > 1e-3f));
    const float size = std::pow(10.0f, dice.between(-3, 0));
    const glm::vec3 middle = s.position + std::pow(10.0f, dice.between(-1.5f, 0.5f)) * dice.direction();
    glm::vec3 half = size * dice.color();
    if (dice() < 0.3f) half[static_cast<int>(dice() * 3)] = 0.0f;
    s.low = middle - half;
    s.high = middle + half;
    return s;
}

float true_value(const Bsdf& b, const Setting& s, glm::vec3 target) {
    const glm::vec3 l = target - s.position;
    if (!(glm::dot(l, l) > 0.0f)) return 0.0f;
    const glm::vec3 to_light = glm::normalize(l);
    return core::luminance(evaluate(b, s.normal, s.outgoing, to_light)) * std::max(glm::dot(s.normal, to_light), 0.0f);
}

class BsdfBound : public testing::TestWithParam<int> {};

TEST_P(BsdfBound, IsNeverBelowTheScatteringTowardsAnyPointOfTheBox) {
    Dice dice(10 + static_cast<std::uint64_t>(GetParam()));
    double log_slack = 0;
    int compared = 0, violations = 0;
    for (int n = 0; n < 100000; ++n) {
        const Bsdf b = random_bsdf(dice, GetParam());
        const Setting s = random_setting(dice);
        const float bound = upper_bound(b, s.position, s.normal, s.outgoing, s.low, s.high);
        float largest = 0.0f;
        for (int k = 0; k < 24; ++k) {
            glm::vec3 t = k < 8 ? glm::vec3(k & 1, k >> 1 & 1, k >> 2 & 1) : dice.color();
            largest = std::max(largest, true_value(b, s, s.low + t * (s.high - s.low)));
        }
        violations += largest > bound * 1.0005f + 1e-6f ? 1 : 0;
        // Sharp lobes hide their peak between the samples: what is not found cannot be compared.
        const glm::vec3 middle = 0.5f * (s.low + s.high) - s.position, half = 0.5f * (s.high - s.low);
        const bool small = glm::dot(half, half) < 0.1f * glm::dot(middle, middle);
        if (largest <= 1e-3f || !small || (GetParam() != 0 && b.alpha < 0.2f)) continue;
        log_slack += std::log(static_cast<double>(bound) / largest);
        ++compared;
    }
    EXPECT_EQ(violations, 0);
    ASSERT_GT(compared, 5000);
    // No slacker than so on (geometric) average: Lambert, lobe, both. Boxes here fill up to a tenth of what is in view.
    const double allowed[] = {1.1, 1.5, 1.3};
    EXPECT_LT(std::exp(log_slack / compared), allowed[GetParam()]);
}
INSTANTIATE_TEST_SUITE_P(Kinds, BsdfBound, testing::Values(0, 1, 2));

TEST(BsdfBound, ShrinksToTheValueAsTheBoxShrinksToAPoint) {
    Dice dice(20);
    double log_slack = 0;
    int compared = 0;
    for (int n = 0; n < 20000; ++n) {
        const Bsdf b = random_bsdf(dice, 2);
        Setting s = random_setting(dice);
        s.low = s.high = 0.5f * (s.low + s.high);
        const float value = true_value(b, s, s.low);
        const float bound = upper_bound(b, s.position, s.normal, s.outgoing, s.low, s.high);
        ASSERT_GE(bound * 1.0005f + 1e-6f, value);
        if (value <= 1e-3f) continue;
        log_slack += std::log(static_cast<double>(bound) / value);
        ++compared;
    }
    ASSERT_GT(compared, 1000);
    EXPECT_LT(std::exp(log_slack / compared), 1.01);
}

TEST(BsdfBound, IsZeroOnlyBehindTheSurface) {
    const Bsdf b{{0.5f, 0.5f, 0.5f}, {0.04f, 0.04f, 0.04f}, 0.3f, {}, {}, 1.5f};
    const glm::vec3 up{0, 0, 1}, out = glm::normalize(glm::vec3(1, 0, 1));
    EXPECT_EQ(upper_bound(b, {0, 0, 0}, up, out, {-1, -1, -2}, {1, 1, -1}), 0.0f);
    EXPECT_EQ(upper_bound(b, {0, 0, 0}, up, out, {-1, -1, -2}, {1, 1, 0}), 0.0f);
    EXPECT_GT(upper_bound(b, {0, 0, 0}, up, out, {5, 5, -1}, {6, 6, 0.01f}), 0.0f);
    EXPECT_GT(upper_bound(b, {0, 0, 0}, up, out, {-1, -1, -1}, {1, 1, 1}), 0.0f);
}

TEST(Bsdf, ReflectsNoMoreThanItReceives) {
    for (const float alpha : {0.05f, 0.3f, 1.0f}) {
        for (const float cosine : {1.0f, 0.5f, 0.1f}) {
            const Bsdf b{{0, 0, 0}, {1, 1, 1}, alpha, {}, {}, 1.5f};
            const glm::vec3 n{0, 0, 1}, out{std::sqrt(1 - cosine * cosine), 0, cosine};
            double sum = 0;
            const int count = 20000;
            for (int i = 0; i < count; ++i)
                sum += sample_glossy(b, n, out, {core::halton(0, i), core::halton(1, i)}).weight.y;
            // Single scattering loses what it shadows: much where the surface is rough, hardly anything where it is
            // smooth.
            EXPECT_LT(sum / count, 1.005);
            EXPECT_GT(sum / count, alpha < 0.1f ? 0.88 : 0.28);
        }
    }
}

TEST(Bsdf, SamplesItsLobeInProportion) {
    // The weight of a sample is f cos over its density: so the mean over uniform directions of f cos is that of the
    // weights.
    const Bsdf b{{0, 0, 0}, {0.6f, 0.3f, 0.1f}, 0.4f, {}, {}, 1.5f};
    const glm::vec3 n{0, 0, 1}, out = glm::normalize(glm::vec3(0.7f, 0.2f, 0.6f));
    glm::dvec3 sampled(0), integrated(0);
    const int count = 200000;
    for (int i = 0; i < count; ++i) {
        const glm::vec2 u{core::halton(0, i), core::halton(1, i)};
        sampled += sample_glossy(b, n, out, u).weight;
        const glm::vec3 l = core::sample_sphere(u);
        integrated += evaluate(b, n, out, l) * std::max(l.z, 0.0f) * (4.0f * std::numbers::pi_v<float>);
    }
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(sampled[k] / integrated[k], 1.0, 0.01);
}

TEST(Bsdf, IsReciprocal) {
    Dice dice(30);
    for (int i = 0; i < 2000; ++i) {
        const Bsdf b = random_bsdf(dice, 2);
        const Setting s = random_setting(dice);
        glm::vec3 l = dice.direction();
        if (glm::dot(l, s.normal) < 0) l = -l;
        const glm::vec3 one = evaluate(b, s.normal, s.outgoing, l), other = evaluate(b, s.normal, l, s.outgoing);
        for (int k = 0; k < 3; ++k) EXPECT_NEAR(one[k], other[k], 1e-4f * std::max(one[k], 1.0f));
    }
}

}  // namespace
}  // namespace render2mpeg::renderer
