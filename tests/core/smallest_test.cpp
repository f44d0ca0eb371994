#include "core/smallest.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/sampling.h"

namespace render2mpeg::core {
namespace {

TEST(Smallest, HoldsWhatAStableSortPutsFirst) {
    for (std::uint64_t run = 0; run < 200; ++run) {
        Smallest<int, 4> smallest;
        std::vector<std::pair<float, int>> all;
        const int count = static_cast<int>(run % 12);
        for (int i = 0; i < count; ++i) {
            const float key = std::floor(6 * uniform(run, static_cast<std::uint64_t>(i)));
            all.emplace_back(key, i);
            std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
            const auto place = std::find(all.begin(), all.end(), std::pair(key, i)) - all.begin();
            EXPECT_EQ(smallest.add(i, key), place < 4);
            ASSERT_EQ(smallest.size(), std::min(i + 1, 4));
            for (int k = 0; k < smallest.size(); ++k) {
                EXPECT_EQ(smallest[k], all[static_cast<std::size_t>(k)].second);
                EXPECT_EQ(smallest.key(k), all[static_cast<std::size_t>(k)].first);
            }
        }
        EXPECT_EQ(smallest.end() - smallest.begin(), smallest.size());
    }
}

TEST(Smallest, DropsWhatIsAboveALimitButNeverTheFirst) {
    Smallest<char, 3, int> smallest;
    for (const auto& [value, key] : {std::pair{'c', 30}, {'a', 10}, {'b', 20}}) smallest.add(value, key);
    smallest.drop_above(20);
    ASSERT_EQ(smallest.size(), 2);
    EXPECT_EQ(smallest[1], 'b');
    smallest.drop_above(5);
    ASSERT_EQ(smallest.size(), 1);
    EXPECT_EQ(smallest[0], 'a');
}

}  // namespace
}  // namespace render2mpeg::core
