#include "renderer/cut/refinement_queue.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "core/sampling.h"

namespace render2mpeg::renderer {
namespace {

TEST(RefinementQueue, GivesAllBackTheMostUrgentFirstWithinAFourthOfAnOctave) {
    RefinementQueue queue;
    std::vector<float> priority;
    for (std::uint64_t i = 0; i < 3000; ++i) priority.push_back(std::exp2(200.0f * core::uniform(1, i, 0) - 100.0f));
    for (const float special :
         {0.0f, 1e-38f, std::numeric_limits<float>::max(), std::numeric_limits<float>::infinity()})
        priority.push_back(special);
    for (std::uint32_t i = 0; i < priority.size(); ++i) queue.push(priority[i], i);
    std::vector<int> seen(priority.size());
    float last = std::numeric_limits<float>::infinity();
    for (std::size_t n = 0; n < priority.size(); ++n) {
        ASSERT_FALSE(queue.empty());
        const float announced = queue.priority();
        const std::uint32_t slot = queue.front();
        ASSERT_EQ(queue.pop(), slot);
        ++seen[slot];
        EXPECT_EQ(priority[slot], announced);
        EXPECT_LE(priority[slot], 1.25f * last);
        last = priority[slot];
    }
    EXPECT_TRUE(queue.empty());
    for (const int times : seen) EXPECT_EQ(times, 1);
}

TEST(RefinementQueue, GivesEquallyUrgentOnesInTheirOrderAndTakesThemAgain) {
    RefinementQueue queue;
    for (const std::uint32_t slot : {7u, 3u, 9u}) queue.push(1e15f, slot);
    EXPECT_EQ(queue.pop(), 7u);
    queue.push(1e15f, 7);
    queue.push(2.0f, 1);
    for (const std::uint32_t slot : {3u, 9u, 7u, 1u}) EXPECT_EQ(queue.pop(), slot);
    queue.push(1.0f, 5);
    queue.clear();
    EXPECT_TRUE(queue.empty());
    queue.push(1.0f, 6);
    EXPECT_EQ(queue.pop(), 6u);
    EXPECT_TRUE(queue.empty());
}

}  // namespace
}  // namespace render2mpeg::renderer
