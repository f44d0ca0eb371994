#pragma once
// Plans at which places cells of the surface cache are evaluated.
#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "renderer/gather/gather_ray.h"
#include "renderer/gather/light_cells.h"

namespace render2mpeg::renderer {

/// Light that one cell takes over from another: weight times its radiance.
struct CellLink {
    std::uint64_t key = 0;
    glm::vec3 weight{0};
    float near = 0;  ///< share of it that near_light has
    std::uint32_t cell = LightCells::none;
};

/// A cell that is being learnt.
struct CellUpdate {
    std::uint32_t cell = LightCells::none;
    std::uint32_t first = 0, places = 0;          ///< of the places that are evaluated
    std::uint32_t number = 0;                     ///< of the first, among all that the cell ever had
    std::uint32_t earlier = LightCells::none;     ///< update of the same cell
    std::uint32_t first_link = 0, last_link = 0;  ///< of those of its task, once they are evaluated
    glm::vec3 known{0}, near{0};                  ///< sums over places
    glm::vec3 albedo{0}, drawn{0};                ///< likewise, of surfaces and of weights of the rays they send
    bool fibres = false;                          ///< places are of hair
    CellLink* links = nullptr;                    ///< of its task
};

/// As largest_albedo, of fibres, among which light stays for many of them. chosen: 0.999; white hair lacks a thousandth
/// for each.
inline constexpr float largest_fibre_albedo = 0.999f;

/// Factor of the weights of a cell's links, whose sum is `row`: they come to the albedo of its places, and no cell
/// reflects more than surfaces do. Else the equations have no solution. `sums` has albedo and drawn of all its updates.
glm::vec3 link_scale(const CellUpdate& sums, glm::vec3 row, std::uint32_t places);

/// An update of one place, on a path that one task follows: its cell is made when the path has ended.
struct PathUpdate {
    std::uint64_t key = 0;
    std::uint32_t next = LightCells::none;  ///< path update of the same task that its ray meets
    CellUpdate update;
};

/// Keys that one task asks for, by shard.
class AskedKeys {
  public:
    struct Entry {
        std::uint64_t key = 0;
        std::uint32_t index = 0;  ///< of who asks, within the task
    };

    /// `key_of(i)`: of those 0 to count.
    template <class KeyOf>
    AskedKeys(std::size_t count, const KeyOf& key_of) : entries_(count) {
        for (std::size_t i = 0; i < count; ++i) ++first_[LightCells::shard_of(key_of(i)) + 1];
        for (std::size_t s = 0; s < LightCells::shards; ++s) first_[s + 1] += first_[s];
        std::array<std::uint32_t, LightCells::shards + 1> next = first_;
        for (std::size_t i = 0; i < count; ++i)
            entries_[next[LightCells::shard_of(key_of(i))]++] = {key_of(i), static_cast<std::uint32_t>(i)};
    }
    AskedKeys() = default;

    /// In their order.
    std::span<const Entry> of_shard(std::size_t s) const {
        return std::span(entries_).subspan(first_[s], first_[s + 1] - first_[s]);
    }

  private:
    std::vector<Entry> entries_;
    std::array<std::uint32_t, LightCells::shards + 1> first_{};
};

/// Places that one task asks for.
struct AskedPlaces {
    std::vector<CellQuery> places;
    AskedKeys keys;

    /// Once all places are there.
    void sort() {
        keys = AskedKeys(places.size(), [&](std::size_t i) { return places[i].key; });
    }
};

/// A place where a path begins.
struct PathStart {
    CellQuery place;
    Stream numbers;  ///< of the whole path
};

/// Places where paths are to begin in cells of one shard, chosen as those of a wave.
std::vector<PathStart> starts_of(std::size_t shard, std::span<const AskedPlaces> asked, std::uint32_t most,
                                 const LightCells& cells);

/// Updates of the cells of one shard, wave by wave; only one task may change them.
class ShardUpdates {
  public:
    /// Plans a wave. Chooses the places that cells are evaluated at among those where rays met them, evenly, `most` at
    /// most. A cell has as many as ever asked at once, so that asking again teaches nothing: frames that are alike
    /// stay alike. Forgets the places of the wave before.
    void plan(std::size_t shard, std::span<const AskedPlaces> asked, std::uint32_t most, LightCells& cells);

    /// Adds updates of paths, as a wave: of each task its updates and their keys.
    struct TaskPaths {
        std::vector<PathUpdate> updates;
        AskedKeys keys;
    };
    void add_paths(std::size_t shard, std::span<const TaskPaths* const> paths, LightCells& cells);

    std::span<CellUpdate> all() { return updates_; }
    std::span<CellUpdate> of_last_wave() { return std::span(updates_).subspan(waves_.back()); }
    std::size_t wave_count() const { return waves_.size(); }
    /// Index of a wave's first update.
    std::uint32_t first_of(std::size_t wave) const { return waves_[wave]; }
    /// Place of the last wave: CellUpdate::first is its index.
    const CellQuery& place(std::size_t index) const { return *places_[index]; }
    std::size_t place_count() const { return places_.size(); }

  private:
    CellUpdate& add(LightCells& cells, std::uint64_t key, std::uint32_t places);

    std::vector<CellUpdate> updates_;
    std::vector<std::uint32_t> waves_;
    std::vector<const CellQuery*> places_;
};

}  // namespace render2mpeg::renderer
