#include "renderer/gather/light_cells.h"

#include <gtest/gtest.h>

#include <set>

#include "renderer/gather/cell_updates.h"

namespace render2mpeg::renderer {
namespace {

std::uint64_t key_of(std::uint64_t i) {
    return core::mix(i) & ~own_cell;
}

TEST(LightCells, FindWhatTheyWereTaught) {
    LightCells cells;
    std::set<std::uint32_t> indices;
    for (std::uint64_t i = 0; i < 5000; ++i) {
        EXPECT_EQ(cells.find(key_of(i)).index, LightCells::none);
        EXPECT_EQ(cells.find(key_of(i)).places, 0u);
        const std::uint32_t index = cells.add_places(key_of(i), 3);
        cells.at(index).radiance.x = static_cast<float>(i);
        indices.insert(index);
    }
    EXPECT_EQ(indices.size(), 5000u);
    for (std::uint64_t i = 0; i < 5000; ++i) {
        EXPECT_EQ(cells.add_places(key_of(i), 2), cells.find(key_of(i)).index);
        EXPECT_EQ(cells.find(key_of(i)).places, 5u);
        EXPECT_EQ(cells.at(cells.find(key_of(i)).index).places, 5u);
        EXPECT_EQ(cells.at(cells.find(key_of(i)).index).radiance.x, static_cast<float>(i));
    }
}

TEST(LightCells, ForgetThoseOfOneRayAlone) {
    LightCells cells;
    for (std::uint64_t i = 0; i < 100; ++i) {
        cells.add_places(key_of(i), 1);
        cells.add_places(key_of(i) | own_cell, 1);
    }
    cells.forget_own();
    for (std::uint64_t i = 0; i < 100; ++i) {
        EXPECT_NE(cells.find(key_of(i)).index, LightCells::none);
        EXPECT_EQ(cells.find(key_of(i) | own_cell).index, LightCells::none);
    }
    cells.forget();
    EXPECT_EQ(cells.find(key_of(1)).index, LightCells::none);
}

/// Places with these keys, as one task asks for them.
AskedPlaces asked(std::initializer_list<std::uint64_t> keys) {
    AskedPlaces task;
    for (const std::uint64_t key : keys) {
        CellQuery& s = task.places.emplace_back();
        s.key = key;
        s.size = static_cast<float>(task.places.size());
    }
    task.sort();
    return task;
}

TEST(ShardUpdates, TakeAsManyPlacesAsAskAtOnceAndNoMore) {
    const std::uint64_t key = key_of(7), other = key_of(8);
    const std::size_t shard = LightCells::shard_of(key);
    LightCells cells;
    ShardUpdates updates;
    const std::vector first{asked({key, other, key}), asked({key})};
    updates.plan(shard, first, 2, cells);
    ASSERT_GE(updates.of_last_wave().size(), 1u);
    EXPECT_EQ(cells.find(key).places, 2u);
    // Those that ask again learn nothing new, and more of them what is left.
    const std::vector again{asked({key, key})};
    updates.plan(shard, again, 2, cells);
    EXPECT_TRUE(updates.of_last_wave().empty());
    const std::vector five{asked({key, key, key, key, key})};
    updates.plan(shard, five, 4, cells);
    ASSERT_EQ(updates.of_last_wave().size(), 1u);
    const CellUpdate& more = updates.of_last_wave().front();
    EXPECT_EQ(more.places, 2u);
    EXPECT_EQ(more.number, 2u);
    EXPECT_NE(more.earlier, LightCells::none);
    EXPECT_EQ(cells.find(key).places, 4u);
    // Evenly among those that ask.
    EXPECT_EQ(updates.place(more.first).size, 1.0f);
    EXPECT_EQ(updates.place(more.first + 1).size, 3.0f);
}

TEST(LinkScale, BringsLinksToTheAlbedoAndNeverBeyondWhatSurfacesReflect) {
    CellUpdate sums;
    sums.albedo = glm::vec3(1.2f);
    sums.drawn = glm::vec3(1.5f);
    EXPECT_NEAR((link_scale(sums, glm::vec3(1.5f), 2) * 1.5f).x, 1.2f, 1e-6f);
    sums.albedo = glm::vec3(2.0f);
    EXPECT_NEAR((link_scale(sums, glm::vec3(1.5f), 2) * 1.5f).x, 1.98f, 1e-5f);
    sums.fibres = true;
    EXPECT_NEAR((link_scale(sums, glm::vec3(1.5f), 2) * 1.5f).x, 1.998f, 1e-5f);
    sums.drawn = glm::vec3(0);
    EXPECT_EQ(link_scale(sums, glm::vec3(0), 2), glm::vec3(0));
}

}  // namespace
}  // namespace render2mpeg::renderer
