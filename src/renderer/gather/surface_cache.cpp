#include "renderer/gather/surface_cache.h"

#include <algorithm>
#include <array>
#include <deque>
#include <span>
#include <utility>

#include "core/numeric.h"
#include "parallel/loops.h"
#include "renderer/base/flush_denormals.h"
#include "renderer/gather/cell_equations.h"

namespace render2mpeg::renderer {
namespace {

/// Tasks of a wave, and places that a task is worth.
constexpr std::size_t most_tasks = 256, least_places = 16;

/// Paths of one task.
constexpr std::size_t paths_at_once = 64;

/// Tasks whose memory one task frees.
constexpr std::size_t tasks_at_once = 32;

template <class Body>
void for_each_shard(const Body& body) {
    parallel::for_each(LightCells::shards, [&](std::size_t s) {
        const FlushDenormals flushed;
        body(s);
    });
}

}  // namespace

/// State of one call of learn.
struct SurfaceCache::Learning {
    std::vector<AskedPlaces> asked;  ///< of the wave to come
    std::vector<AskedPlaces> among;  ///< of all, among strands
    std::array<ShardUpdates, LightCells::shards> shards;
    std::deque<TaskLight> found;  ///< by wave and task
    std::size_t first_of_wave = 0;
};

void SurfaceCache::forget(NearField near_field) {
    cells_.forget();
    light_.pose(std::move(near_field));
}

/// Waves, paths, and the equations of all.
void SurfaceCache::learn(std::vector<std::vector<CellQuery>> wanted) {
    cells_.forget_own();
    Learning learning;
    learning.asked.resize(wanted.size());
    learning.among.resize(wanted.size());
    parallel::for_each(wanted.size(), [&](std::size_t part) {
        std::vector<CellQuery>& places = wanted[part];
        const auto strands =
            std::stable_partition(places.begin(), places.end(), [](const CellQuery& place) { return !place.fibre; });
        learning.among[part].places.assign(strands, places.end());
        places.erase(strands, places.end());
        learning.asked[part].places = std::move(places);
        learning.among[part].sort();
        learning.asked[part].sort();
    });
    // The last of these waves goes on as paths: from where cells have one place, one in three hundred is met by two
    // rays (Sponza), and nothing is lost by following each ray alone.
    for (std::uint32_t most = most_places; most > 1; most /= 2) {
        plan_wave(learning, most);
        evaluate_wave(learning, most / 2);
    }
    add_paths(learning);
    std::erase_if(learning.among, [](const AskedPlaces& part) { return part.places.empty(); });
    if (!learning.among.empty())
        for (const std::uint32_t most : {answering_places, most_places}) follow_paths(learning, most);
    solve(learning);
    // Memory of many small things takes its time to go.
    parallel::for_ranges(learning.found.size(), tasks_at_once, [&](std::size_t first, std::size_t last) {
        for (std::size_t t = first; t < last; ++t) learning.found[t] = {};
    });
}

void SurfaceCache::plan_wave(Learning& learning, std::uint32_t most) {
    for_each_shard([&](std::size_t s) { learning.shards[s].plan(s, learning.asked, most, cells_); });
}

void SurfaceCache::evaluate_wave(Learning& learning, std::uint32_t known) {
    std::size_t places = 0;
    for (const ShardUpdates& shard : learning.shards) places += shard.place_count();
    const std::size_t at_once = std::max(places / most_tasks, least_places);
    // Updates of one task, by their number of places.
    struct Task {
        std::size_t shard = 0;
        std::span<CellUpdate> updates;
    };
    std::vector<Task> tasks;
    for (std::size_t s = 0; s < LightCells::shards; ++s) {
        std::span<CellUpdate> left = learning.shards[s].of_last_wave();
        for (std::size_t end = at_once; !left.empty(); end += at_once) {
            const auto taken = static_cast<std::size_t>(
                std::partition_point(left.begin(), left.end(), [&](const CellUpdate& l) { return l.first < end; }) -
                left.begin());
            if (taken > 0) tasks.push_back({s, left.first(taken)});
            left = left.subspan(taken);
        }
    }
    const std::size_t first = learning.first_of_wave = learning.found.size();
    learning.found.resize(first + tasks.size());
    parallel::for_each(tasks.size(), [&](std::size_t t) {
        const FlushDenormals flushed;
        learning.found[first + t] = light_.evaluate(learning.shards[tasks[t].shard], tasks[t].updates, known, cells_);
    });
    learning.asked.clear();
    for (std::size_t t = first; t < learning.found.size(); ++t) {
        rays_ += learning.found[t].rays;
        learning.asked.push_back(std::move(learning.found[t].asked));
        if (!learning.found[t].among.places.empty()) learning.among.push_back(std::move(learning.found[t].among));
    }
}

void SurfaceCache::add_paths(Learning& learning) {
    std::vector<const ShardUpdates::TaskPaths*> paths;
    for (std::size_t t = learning.first_of_wave; t < learning.found.size(); ++t)
        paths.push_back(&learning.found[t].paths);
    for_each_shard([&](std::size_t s) { learning.shards[s].add_paths(s, paths, cells_); });
}

/// Follows paths from cells among strands.
void SurfaceCache::follow_paths(Learning& learning, std::uint32_t most) {
    std::array<std::vector<PathStart>, LightCells::shards> starts;
    for_each_shard([&](std::size_t s) { starts[s] = starts_of(s, learning.among, most, cells_); });
    std::vector<std::vector<PathStart>> tasks;
    for (const std::vector<PathStart>& of_shard : starts)
        for (std::size_t k = 0; k < of_shard.size(); ++k) {
            if (k % paths_at_once == 0) tasks.emplace_back();
            tasks.back().push_back(of_shard[k]);
        }
    const std::size_t first = learning.first_of_wave = learning.found.size();
    learning.found.resize(first + tasks.size());
    parallel::for_each(tasks.size(), [&](std::size_t t) {
        const FlushDenormals flushed;
        light_.follow_paths(std::move(tasks[t]), cells_, learning.found[first + t]);
    });
    for (std::size_t t = first; t < learning.found.size(); ++t) rays_ += learning.found[t].rays;
    add_paths(learning);
}

/// Cells of a shard that learn, by their last updates, from the last wave to the first: they are what the others ask.
struct SurfaceCache::Rows {
    std::vector<std::uint32_t> updates;
    std::vector<std::size_t> ends;  ///< by phase: the last wave is the first
};

/// The last update of a cell gets the sum of all that is known of it.
SurfaceCache::Rows SurfaceCache::rows_of(ShardUpdates& shard) {
    const std::span<CellUpdate> updates = shard.all();
    for (CellUpdate& update : updates) {
        for (std::uint32_t k = update.first_link; k < update.last_link; ++k)
            if (update.links[k].cell == LightCells::none) update.links[k].cell = cells_.find(update.links[k].key).index;
        const LightCell& cell = cells_.at(update.cell);
        const bool is_first = update.earlier == LightCells::none;
        update.known += is_first ? static_cast<float>(update.number) * cell.radiance : updates[update.earlier].known;
        update.near += is_first ? static_cast<float>(update.number) * cell.near : updates[update.earlier].near;
    }
    Rows rows;
    auto l = static_cast<std::uint32_t>(updates.size());
    for (std::size_t wave = shard.wave_count(); wave-- > 0;) {
        for (const std::uint32_t first = shard.first_of(wave); l-- > first;)
            if (cells_.at(updates[l].cell).update == l) rows.updates.push_back(l);
        ++l;
        rows.ends.push_back(rows.updates.size());
    }
    return rows;
}

namespace {

/// Calls visit(link) for all links of a cell that lead somewhere.
template <class Visit>
void links_of(std::span<const CellUpdate> updates, std::uint32_t last, const Visit& visit) {
    for (std::uint32_t l = last; l != LightCells::none; l = updates[l].earlier)
        for (std::uint32_t k = updates[l].first_link; k < updates[l].last_link; ++k)
            if (updates[l].links[k].cell != LightCells::none) visit(updates[l].links[k]);
}

/// Scales the links of a cell (link_scale).
void scale_links(std::span<const CellUpdate> updates, std::uint32_t last, std::uint32_t places) {
    CellUpdate sums;
    sums.fibres = updates[last].fibres;
    for (std::uint32_t l = last; l != LightCells::none; l = updates[l].earlier) {
        sums.albedo += updates[l].albedo;
        sums.drawn += updates[l].drawn;
    }
    glm::vec3 row(0);
    links_of(updates, last, [&](const CellLink& link) { row += link.weight; });
    const glm::vec3 scale = link_scale(sums, row, places);
    links_of(updates, last, [&](CellLink& link) { link.weight *= scale; });
}

/// Equations of cells whose last updates these are, eq. 5 of docs/model/gathering.md. Rows of cells are in
/// LightCell::update; what is known of others is put in.
EquationBlock block_of(std::span<const CellUpdate> updates, std::span<const std::uint32_t> rows,
                       const LightCells& cells) {
    EquationBlock block;
    for (const std::uint32_t last : rows) {
        const std::uint32_t places = cells.at(updates[last].cell).places;
        scale_links(updates, last, places);
        const float share = 1.0f / static_cast<float>(places);
        glm::vec3 known = updates[last].known;
        links_of(updates, last, [&](const CellLink& link) {
            const LightCell& from = cells.at(link.cell);
            if (from.update == LightCells::none)
                known += link.weight * from.radiance;
            else
                block.terms.push_back({from.update, share * link.weight});
        });
        block.constants.push_back(share * known);
        block.ends.push_back(static_cast<std::uint32_t>(block.terms.size()));
    }
    return block;
}

}  // namespace

void SurfaceCache::solve(Learning& learning) {
    constexpr std::size_t shards = LightCells::shards;
    const std::size_t waves = learning.shards[0].wave_count();
    std::array<Rows, shards> rows;
    for_each_shard([&](std::size_t s) { rows[s] = rows_of(learning.shards[s]); });
    const auto rows_in = [&](std::size_t s, std::size_t phase) {
        const std::size_t first = phase == 0 ? 0 : rows[s].ends[phase - 1];
        return std::span<const std::uint32_t>(rows[s].updates).subspan(first, rows[s].ends[phase] - first);
    };
    // Number the rows, phase by phase.
    std::vector<std::uint32_t> first_row(waves * shards);
    std::uint32_t count = 0;
    for (std::size_t b = 0; b < first_row.size(); ++b) {
        first_row[b] = count;
        count += static_cast<std::uint32_t>(rows_in(b % shards, b / shards).size());
    }
    for_each_shard([&](std::size_t s) {
        for (std::size_t phase = 0; phase < waves; ++phase) {
            std::uint32_t row = first_row[phase * shards + s];
            for (const std::uint32_t l : rows_in(s, phase)) cells_.at(learning.shards[s].all()[l].cell).update = row++;
        }
    });
    std::vector<EquationBlock> blocks(waves * shards);
    parallel::for_each(blocks.size(), [&](std::size_t b) {
        const FlushDenormals flushed;
        blocks[b] = block_of(learning.shards[b % shards].all(), rows_in(b % shards, b / shards), cells_);
        blocks[b].first_row = first_row[b];
    });
    std::vector<std::size_t> ends(waves);
    for (std::size_t phase = 0; phase < waves; ++phase) ends[phase] = (phase + 1) * shards;
    const std::vector<glm::vec3> radiance = renderer::solve(blocks, ends);
    for_each_shard([&](std::size_t s) {
        for (const std::uint32_t l : rows[s].updates) {
            LightCell& cell = cells_.at(learning.shards[s].all()[l].cell);
            cell.radiance = radiance[std::exchange(cell.update, LightCells::none)];
        }
    });
    for_each_shard([&](std::size_t s) {
        const std::span<const CellUpdate> updates = learning.shards[s].all();
        for (const std::uint32_t l : rows[s].updates) {
            glm::vec3 sum = updates[l].near;
            links_of(updates, l, [&](const CellLink& link) {
                if (link.near > 0.0f) sum += link.near * link.weight * cells_.at(link.cell).radiance;
            });
            LightCell& cell = cells_.at(updates[l].cell);
            cell.near = sum / static_cast<float>(cell.places);
        }
    });
}

}  // namespace render2mpeg::renderer
