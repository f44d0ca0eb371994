// Rays to all sides from within a medium.
#include <algorithm>
#include <limits>

#include "parallel/loops.h"
#include "renderer/base/flush_denormals.h"
#include "renderer/base/stopwatch.h"
#include "renderer/gather/final_gather.h"

namespace render2mpeg::renderer {
namespace {

/// Rays that are traced before what they ask is learnt, and of one task.
constexpr std::size_t side_rays_at_once = std::size_t{1} << 19, side_rays_of_task = 512;

/// Size of cells over the length of these rays. chosen: twice that of points.
constexpr float spread_of_sides = 2.0f * cell_spread;

}  // namespace

std::vector<FinalGather::Seen> FinalGather::seen_by(std::span<const RayQuery> rays, const Stream& numbers,
                                                    bool bounces) {
    const Stopwatch timer(counts_.seconds);
    std::vector<Seen> seen(rays.size());
    RayRules rules;
    rules.brightest = sky_.brightest;
    rules.own_volume = true;
    rules.bounces = bounces;
    rules.spread = spread_of_sides;
    rules.bodies_block = bodies_block_;
    for (std::size_t from = 0; from < rays.size(); from += side_rays_at_once) {
        const std::size_t count = std::min(side_rays_at_once, rays.size() - from);
        const std::size_t tasks = (count + side_rays_of_task - 1) / side_rays_of_task;
        std::vector<std::vector<RayTerm>> terms(tasks);
        std::vector<std::vector<CellQuery>> wanted(tasks);
        std::vector<std::uint64_t> traced(tasks, 0);
        parallel::for_each(tasks, [&](std::size_t task) {
            const FlushDenormals flushed;
            const std::size_t first = from + task * side_rays_of_task;
            const std::size_t size = std::min(side_rays_of_task, from + count - first);
            std::vector<Hit> hits(size);
            posed_scene_.tracer().any_nearest(rays.subspan(first, size), hits, false);
            traced[task] += size;
            for (std::size_t k = 0; k < size; ++k) {
                const std::size_t ray = first + k;
                seen[ray].distance = hits[k].found() ? hits[k].distance : std::numeric_limits<float>::infinity();
                seen[ray].light = gather_rays_.follow(rays[ray], hits[k], rules, numbers.at(ray),
                                                      static_cast<std::uint32_t>(ray), terms[task], traced[task]);
            }
            for (RayTerm& term : terms[task])
                if ((term.cell = cache_.find(term.place.key)) == LightCells::none) wanted[task].push_back(term.place);
        });
        cache_.learn(std::move(wanted));
        for (std::size_t task = 0; task < tasks; ++task) {
            counts_.rays += traced[task];
            for (const RayTerm& term : terms[task]) {
                const std::uint32_t cell = term.cell != LightCells::none ? term.cell : cache_.index_of(term.place.key);
                seen[term.ray].light += term.weight * cache_.far_part(cell);
            }
        }
    }
    counts_.cell_rays = cache_.rays();
    return seen;
}

}  // namespace render2mpeg::renderer
