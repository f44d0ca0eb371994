#include "renderer/calibration/calibration.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "renderer/calibration/audit.h"
#include "renderer/cut/gather_groups.h"

namespace render2mpeg::renderer {
namespace {

/// fit: docs/measurements.md#error-scale
constexpr std::size_t most_rounds = 2;
constexpr std::size_t largest_sample = 1024 / most_rounds;  ///< of a round
constexpr std::size_t blocks_per_sample = 4;  ///< so that lighting a sample costs a fourth of a frame at most
constexpr double audited_share = 0.02;        ///< of a frame's rays
constexpr std::size_t least_audited = 8, most_audited = 64;

/// Part of a frame with only the blocks of some pixels.
Frame blocks_of(const Frame& seen, const std::vector<LitPixel>& pixels) {
    Frame thin;
    thin.visible = seen.visible;
    thin.tiles.resize(seen.tiles.size());
    for (std::size_t i = 0; i < pixels.size();) {
        // All blocks of one tile at once, so that its points keep their order.
        const std::uint32_t tile = pixels[i].tile;
        std::set<int> blocks;
        for (; i < pixels.size() && pixels[i].tile == tile; ++i)
            blocks.insert(block_of(seen.tiles[tile][pixels[i].first].pixel, representative_sets));
        for (const GatherPoint& p : seen.tiles[tile])
            if (blocks.contains(block_of(p.pixel, representative_sets))) thin.tiles[tile].push_back(p);
    }
    return thin;
}

/// Tolerances that are so much coarser are learnt as well, for the one error scale of all. chosen: 1.5, since pictures
/// differ by type by 2 to 4; not tuned.
constexpr float coarser = 1.5f;

FrameKey key_of(const scene::Snapshot& snapshot, std::int64_t lit_frame, const core::ToleranceMap& tolerance) {
    const scene::Camera& camera = snapshot.camera;
    return {camera.to_world(), camera.lens().vertical_fov, camera.lens().y_magnification, lit_frame, tolerance.pixels};
}

/// Rays that an area lamp takes where it is seen in part.
constexpr std::size_t samples_of_lamp = 256;

std::size_t light_count(const LightTrees& light_trees) {
    std::size_t count = light_trees.exact.size() + samples_of_lamp * light_trees.lamps.size();
    for (const LightTree& tree : light_trees.trees) count += tree.lights.size();
    return count;
}

/// Pixels that a frame can afford to have gathered again.
std::size_t affordable(const LightTrees& light_trees, std::uint64_t rays) {
    const double lights = std::max(static_cast<double>(light_count(light_trees)), 1.0);
    const auto count = static_cast<std::size_t>(audited_share * static_cast<double>(rays) / lights);
    return std::clamp(count, least_audited, most_audited);
}

/// Whether a pixel's light is no single cut's: records had a part in it.
bool is_served(const LitPixel& p, const FrameLight& light) {
    const auto& tile = light[p.tile];
    return std::any_of(tile.begin() + p.first, tile.begin() + p.last, [](const PointLight& l) { return l.served; });
}

}  // namespace

float typical_share(const Frame& seen, const core::ToleranceMap& tolerance) {
    const std::vector<LitPixel> lit = lit_pixels(seen);
    constexpr std::size_t every = 7;  // are enough for a mean
    double logs = 0, count = 0;
    for (std::size_t i = 0; i < lit.size(); i += every) {
        const glm::ivec2 at = place_of(seen, lit[i]);
        const core::Tolerance& t = tolerance.pixels.at(at.x, at.y);
        const float share = t.background > 0.0f ? std::max(t.relative, t.weber_fraction()) : t.relative;
        // A tolerance of all that a dark pixel shows has no share.
        if (!(share > 0.0f && share < 1.0f)) continue;
        logs += std::log(share);
        ++count;
    }
    return count > 0 ? static_cast<float>(std::exp(logs / count)) : 0.0f;
}

std::size_t calibrate(ErrorCalibration& calibration, const LightingContext& context, CutLimits limits) {
    const Frame& seen = context.seen;
    // Too few pixels of an earlier frame are no beginning.
    if (!calibration.knows()) calibration.forget();
    const std::size_t rounds = calibration.knows() ? 1 : most_rounds;
    const std::vector<LitPixel> lit = lit_pixels(seen);
    const std::size_t wanted = std::min(largest_sample, lit.size() / lane_count / blocks_per_sample);
    if (wanted < ErrorCalibration::least_pixels) return 0;
    const std::vector<LitPixel> all = spread(lit, rounds * wanted, seen.visible.frame);
    for (std::size_t round = 0; round < rounds; ++round) {
        // Every round has its own pixels, since those that were lit twice err alike.
        std::vector<LitPixel> sample;
        for (std::size_t i = round; i < all.size(); i += rounds) sample.push_back(all[i]);
        const std::vector<glm::vec3> truth = gather_exactly(context, sample);
        limits.error_scale = calibration.value();
        ShadeCounts uncounted;
        const Frame blocks = blocks_of(seen, sample);
        const LightingContext of_blocks{context.light_trees, context.tracer, blocks,
                                        context.ungathered,  context.eye,    context.tolerance};
        const core::Radiance radiance = shade(of_blocks, gather_light(of_blocks, limits, uncounted), false, uncounted);
        calibration.learn(compare(seen, sample, truth, context.tolerance, radiance), limits.error_scale);
        calibration.settle();
    }
    return all.size();
}

std::size_t recalibrate(ErrorCalibration& calibration, const LightingContext& context, float error_scale,
                        const FrameLight& light, const core::Radiance& radiance, std::uint64_t rays) {
    if (!calibration.knows()) return 0;
    const Frame& seen = context.seen;
    std::vector<LitPixel> lit = lit_pixels(seen);
    std::erase_if(lit, [&](const LitPixel& p) { return is_served(p, light); });
    const std::vector<LitPixel> pixels = spread(lit, affordable(context.light_trees, rays), seen.visible.frame);
    calibration.learn(compare(seen, pixels, gather_exactly(context, pixels), context.tolerance, radiance), error_scale);
    return pixels.size();
}

std::size_t FilmCalibration::before(const scene::Snapshot& snapshot, std::int64_t lit_frame,
                                    const LightingContext& context, const CutLimits& limits) {
    if (snapshot.cut_before) calibration_.forget();
    const float share = typical_share(context.seen, context.tolerance);
    if (calibration_.knows() && share <= coarser * share_) return 0;
    const std::size_t pixels = calibrate(calibration_, context, limits);
    if (pixels > 0) share_ = share;
    last_[snapshot.camera.eye_number()] = key_of(snapshot, lit_frame, context.tolerance);
    return pixels;
}

std::size_t FilmCalibration::after(const scene::Snapshot& snapshot, std::int64_t lit_frame,
                                   const LightingContext& context, float error_scale, const FrameLight& light,
                                   const core::Radiance& radiance, std::uint64_t rays) {
    FrameKey key = key_of(snapshot, lit_frame, context.tolerance);
    std::optional<FrameKey>& last = last_[snapshot.camera.eye_number()];
    const bool repeats = last == key;
    last = std::move(key);
    return repeats ? 0 : recalibrate(calibration_, context, error_scale, light, radiance, rays);
}

}  // namespace render2mpeg::renderer
