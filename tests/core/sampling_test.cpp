#include "core/sampling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <vector>

#include "core/error.h"

namespace render2mpeg::core {
namespace {

/// Star discrepancy of points on [0, 1), exactly: max over i of the gap between the i-th smallest point and its rank.
double star_discrepancy(std::vector<float> points) {
    std::sort(points.begin(), points.end());
    const double n = static_cast<double>(points.size());
    double worst = 0;
    for (std::size_t i = 0; i < points.size(); ++i)
        worst = std::max({worst, static_cast<double>(i + 1) / n - points[i], points[i] - static_cast<double>(i) / n});
    return worst;
}

TEST(Mix, GivesSplitMix64sPublishedSequence) {
    // The generator's first outputs for state 1234567, whose state advances by the golden gamma. [Steele2014]
    constexpr std::uint64_t golden_gamma = 0x9e3779b97f4a7c15ull;
    const std::uint64_t expected[] = {6457827717110365317ull, 3203168211198807973ull, 9817491932198370423ull,
                                      4593380528125082431ull, 16408922859458223821ull};
    for (std::uint64_t i = 0; i < 5; ++i) EXPECT_EQ(mix(1234567 + i * golden_gamma), expected[i]);
}

TEST(Mix, ChangesHalfOfTheBitsWhenOneChanges) {
    double flipped = 0;
    for (std::uint64_t i = 0; i < 1000; ++i)
        for (int bit = 0; bit < 64; ++bit) flipped += __builtin_popcountll(mix(i) ^ mix(i ^ (1ull << bit)));
    EXPECT_NEAR(flipped / 64000, 32, 0.1);  // standard error of the mean: 4 / sqrt(64000) = 0.016
}

TEST(Uniform, HasTheMomentsOfTheUniformDistributionInEachCounter) {
    for (int counter = 0; counter < 4; ++counter) {
        const int n = 100000;
        double sum = 0, squares = 0, product = 0, before = 0;
        for (int i = 0; i < n; ++i) {
            std::uint64_t c[4] = {5, 6, 7, 8};
            c[counter] = static_cast<std::uint64_t>(i);
            const double u = uniform(c[0], c[1], c[2], c[3]);
            ASSERT_GE(u, 0);
            ASSERT_LT(u, 1);
            sum += u;
            squares += u * u;
            product += (u - 0.5) * (before - 0.5);
            before = u;
        }
        // four standard errors: 4 sqrt(1/12 / n), 4 sqrt(4/45 / n), 4 / 12 / sqrt(n)
        EXPECT_NEAR(sum / n, 1.0 / 2, 3.7e-3) << counter;
        EXPECT_NEAR(squares / n, 1.0 / 3, 3.8e-3) << counter;
        EXPECT_NEAR(product / n, 0, 1.1e-3) << counter;
    }
}

TEST(Uniform, IsAFunctionOfItsCountersAlone) {
    EXPECT_EQ(uniform(1, 2, 3, 4), uniform(1, 2, 3, 4));
    EXPECT_NE(uniform(1, 2, 3, 4), uniform(1, 3, 2, 4));
    EXPECT_NE(uniform(1, 2), uniform(2, 1));
}

TEST(Halton, InBasesTwoAndThreeIsTheRadicalInverse) {
    const float base2[] = {0, 1 / 2.0f, 1 / 4.0f, 3 / 4.0f, 1 / 8.0f, 5 / 8.0f, 3 / 8.0f, 7 / 8.0f};
    const float base3[] = {0, 1 / 3.0f, 2 / 3.0f, 1 / 9.0f, 4 / 9.0f, 7 / 9.0f, 2 / 9.0f, 5 / 9.0f};
    for (std::uint64_t i = 0; i < 8; ++i) {
        EXPECT_FLOAT_EQ(halton(0, i), base2[i]);
        EXPECT_FLOAT_EQ(halton(1, i), base3[i]);
    }
}

TEST(Halton, IsTheRadicalInverseOfAnyIndex) {
    // Digit by digit, which takes a division each.
    const auto plain = [](std::uint64_t base, std::uint64_t index) {
        double value = 0, unit = 1.0 / static_cast<double>(base);
        for (; index > 0; index /= base, unit /= static_cast<double>(base))
            value += static_cast<double>(index % base) * unit;
        return value;
    };
    for (const std::uint64_t start :
         {std::uint64_t{0}, std::uint64_t{4096 * 4096 - 50}, (std::uint64_t{1} << 52) - 50, ~std::uint64_t{0} - 99})
        for (std::uint64_t i = start; i < start + 99; ++i) {
            EXPECT_NEAR(halton(0, i), plain(2, i), 1e-7) << i;
            EXPECT_NEAR(halton(1, i), plain(3, i), 1e-7) << i;
        }
}

TEST(Halton, FillsEachDimensionEvenly) {
    // N D*_N < 3 + 1 + (b - 1) / (2 log b) log N for van der Corput sequences; permuted digits keep the bound within a
    // factor of two. [Kocis1997]; random points would have N D* near 0.87 sqrt(N) = 56.
    const std::size_t n = 4096;
    for (int dimension = 0; dimension < halton_dimensions; ++dimension) {
        std::vector<float> points(n);
        for (std::size_t i = 0; i < n; ++i) points[i] = halton(dimension, i);
        const double scaled = n * star_discrepancy(points);
        EXPECT_GE(scaled, 0.5) << dimension;
        EXPECT_LT(scaled, dimension < 16 ? 30 : 80) << dimension;
    }
}

TEST(Halton, PutsOnePointIntoEachDigitIntervalOfItsBase) {
    const int primes[] = {2, 3, 5, 7, 11, 13, 17, 19, 23, 29};
    for (int dimension = 0; dimension < 10; ++dimension) {
        const int base = primes[dimension];
        std::set<int> cells;
        for (int i = 0; i < base * base; ++i)
            cells.insert(
                static_cast<int>(std::floor(halton(dimension, static_cast<std::uint64_t>(i)) * base * base + 1e-3)));
        EXPECT_EQ(static_cast<int>(cells.size()), base * base) << "base " << base;
    }
}

TEST(Halton, NeighbouringHighDimensionsAreNotCorrelated) {
    // Plain Halton in bases 307 and 311 has a correlation above 0.9 over the first hundreds of points.
    const int n = 256;
    for (int d = 2; d + 1 < halton_dimensions; ++d) {
        double product = 0, a2 = 0, b2 = 0;
        for (std::uint64_t i = 1; i <= n; ++i) {
            const double a = halton(d, i) - 0.5, b = halton(d + 1, i) - 0.5;
            product += a * b;
            a2 += a * a;
            b2 += b * b;
        }
        EXPECT_LT(std::abs(product) / std::sqrt(a2 * b2), 0.3) << "dimensions " << d << ", " << d + 1;
    }
}

TEST(Halton, IsBelowOneForEveryIndexAndRefusesUnknownDimensions) {
    for (int dimension = 0; dimension < halton_dimensions; ++dimension) {
        EXPECT_EQ(halton(dimension, 0), 0.0f);
        EXPECT_LT(halton(dimension, ~0ull), 1.0f);
        EXPECT_GE(halton(dimension, ~0ull), 0.0f);
    }
    EXPECT_THROW(halton(-1, 0), ContractViolation);
    EXPECT_THROW(halton(halton_dimensions, 0), ContractViolation);
}

TEST(CosineHemisphere, HasTheMomentsOfItsDensity) {
    const glm::vec3 normal = glm::normalize(glm::vec3(1, -2, 0.5f));
    const std::uint64_t n = 16384;
    double mean = 0, square = 0;
    glm::dvec3 sum{0};
    for (std::uint64_t i = 0; i < n; ++i) {
        const glm::vec3 w = sample_cosine_hemisphere(normal, {halton(0, i), halton(1, i)});
        ASSERT_NEAR(glm::length(w), 1, 1e-5);
        const double c = glm::dot(w, normal);
        ASSERT_GE(c, -1e-6);
        mean += c;
        square += c * c;
        sum += w;
    }
    // E[cos] = 2/3, E[cos^2] = 1/2, and the mean vector lies on the normal.
    EXPECT_NEAR(mean / n, 2.0 / 3, 1e-3);
    EXPECT_NEAR(square / n, 0.5, 1e-3);
    EXPECT_NEAR(glm::length(sum / static_cast<double>(n) - glm::dvec3(normal) * (2.0 / 3)), 0, 2e-3);
}

TEST(Sphere, IsCoveredEvenly) {
    const std::uint64_t n = 16384;
    glm::dvec3 sum{0}, squares{0};
    for (std::uint64_t i = 0; i < n; ++i) {
        const glm::dvec3 w = sample_sphere({halton(0, i), halton(1, i)});
        ASSERT_NEAR(glm::length(w), 1, 1e-6);
        sum += w;
        squares += w * w;
    }
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(sum[axis] / n, 0, 1e-3);
        EXPECT_NEAR(squares[axis] / n, 1.0 / 3, 1e-3);
    }
}

TEST(Triangle, IsCoveredEvenly) {
    const std::uint64_t n = 16384;
    glm::dvec2 sum{0};
    int corner = 0;  // u > 1/2: a quarter of the area
    for (std::uint64_t i = 0; i < n; ++i) {
        const glm::vec2 b = sample_triangle({halton(0, i), halton(1, i)});
        ASSERT_GE(b.x, 0);
        ASSERT_GE(b.y, 0);
        ASSERT_LE(b.x + b.y, 1 + 1e-6);
        sum += b;
        corner += b.x > 0.5f;
    }
    EXPECT_NEAR(sum.x / n, 1.0 / 3, 1e-3);
    EXPECT_NEAR(sum.y / n, 1.0 / 3, 1e-3);
    EXPECT_NEAR(static_cast<double>(corner) / n, 0.25, 2e-3);
}

TEST(Frame, IsOrthonormalAndRightHandedEverywhere) {
    std::vector<glm::vec3> normals = {{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, -1, 0}, {1e-20f, 0, -1}, {0, 1e-20f, 1}};
    for (std::uint64_t i = 0; i < 10000; ++i) normals.push_back(sample_sphere({halton(0, i), halton(1, i)}));
    for (const glm::vec3 n : normals) {
        glm::vec3 t, b;
        make_frame(n, t, b);
        EXPECT_NEAR(glm::length(t), 1, 1e-5);
        EXPECT_NEAR(glm::length(b), 1, 1e-5);
        EXPECT_NEAR(glm::dot(t, b), 0, 1e-5);
        EXPECT_NEAR(glm::dot(t, n), 0, 1e-5);
        EXPECT_NEAR(glm::length(glm::cross(t, b) - n), 0, 1e-5);
    }
}

}  // namespace
}  // namespace render2mpeg::core
