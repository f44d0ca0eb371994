#include "renderer/cut/urgency_queue.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "core/sampling.h"

namespace render2mpeg::renderer {
namespace {

TEST(UrgencyQueue, GivesAllBackTheMostUrgentFirstWithinAFourthOfAnOctave) {
    UrgencyQueue queue;
    std::vector<float> urgency;
    for (std::uint64_t i = 0; i < 3000; ++i) urgency.push_back(std::exp2(200.0f * core::uniform(1, i, 0) - 100.0f));
    for (const float special :
         {0.0f, 1e-38f, std::numeric_limits<float>::max(), std::numeric_limits<float>::infinity()})
        urgency.push_back(special);
    for (std::uint32_t i = 0; i < urgency.size(); ++i) queue.push(urgency[i], i);
    std::vector<int> seen(urgency.size());
    float last = std::numeric_limits<float>::infinity();
    for (std::size_t n = 0; n < urgency.size(); ++n) {
        ASSERT_FALSE(queue.empty());
        const float announced = queue.urgency();
        const std::uint32_t slot = queue.front();
        ASSERT_EQ(queue.pop(), slot);
        ++seen[slot];
        EXPECT_EQ(urgency[slot], announced);
        EXPECT_LE(urgency[slot], 1.25f * last);
        last = urgency[slot];
    }
    EXPECT_TRUE(queue.empty());
    for (const int times : seen) EXPECT_EQ(times, 1);
}

TEST(UrgencyQueue, GivesEquallyUrgentOnesInTheirOrderAndTakesThemAgain) {
    UrgencyQueue queue;
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
