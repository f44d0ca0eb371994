#pragma once
// Cells of the surface cache, found by their keys.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/archive.h"
#include "core/error.h"
#include "core/sampling.h"

namespace render2mpeg::renderer {

/// A table from keys to cells.
class CellTable {
  public:
    static constexpr std::uint32_t none = 0xffffffffu;
    /// What is known of a cell without a look at it.
    struct Found {
        std::uint32_t index = none;
        std::uint32_t places = 0;  ///< that its radiance is the mean of, those that are being evaluated among them
    };

    void clear();
    Found find(std::uint64_t key) const { return slots_.empty() ? Found{} : slots_[place_of(key)].found; }
    /// The entry of a key, made with the next index if it is not there yet; until the next call.
    Found& entry(std::uint64_t key);
    std::size_t size() const { return used_; }

    template <class A>
    friend void archive(A& a, CellTable& table) {
        auto& [slots, used] = table;
        a(slots, used);
        std::size_t taken = 0;
        bool is_within = true;
        for (const Slot& slot : slots)
            if (slot.found.index != none) ++taken, is_within = is_within && slot.found.index < used;
        if (taken != used || used > most_used(slots.size()) || !is_within)
            throw core::Error("a table of cells is damaged");
    }

  private:
    struct Slot {
        std::uint64_t key = 0;
        Found found;
    };
    /// Slots in use of so many, at most. chosen: three quarters, not tuned.
    static std::size_t most_used(std::size_t slots) { return slots - (slots + 3) / 4; }
    std::size_t place_of(std::uint64_t key) const {
        // As low bits of the hash say, since its upper ones choose the shard.
        std::size_t i = (core::mix(key) & 0xffffffffu) * slots_.size() >> 32;
        while (slots_[i].found.index != none && slots_[i].key != key) i = i + 1 < slots_.size() ? i + 1 : 0;
        return i;
    }

    std::vector<Slot> slots_;
    std::size_t used_ = 0;
};

/// Keys with this bit are of cells of one ray's own, which no other ray asks.
inline constexpr std::uint64_t own_cell = std::uint64_t{1} << 63;

/// Light of one cell: means over its places.
struct LightCell {
    glm::vec3 radiance{0}, near{0};
    std::uint32_t places = 0;                ///< that it is the mean of, those that are being evaluated among them
    std::uint32_t update = CellTable::none;  ///< of it, the last one; then its row in the equations
};

/// Cells of a shard, by index: in pages, so that none is ever moved and little is taken in advance.
class CellPages {
  public:
    void clear();
    void add();
    std::size_t size() const { return used_; }
    const LightCell& operator[](std::size_t index) const { return (*pages_[index / page_cells])[index % page_cells]; }
    LightCell& operator[](std::size_t index) { return (*pages_[index / page_cells])[index % page_cells]; }

    template <class A>
    friend void archive(A& a, CellPages& cells) {
        auto& [pages, used] = cells;
        std::uint64_t count = used;
        a(count);
        if constexpr (std::is_same_v<A, core::ArchiveReader>) {
            a.expect(count, sizeof(LightCell));
            cells.clear();
            for (std::uint64_t i = 0; i < count; ++i) cells.add();
        }
        for (std::size_t i = 0; i < count; ++i) a(cells[i]);
    }

  private:
    static constexpr std::size_t page_cells = 256;  ///< 8 KiB
    using Page = std::array<LightCell, page_cells>;

    std::vector<std::unique_ptr<Page>> pages_;
    std::size_t used_ = 0;
};

/// Cells in shards by a hash of their keys. A task that has a shard to itself may make cells there without a lock; any
/// number of tasks may read while nobody makes any. Indices depend on the order within each shard alone.
class LightCells {
  public:
    static constexpr std::size_t shards = 64;  ///< chosen: as many as the threads that are to be busy
    static constexpr std::uint32_t none = CellTable::none;

    static std::size_t shard_of(std::uint64_t key) { return core::mix(key) >> 58; }

    void forget();
    /// Forgets the cells of one ray's own.
    void forget_own();

    /// Index `none`: the cell was never made.
    CellTable::Found find(std::uint64_t key) const {
        const std::size_t s = shard_of(key);
        const bool is_own = (key & own_cell) != 0;
        CellTable::Found found = (is_own ? shards_[s].own_table : shards_[s].table).find(key);
        if (found.index != none) found.index = index_in(s, is_own, found.index);
        return found;
    }
    /// Adds `places` to a cell, which is made if it was not there. Returns its index.
    std::uint32_t add_places(std::uint64_t key, std::uint32_t places);

    const LightCell& at(std::uint32_t index) const {
        const Shard& shard = shards_[index % shards];
        return (index & own_index) != 0 ? shard.own_cells[(index & ~own_index) / shards] : shard.cells[index / shards];
    }
    LightCell& at(std::uint32_t index) { return const_cast<LightCell&>(std::as_const(*this).at(index)); }

    /// All but cells of one ray's own.
    template <class A>
    friend void archive(A& a, LightCells& cells) {
        auto& [all_shards] = cells;
        for (auto& [table, own_table, known, own_cells] : all_shards) {
            a(table, known);
            if (known.size() != table.size()) throw core::Error("a table of cells is damaged");
        }
    }

  private:
    /// Indices with this bit are of own cells.
    static constexpr std::uint32_t own_index = 1u << 31;
    struct Shard {
        CellTable table, own_table;
        CellPages cells, own_cells;
    };
    static std::uint32_t index_in(std::size_t shard, bool is_own, std::uint32_t number) {
        return static_cast<std::uint32_t>(number * shards + shard) | (is_own ? own_index : 0u);
    }

    std::array<Shard, shards> shards_;
};

}  // namespace render2mpeg::renderer
