#include "renderer/cache/adaptive_rays.h"

#include <algorithm>
#include <cmath>

#include "core/color.h"
#include "core/standard_error.h"
#include "parallel/loops.h"
#include "renderer/cache/changed_light.h"
#include "renderer/cache/local_regression.h"
#include "renderer/gather/ray_sums.h"

namespace render2mpeg::renderer {
namespace {

/// Rounds, and the growth of a record's rays in one. chosen: 3 and 4, from 16 rays to 1,024 at most.
constexpr int rounds = 3;
constexpr std::uint32_t most_growth = 4;

/// New records of one task.
constexpr std::size_t records_at_once = 64;

/// Light of a new record's point, by its trees and these rays.
PointLight light_of(const FrameState& frame, const NewRecord& fresh, const RayLight& rays) {
    PointLight light = fresh.trees;
    add(rays, frame.point(fresh.point), light);
    return light;
}

/// Light by the regression's sum of records.
RayLight blend(const LocalRegression& fit, const RecordStore& records) {
    RayLight light;
    for (std::size_t i = 0; i < fit.size(); ++i)
        for (std::size_t k = 0; k < light.light.size() && fit.weight(i) != 0.0f; ++k)
            light.light[k] += fit.weight(i) * records[fit.record(i)].by_rays[k];
    for (glm::vec3& part : light.light) part = glm::max(part, glm::vec3(0));
    return light;
}

/// First rays of fewer records than these tell too little of how they vary: all may have missed what is bright. Then a
/// point that fills its pixel needs so many rays at least. Not tuned.
constexpr std::size_t few_records = 8;
constexpr double least_of_few = 4.0 * pilot_rays;

/// Rays that a new record is worth in all.
std::uint32_t wanted_rays(const FrameState& frame, const NewRecord& fresh, LocalRegression& fit) {
    const IrradianceRecord& record = frame.records[fresh.record];
    const auto query = frame.query_of(fresh.point.tile, fresh.point.index);
    if (!query) return record.ray_count;
    fit.collect(*query, LocalRegression::Of::rays_light, frame.grid, frame.records, fresh.record);
    const RegressionError error = fit.estimate();
    if (!error.is_valid() || !(error.square > 0.0)) return record.ray_count;
    // The neighbours' light says what is allowed: rays that found too much by chance would allow themselves more.
    const float light = core::luminance(light_of(frame, fresh, blend(fit, frame.records)).scattered(query->point)),
                tolerance = query->tolerance.allows_noise(light) / core::errors_of_noise;
    const double has = record.ray_count, most = most_growth * has;
    if (!(tolerance > 0.0f)) return static_cast<std::uint32_t>(frame.allocation.capped(most));
    double needs =
        samples_for(tolerance * tolerance, has, frame.allocation.priced(error.square, error.of_block), variance_power);
    if (fit.size() < few_records) needs = std::max(needs, needs_by_share(query->tolerance));
    return static_cast<std::uint32_t>(std::min(frame.allocation.worth(needs), most));
}

/// Traces the first rays of records again that took other rays since: baselines need both of one instant.
void retrace_missing_pilots(FrameState& frame, std::span<const NewRecord> fresh) {
    std::vector<GatherPoint> receivers;
    std::vector<std::uint32_t> which;
    for (const NewRecord& f : fresh) {
        if (frame.records[f.record].is_pilot_now || frame.records[f.record].baseline) continue;
        receivers.push_back(plain_receiver(frame.point(f.point)));
        receivers.back().others = 0;
        which.push_back(f.record);
    }
    std::vector<const GatherPoint*> pointers;
    for (const GatherPoint& receiver : receivers) pointers.push_back(&receiver);
    retrace_pilots(frame, which, pointers);
}

}  // namespace

double needs_by_share(const PointTolerance& tolerance) {
    const double share = 1.0 / std::max(static_cast<double>(tolerance.noise), 1.0);
    return samples_for(1, least_of_few, share * share, variance_power);
}

void refine_rays(FrameState& frame, std::size_t first) {
    const std::span<const NewRecord> fresh = std::span(frame.fresh).subspan(first);
    frame.grid.extend(frame.records.all(), frame.camera());
    for (int round = 0; round < rounds; ++round) {
        // Rays more, a multiple of the first ones.
        std::vector<std::uint32_t> more(fresh.size());
        parallel::for_ranges(fresh.size(), records_at_once, [&](std::size_t begin, std::size_t end) {
            LocalRegression fit;
            for (std::size_t i = begin; i < end; ++i) {
                const std::uint32_t has = frame.records[fresh[i].record].ray_count;
                more[i] = (std::max(wanted_rays(frame, fresh[i], fit), has) - has) / pilot_rays * pilot_rays;
            }
        });
        std::vector<std::size_t> which;
        for (std::size_t i = 0; i < fresh.size(); ++i)
            if (more[i] > 0) which.push_back(i);
        if (which.empty()) break;
        std::vector<GatherRequest> requests(which.size());
        std::vector<GatherPoint> receivers(which.size());
        parallel::for_ranges(which.size(), records_at_once, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k) {
                const NewRecord& f = fresh[which[k]];
                const IrradianceRecord& record = frame.records[f.record];
                receivers[k] = plain_receiver(frame.point(f.point));
                requests[k] = request_of(receivers[k], {}, {0, 0}, frame.camera());
                requests[k].numbers = record.numbers;
                requests[k].rays = more[which[k]];
                requests[k].from = record.next_ray;
                requests[k].pool = f.pool;
            }
        });
        const std::vector<RayLight> found = frame.rays->gather(requests, frame.allocation);
        parallel::for_ranges(which.size(), records_at_once, [&](std::size_t begin, std::size_t end) {
            for (std::size_t k = begin; k < end; ++k)
                take_rays(found[k], receivers[k], frame.records.change(fresh[which[k]].record));
        });
    }
    retrace_missing_pilots(frame, fresh);
}

void reconstruct(FrameState& frame) {
    frame.grid.extend(frame.records.all(), frame.camera());
    parallel::for_ranges(frame.fresh.size(), records_at_once, [&](std::size_t begin, std::size_t end) {
        LocalRegression fit;
        for (std::size_t i = begin; i < end; ++i) {
            const NewRecord& fresh = frame.fresh[i];
            const auto query = frame.query_of(fresh.point.tile, fresh.point.index);
            if (!query) continue;
            fit.collect(*query, LocalRegression::Of::rays_light, frame.grid, frame.records, fresh.record);
            const RegressionError error = fit.estimate();
            if (!error.is_valid()) continue;
            RayLight light = blend(fit, frame.records);
            light.rays = frame.records[fresh.record].ray_count;
            glm::vec3 turned(0);
            for (std::size_t k = 0; k < fit.size(); ++k) {
                if (fit.weight(k) == 0.0f) continue;
                turned += fit.weight(k) * fit.lobe(k).turned;
                frame.records.mark_used(fit.record(k), frame.snapshot.frame);
            }
            PointLight& found = frame.tiles[fresh.point.tile].light[fresh.point.index];
            found = light_of(frame, fresh, light);
            found.error += {static_cast<float>(std::sqrt(error.square)) + turn_error * glm::length(turned)};
            found.shared += {static_cast<float>(std::sqrt(error.of_block))};
        }
    });
}

}  // namespace render2mpeg::renderer
