// How gather rays of records follow light that changes [Smyk2005]. Changed: what rays meet are cells, whose light is
// solved anew, instead of anchors.
#include <algorithm>
#include <array>
#include <limits>
#include <numbers>

#include "core/color.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "parallel/loops.h"
#include "renderer/base/flush_denormals.h"
#include "renderer/base/stopwatch.h"
#include "renderer/gather/final_gather.h"
#include "renderer/gather/packed_light.h"

namespace render2mpeg::renderer {
namespace {

/// Share of a point's rays that a change may meet before all are traced anew. chosen: a quarter: things are so near
/// then that what they hide changes fast.
constexpr std::size_t most_met = 4;

/// Records, and rays, of one task.
constexpr std::size_t records_at_once = 16, rays_of_task = 256;

}  // namespace

void KeptRays::add(const KeptRays& more) {
    const float share = static_cast<float>(more.count) / static_cast<float>(count + more.count);
    for (std::size_t k = 0; k < mean.size(); ++k) mean[k] = glm::mix(mean[k], more.mean[k], share);
    count += more.count;
    rays.reserve(rays.size() + more.rays.size());
    rays.insert(rays.end(), more.rays.begin(), more.rays.end());
    is_lost = is_lost || more.is_lost;
}

std::array<glm::vec3, 3> KeptRays::sum(const SurfaceCache& cells) const {
    std::array<glm::dvec3, 3> sums{};
    for (const KeptGatherRay& ray : rays) {
        glm::vec3 brings = unpacked(ray.light);
        if (ray.has_cell()) brings *= cells.far_part(ray.cell);
        for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += long_float(ray.weights[k]) * brings;
    }
    const double share = core::divide_or(1.0, static_cast<double>(count), 0.0);
    return {glm::vec3(share * sums[0]), glm::vec3(share * sums[1]), glm::vec3(share * sums[2])};
}

void FinalGather::trace_again(std::span<KeptRays* const> kept, std::span<const std::vector<std::uint32_t>> met) {
    struct Again {
        std::uint32_t record = 0, ray = 0;
        glm::vec3 known{0};
    };
    std::vector<Again> all;
    for (std::uint32_t r = 0; r < kept.size(); ++r)
        for (const std::uint32_t ray : met[r]) all.push_back({r, ray});
    const std::size_t tasks = (all.size() + rays_of_task - 1) / rays_of_task;
    std::vector<std::vector<RayTerm>> terms(tasks);
    std::vector<std::uint64_t> traced(tasks);
    parallel::for_each(tasks, [&](std::size_t task) {
        const FlushDenormals flushed;
        const std::size_t first = task * rays_of_task, count = std::min(rays_of_task, all.size() - first);
        std::array<RayQuery, rays_of_task> queries;
        std::array<Hit, rays_of_task> hits;
        for (std::size_t i = 0; i < count; ++i) {
            const KeptRays& record = *kept[all[first + i].record];
            queries[i] = {record.origin, record.rays[all[first + i].ray].direction.unpack(),
                          std::numeric_limits<float>::infinity()};
        }
        posed_scene_.tracer().any_nearest(std::span(queries).first(count), std::span(hits).first(count), false);
        traced[task] = count;
        RayRules rules;
        rules.brightest = sky_.brightest;
        rules.bodies_block = bodies_block_;
        for (std::size_t i = 0; i < count; ++i) {
            Again& again = all[first + i];
            KeptRays& record = *kept[again.record];
            rules.near = record.extent;
            again.known = gather_rays_.follow(
                queries[i], hits[i], rules, std::numbers::pi_v<float> / static_cast<float>(std::max(record.count, 64u)),
                core::mix(record.seed + 8u * again.ray), static_cast<std::uint32_t>(first + i), terms[task],
                traced[task]);
            record.rays[again.ray].far = gather_rays_.length(hits[i]);
        }
    });
    std::vector<Sighting> wanted;
    for (std::size_t task = 0; task < tasks; ++task) {
        counts_.rays += traced[task];
        for (const RayTerm& term : terms[task])
            if (cache_.find(term.place.key) == CellTable::none) wanted.push_back(term.place);
    }
    cache_.learn(wanted);
    for (const Again& again : all) {
        KeptGatherRay& ray = kept[again.record]->rays[again.ray];
        ray.cell = CellTable::none;
        ray.light = PackedLight(again.known);
    }
    for (const std::vector<RayTerm>& of_task : terms)
        for (const RayTerm& term : of_task) {
            const Again& again = all[term.ray];
            KeptRays& record = *kept[again.record];
            record.is_lost = record.is_lost || core::luminance(again.known) > 0.0f;
            set_term(record.rays[again.ray], term);
        }
}

bool FinalGather::renew(const LightChange& change, const SkyOfRays& sky, std::span<KeptRays* const> kept) {
    const Stopwatch timer(counts_.seconds);
    sky_ = sky;
    for (const KeptRays* record : kept)
        for (const KeptGatherRay& ray : record->rays)
            if (ray.has_cell()) cache_.mark(ray.cell);
    if (!cache_.renew(change, sky.near_field)) return false;
    std::vector<std::vector<std::uint32_t>> met(kept.size());
    parallel::for_ranges(kept.size(), records_at_once, [&](std::size_t first, std::size_t last) {
        for (std::size_t r = first; r < last; ++r) {
            KeptRays& record = *kept[r];
            const SeenChange seen(change, record.origin);
            for (std::uint32_t i = 0; i < record.rays.size(); ++i)
                if (record.rays[i].cell == KeptGatherRay::own ||
                    seen.meets(record.rays[i].direction, record.rays[i].far))
                    met[r].push_back(i);
            record.is_lost = record.is_lost || most_met * met[r].size() > record.rays.size();
            if (record.is_lost) met[r].clear();
        }
    });
    trace_again(kept, met);
    parallel::for_ranges(kept.size(), records_at_once, [&](std::size_t first, std::size_t last) {
        for (std::size_t r = first; r < last; ++r) {
            KeptRays& record = *kept[r];
            const std::array<glm::vec3, 3> now = record.sum(cache_);
            for (std::size_t k = 0; k < 3; ++k) record.change[k] = now[k] - record.mean[k];
            record.mean = now;
        }
    });
    counts_.cell_rays = cache_.rays();
    return true;
}

}  // namespace render2mpeg::renderer
