#include "renderer/gather/light_cells.h"

#include <algorithm>

namespace render2mpeg::renderer {

void CellTable::clear() {
    slots_.clear();
    used_ = 0;
}

CellTable::Found& CellTable::entry(std::uint64_t key) {
    if (used_ >= most_used(slots_.size())) {
        std::vector<Slot> old(std::max<std::size_t>(slots_.size() + slots_.size() / 2, 16));
        old.swap(slots_);
        for (const Slot& s : old)
            if (s.found.index != none) slots_[place_of(s.key)] = s;
    }
    Slot& slot = slots_[place_of(key)];
    if (slot.found.index == none) {
        slot = {key, {static_cast<std::uint32_t>(used_), 0}};
        ++used_;
    }
    return slot.found;
}

void CellPages::clear() {
    pages_.clear();
    used_ = 0;
}

void CellPages::add() {
    if (used_ == pages_.size() * page_cells) pages_.push_back(std::make_unique<Page>());
    ++used_;
}

void LightCells::forget() {
    for (Shard& shard : shards_) {
        shard.table.clear();
        shard.cells.clear();
    }
    forget_own();
}

void LightCells::forget_own() {
    for (Shard& shard : shards_) {
        shard.own_table.clear();
        shard.own_cells.clear();
    }
}

std::uint32_t LightCells::add_places(std::uint64_t key, std::uint32_t places) {
    const std::size_t s = shard_of(key);
    Shard& shard = shards_[s];
    const bool is_own = (key & own_cell) != 0;
    CellPages& cells = is_own ? shard.own_cells : shard.cells;
    CellTable::Found& entry = (is_own ? shard.own_table : shard.table).entry(key);
    if (entry.index == cells.size()) cells.add();
    cells[entry.index].places = entry.places += places;
    return index_in(s, is_own, entry.index);
}

}  // namespace render2mpeg::renderer
