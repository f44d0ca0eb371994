#include "renderer/audit.h"

#include <algorithm>
#include <cmath>

#include "core/color.h"
#include "core/error.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "parallel/loops.h"
#include "renderer/cut.h"
#include "renderer/lobe.h"

namespace render2mpeg::renderer {
namespace {

/// Keeps these dice apart from all others.
constexpr std::uint64_t audit_seed = 0xa0d17;

/// A pixel's gather points lie side by side in its tile.
struct Pixel {
    std::uint32_t tile = 0, first = 0, last = 0;
};

std::vector<Pixel> lit_pixels(const Seen& seen) {
    std::vector<Pixel> pixels;
    for (std::uint32_t t = 0; t < seen.tiles.size(); ++t) {
        const GatherTile& tile = seen.tiles[t];
        for (std::uint32_t i = 0; i < tile.size(); ++i) {
            if (i == 0 || tile[i].pixel != tile[i - 1].pixel) pixels.push_back({t, i, i});
            ++pixels.back().last;
        }
    }
    return pixels;
}

/// The first `count` of a shuffle.
void draw(std::vector<Pixel>& pixels, std::size_t count, std::uint64_t frame) {
    for (std::size_t i = 0; i < count; ++i) {
        const auto left = static_cast<float>(pixels.size() - i);
        const auto step = static_cast<std::size_t>(core::uniform(audit_seed, frame, i) * left);
        std::swap(pixels[i], pixels[std::min(i + step, pixels.size() - 1)]);
    }
    pixels.resize(count);
}

/// As in shade.cpp, to the last bit.
glm::vec3 scattered(const GatherPoint& p, const GatheredLight& light, int lane) {
    const Bsdf& bsdf = p.point.bsdf;
    const glm::vec3 direct = light.direct.at(lane) * lobe::inverse_pi;
    const glm::vec3 indirect = light.indirect.at(lane) * lobe::inverse_pi;
    glm::vec3 glossy(0);
    if (bsdf.has_glossy()) glossy = bsdf.f0 * light.f0.at(lane) + light.schlick.at(lane);
    return p.weight * (bsdf.diffuse * (direct + indirect) + glossy);
}

}  // namespace

std::vector<AuditedPixel> audit(const LightForest& forest, const RayTracer& tracer, const Seen& seen,
                                const core::ToleranceMap& tolerance, const core::Radiance& radiance, int count) {
    EXPECTS(count >= 0 && radiance.combined.width() == seen.visible.width());
    std::vector<Pixel> pixels = lit_pixels(seen);
    draw(pixels, std::min(pixels.size(), static_cast<std::size_t>(count)),
         static_cast<std::uint64_t>(seen.visible.frame));

    // Gather sixteen points at a time, from wherever they are: without a cut they need not be alike.
    std::vector<const GatherPoint*> points;
    for (const Pixel& p : pixels)
        for (std::uint32_t i = p.first; i < p.last; ++i) points.push_back(&seen.tiles[p.tile][i]);
    std::vector<glm::vec3> light(points.size());
    const std::size_t groups = (points.size() + lane_count - 1) / lane_count;
    parallel::for_each(groups, [&](std::size_t g) {
        const std::size_t first = g * lane_count, size = std::min<std::size_t>(lane_count, points.size() - first);
        GatherLanes lanes;
        fill(lanes, std::span(points).subspan(first, size));
        GatheredLight gathered;
        Gatherer(forest, tracer).gather_all(lanes, gathered);
        for (std::size_t i = 0; i < size; ++i)
            light[first + i] = scattered(*points[first + i], gathered, static_cast<int>(i));
    });

    std::vector<AuditedPixel> audited;
    std::size_t next = 0;
    for (const Pixel& p : pixels) {
        const int pixel = seen.tiles[p.tile][p.first].pixel, across = seen.tiles_across();
        AuditedPixel a;
        a.x = static_cast<int>(p.tile) % across * tile_size + pixel % tile_size;
        a.y = static_cast<int>(p.tile) / across * tile_size + pixel / tile_size;
        glm::vec3 sum = seen.unscattered.at(a.x, a.y);
        glm::vec3 own(0);
        for (std::uint32_t i = p.first; i < p.last; ++i) own += light[next++];
        sum += own;
        // What is not finite was replaced in the frame, and is counted there.
        if (!core::is_finite(sum)) sum = glm::vec3(0);
        a.luminance = core::luminance(glm::max(sum, glm::vec3(0)));
        a.error = std::abs(core::luminance(radiance.combined.at(a.x, a.y)) - a.luminance);
        if (!tolerance.is_reference()) {
            const core::Tolerance& t = tolerance.pixels.at(a.x, a.y);
            a.tolerance = std::max(t.absolute, t.relative * a.luminance);
        }
        audited.push_back(a);
    }
    return audited;
}

}  // namespace render2mpeg::renderer
