#include "renderer/gather/cell_updates.h"

#include <algorithm>
#include <utility>

#include "core/numeric.h"
#include "renderer/surface/lobe_albedo.h"

namespace render2mpeg::renderer {
namespace {

template <class Asker>
struct Ask {
    std::uint64_t key = 0;
    Asker who = nullptr;
};

/// Calls visit(askers of one key) for all keys in their order; askers of one key come in the order of tasks.
template <class Asker, class Visit>
void by_key(std::vector<Ask<Asker>>& asks, const Visit& visit) {
    std::stable_sort(asks.begin(), asks.end(), [](const auto& a, const auto& b) { return a.key < b.key; });
    for (std::size_t first = 0, last = 0; first < asks.size(); first = last) {
        while (last < asks.size() && asks[last].key == asks[first].key) ++last;
        visit(std::span(asks).subspan(first, last - first));
    }
}

}  // namespace

glm::vec3 link_scale(const CellUpdate& sums, glm::vec3 row, std::uint32_t places) {
    glm::vec3 scale;
    for (int c = 0; c < 3; ++c) scale[c] = core::divide_or(sums.albedo[c], sums.drawn[c], 0.0f);
    const glm::vec3 most((sums.fibres ? largest_fibre_albedo : largest_albedo) * static_cast<float>(places));
    return scale * (most / glm::max(scale * row, most));
}

/// Appends an update of so many places of a cell, which is made if it was not there.
CellUpdate& ShardUpdates::add(LightCells& cells, std::uint64_t key, std::uint32_t places) {
    CellUpdate& update = updates_.emplace_back();
    update.cell = cells.add_places(key, places);
    LightCell& cell = cells.at(update.cell);
    update.places = places;
    update.number = cell.places - places;
    update.earlier = std::exchange(cell.update, static_cast<std::uint32_t>(updates_.size() - 1));
    return update;
}

namespace {

/// Calls visit(key, known, chosen) for cells of a shard that are asked more often than they have places, which are
/// `known`. Chosen are the places that they lack up to `most`, evenly among those that ask.
template <class Visit>
void choose_places(std::size_t shard, std::span<const AskedPlaces> asked, std::uint32_t most, const LightCells& cells,
                   const Visit& visit) {
    std::vector<Ask<const CellQuery*>> asks;
    for (const AskedPlaces& task : asked)
        for (const AskedKeys::Entry& e : task.keys.of_shard(shard)) asks.push_back({e.key, &task.places[e.index]});
    std::vector<const CellQuery*> chosen;
    by_key(asks, [&](std::span<const Ask<const CellQuery*>> askers) {
        const std::uint64_t key = askers.front().key;
        const std::uint32_t count = std::min(static_cast<std::uint32_t>(askers.size()), most);
        const std::uint32_t known = cells.find(key).places;
        if (count <= known) return;
        chosen.resize(count - known);
        for (std::size_t i = 0; i < chosen.size(); ++i) chosen[i] = askers[i * askers.size() / chosen.size()].who;
        visit(key, known, std::span<const CellQuery* const>(chosen));
    });
}

}  // namespace

void ShardUpdates::plan(std::size_t shard, std::span<const AskedPlaces> asked, std::uint32_t most, LightCells& cells) {
    waves_.push_back(static_cast<std::uint32_t>(updates_.size()));
    places_.clear();
    choose_places(shard, asked, most, cells,
                  [&](std::uint64_t key, std::uint32_t, std::span<const CellQuery* const> chosen) {
                      const auto take = static_cast<std::uint32_t>(chosen.size());
                      add(cells, key, take).first = static_cast<std::uint32_t>(places_.size());
                      places_.insert(places_.end(), chosen.begin(), chosen.end());
                  });
}

std::vector<PathStart> starts_of(std::size_t shard, std::span<const AskedPlaces> asked, std::uint32_t most,
                                 const LightCells& cells) {
    std::vector<PathStart> starts;
    choose_places(shard, asked, most, cells,
                  [&](std::uint64_t key, std::uint32_t known, std::span<const CellQuery* const> chosen) {
                      for (std::size_t i = 0; i < chosen.size(); ++i)
                          starts.push_back({*chosen[i], Stream(Purpose::paths_of_cells, {.index = key}).at(known + i)});
                  });
    return starts;
}

void ShardUpdates::add_paths(std::size_t shard, std::span<const TaskPaths* const> paths, LightCells& cells) {
    waves_.push_back(static_cast<std::uint32_t>(updates_.size()));
    std::vector<Ask<const PathUpdate*>> asks;
    for (const TaskPaths* task : paths)
        for (const AskedKeys::Entry& e : task->keys.of_shard(shard)) asks.push_back({e.key, &task->updates[e.index]});
    by_key(asks, [&](std::span<const Ask<const PathUpdate*>> askers) {
        for (const auto& asker : askers) {
            CellUpdate& added = add(cells, asker.key, 1);
            CellUpdate update = asker.who->update;
            update.cell = added.cell;
            update.number = added.number;
            update.earlier = added.earlier;
            added = update;
        }
    });
}

}  // namespace render2mpeg::renderer
