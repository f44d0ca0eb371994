#include "renderer/calibration/audit.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/color.h"
#include "core/error.h"
#include "core/numeric.h"
#include "parallel/loops.h"
#include "renderer/base/stream.h"
#include "renderer/cut/point_light.h"
#include "renderer/cut/reference_gather.h"

namespace render2mpeg::renderer {
namespace {

/// By how much sums over all lights differ in another order, as a share. chosen: 1e-5; 1e-6 is usual.
constexpr float rounding = 1e-5f;

}  // namespace

glm::ivec2 place_of(const Frame& seen, const LitPixel& p) {
    return seen.place_of(p.tile, seen.tiles[p.tile][p.first].pixel);
}

LitPixel pixel_at(const Frame& seen, glm::ivec2 place) {
    LitPixel p;
    p.tile = static_cast<std::uint32_t>(place.y / tile_size * seen.tiles_across() + place.x / tile_size);
    const int within = place.y % tile_size * tile_size + place.x % tile_size;
    const GatherTile& tile = seen.tiles[p.tile];
    const auto before = [](const GatherPoint& a, int b) { return a.pixel < b; };
    const auto first = std::lower_bound(tile.begin(), tile.end(), within, before),
               last = std::lower_bound(first, tile.end(), within + 1, before);
    p.first = static_cast<std::uint32_t>(first - tile.begin());
    p.last = static_cast<std::uint32_t>(last - tile.begin());
    return p;
}

std::vector<LitPixel> lit_pixels(const Frame& seen) {
    std::vector<LitPixel> pixels;
    for (std::uint32_t t = 0; t < seen.tiles.size(); ++t) {
        const GatherTile& tile = seen.tiles[t];
        for (std::uint32_t i = 0; i < tile.size(); ++i) {
            if (i == 0 || tile[i].pixel != tile[i - 1].pixel) pixels.push_back({t, i, i});
            ++pixels.back().last;
        }
    }
    return pixels;
}

std::vector<LitPixel> drawn(std::vector<LitPixel> pixels, std::size_t count, std::int64_t frame) {
    count = std::min(count, pixels.size());
    // The first of a shuffle.
    const Stream numbers(Purpose::audited_pixels, {.frame = frame});
    for (std::size_t i = 0; i < count; ++i) {
        const auto left = static_cast<float>(pixels.size() - i);
        const auto step = static_cast<std::size_t>(numbers.uniform(i) * left);
        std::swap(pixels[i], pixels[std::min(i + step, pixels.size() - 1)]);
    }
    pixels.resize(count);
    return pixels;
}

std::vector<LitPixel> drawn_with_blocks(const std::vector<LitPixel>& pixels, std::size_t count, const Frame& seen) {
    constexpr int side = 8;
    constexpr std::size_t whole = side * side;
    static_assert(tile_size % side == 0, "a block's pixels are of one tile");
    const std::size_t across = static_cast<std::size_t>(seen.visible.width()) / side + 1;
    std::vector<std::vector<LitPixel>> blocks(across * (static_cast<std::size_t>(seen.visible.height()) / side + 1));
    const auto block_of = [&](const LitPixel& p) {
        const glm::ivec2 at = place_of(seen, p) / side;
        return static_cast<std::size_t>(at.y) * across + static_cast<std::size_t>(at.x);
    };
    for (const LitPixel& p : pixels) blocks[block_of(p)].push_back(p);
    std::vector<LitPixel> firsts;
    for (const auto& block : blocks)
        if (block.size() == whole) firsts.push_back(block.front());
    std::vector<LitPixel> chosen, others;
    for (const LitPixel& first : drawn(std::move(firsts), count / (2 * whole), seen.visible.frame)) {
        std::vector<LitPixel>& block = blocks[block_of(first)];
        chosen.insert(chosen.end(), block.begin(), block.end());
        block.clear();
    }
    for (const LitPixel& p : pixels)
        if (!blocks[block_of(p)].empty()) others.push_back(p);
    others = drawn(std::move(others), count - chosen.size(), seen.visible.frame);
    chosen.insert(chosen.end(), others.begin(), others.end());
    return chosen;
}

std::vector<LitPixel> spread(const std::vector<LitPixel>& pixels, std::size_t count, std::int64_t frame) {
    count = std::min(count, pixels.size());
    std::vector<LitPixel> chosen;
    const Stream numbers(Purpose::spread_audits, {.frame = frame});
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t first = i * pixels.size() / count, last = (i + 1) * pixels.size() / count;
        const auto step = static_cast<std::size_t>(numbers.uniform(i) * static_cast<float>(last - first));
        chosen.push_back(pixels[std::min(first + step, last - 1)]);
    }
    return chosen;
}

std::vector<glm::vec3> gather_exactly(const LightingContext& context, const std::vector<LitPixel>& pixels) {
    const Frame& seen = context.seen;
    std::vector<const GatherPoint*> points;
    for (const LitPixel& p : pixels)
        for (std::uint32_t i = p.first; i < p.last; ++i) points.push_back(&seen.tiles[p.tile][i]);
    std::vector<glm::vec3> light(points.size());
    parallel::for_each(points.size(), [&](std::size_t i) {
        GatheredLight gathered;
        gather_all(context.light_trees, context.tracer, *points[i], gathered);
        light[i] = point_light(gathered, 0, *points[i]).scattered(*points[i]);
    });

    std::vector<glm::vec3> sums;
    std::size_t next = 0;
    for (const LitPixel& p : pixels) {
        glm::vec3 own(0);
        for (std::uint32_t i = p.first; i < p.last; ++i) own += light[next++];
        const glm::ivec2 place = place_of(seen, p);
        const glm::vec3 sum = context.ungathered.all().at(place.x, place.y) + own;
        // Values that are not finite were replaced in the frame, and are counted there.
        sums.push_back(core::is_finite(sum) ? glm::max(sum, glm::vec3(0)) : glm::vec3(0));
    }
    return sums;
}

AuditedPixel compare(glm::ivec2 place, glm::vec3 truth, const core::ToleranceMap& tolerance,
                     const core::Radiance& radiance) {
    AuditedPixel a;
    a.x = place.x;
    a.y = place.y;
    a.radiance = truth;
    a.luminance = core::luminance(truth);
    const glm::vec3 difference = radiance.combined.at(a.x, a.y) - truth;
    a.error = std::abs(core::luminance(difference));
    a.chroma = core::chroma(difference);
    a.capped = radiance.capped.at(a.x, a.y) != 0;
    a.tolerance = rounding * a.luminance;
    if (!tolerance.is_reference()) {
        const core::Tolerance& t = tolerance.pixels.at(a.x, a.y);
        a.tolerance = t.allows(a.luminance);
    }
    return a;
}

std::vector<AuditedPixel> compare(const Frame& seen, const std::vector<LitPixel>& pixels,
                                  const std::vector<glm::vec3>& truth, const core::ToleranceMap& tolerance,
                                  const core::Radiance& radiance) {
    EXPECTS(truth.size() == pixels.size() && radiance.combined.width() == seen.visible.width());
    std::vector<AuditedPixel> audited;
    for (std::size_t i = 0; i < pixels.size(); ++i)
        audited.push_back(compare(place_of(seen, pixels[i]), truth[i], tolerance, radiance));
    return audited;
}

}  // namespace render2mpeg::renderer
