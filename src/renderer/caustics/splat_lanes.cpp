// After [Herzog2007, eqs. 4.5, 4.6]: Epanechnikov's kernel across the photon's way, each receiver with its own cosine.
#include "renderer/caustics/splat_lanes.h"

#include "core/color.h"
#include "renderer/base/isa_clones.h"

namespace render2mpeg::renderer {
namespace {

RENDER2MPEG_ALWAYS_INLINED float along(glm::vec3 a, float x, float y, float z) {
    return a.x * x + a.y * y + a.z * z;
}

}  // namespace

RENDER2MPEG_CLONES
std::uint32_t weigh(const SplatPoints& p, const SplatQuery& q, SplatShares& out) {
    const glm::vec3 at = q.position, a = q.axes[0], b = q.axes[1], d = q.direction, n = q.normal;
    std::uint32_t any = 0;
    for (int i = 0; i < 16; ++i) {
        const float x = p.x[i] - at.x, y = p.y[i] - at.y, z = p.z[i] - at.z;
        const float u = along(a, x, y, z), v = along(b, x, y, z), distance2 = u * u + v * v;
        const float cosine = -along(d, p.shading_x[i], p.shading_y[i], p.shading_z[i]);
        const float front = -along(d, p.geometric_x[i], p.geometric_y[i], p.geometric_z[i]);
        const float facing = along(n, p.geometric_x[i], p.geometric_y[i], p.geometric_z[i]);
        const bool own =
            (p.object[i] == q.object) & (facing > q.least_facing) & (inlined::abs(along(n, x, y, z)) <= q.plane);
        const bool near = own | (inlined::abs(along(d, x, y, z)) <= q.along);
        const bool lit = (distance2 < 1.0f) & (cosine > 0.0f) & (front > 0.0f) & near;
        const float weight = q.peak * (1.0f - distance2) * cosine;
        out.weight[i] = lit ? weight : 0.0f;
        const std::uint32_t state = lit ? (own ? 1u : 2u) : 0u;
        out.state[i] = state;
        any |= state;
    }
    return any;
}

RENDER2MPEG_CLONES
void add(const SplatShares& weights, glm::vec3 flux, SplatSums& sums) {
    const float luminance = core::luminance(flux);
    for (int i = 0; i < 16; ++i) {
        const float w = weights.weight[i], l = w * luminance;
        sums.red[i] += w * flux.x;
        sums.green[i] += w * flux.y;
        sums.blue[i] += w * flux.z;
        sums.squares[i] += l * l;
    }
}

}  // namespace render2mpeg::renderer
