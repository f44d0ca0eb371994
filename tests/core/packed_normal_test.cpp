#include "core/packed_normal.h"

#include <gtest/gtest.h>

#include "core/numeric.h"
#include "core/sampling.h"

namespace render2mpeg::core {
namespace {

double angle_between(glm::vec3 a, glm::vec3 b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

TEST(PackedNormal, IsRightTo7em5RadOverTheSphere) {
    double worst = 0;
    for (std::uint64_t i = 0; i < 100000; ++i) {
        const glm::vec3 n = sample_sphere({halton(0, i), halton(1, i)});
        worst = std::max(worst, angle_between(n, PackedNormal(n).unpack()));
    }
    EXPECT_LT(worst, 7e-5);
    EXPECT_GT(worst, 5e-5);  // two-sided: the header's figure is neither slack nor broken
}

TEST(PackedNormal, KeepsTheAxesExactly) {
    for (int axis = 0; axis < 3; ++axis)
        for (const float sign : {-1.0f, 1.0f}) {
            glm::vec3 n{0};
            n[axis] = sign;
            EXPECT_EQ(PackedNormal(n).unpack(), n);
        }
}

TEST(PackedNormal, FacesWhatItsCosineSays) {
    for (const float least : {-2.0f, -1.0f, -0.6f, 0.0f, 0.5f, 0.9f, 1.0f})
        for (std::uint64_t i = 0; i < 10000; ++i) {
            const PackedNormal n(sample_sphere({halton(0, i), halton(1, i)}));
            const glm::vec3 way = sample_sphere({halton(2, i), halton(3, i)});
            const float cosine = glm::dot(n.unpack(), way);
            if (std::abs(cosine - least) < 1e-6f) continue;
            EXPECT_EQ(n.faces(way, least), cosine > least) << cosine << " " << least;
        }
    EXPECT_TRUE(PackedNormal({0, 1, 0}).faces({1, 0, 0}, -0.5f));
    EXPECT_FALSE(PackedNormal({0, 1, 0}).faces({1, 0, 0}, 0.0f));
    EXPECT_FALSE(PackedNormal({0, 1, 0}).faces({0, -1, 0}, 0.5f));
}

TEST(PackedNormal, TakesVectorsThatAreNotUnit) {
    const glm::vec3 n = glm::normalize(glm::vec3(1, -2, -3));
    EXPECT_EQ(PackedNormal(n * 8.0f), PackedNormal(n));
}

TEST(PackedNormal, OfNothingIsStillAUnitVector) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (const PackedNormal packed : {PackedNormal(), PackedNormal(glm::vec3(0)), PackedNormal(glm::vec3(nan))})
        EXPECT_FLOAT_EQ(glm::length(packed.unpack()), 1.0f);
}

TEST(PackedNormal, TakesFourBytes) {
    EXPECT_EQ(sizeof(PackedNormal), 4u);
}

}  // namespace
}  // namespace render2mpeg::core
