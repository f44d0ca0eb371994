// Gradients of irradiance [Render2MPEG, 6.9, 6.22-6.26]. Changed: the rotational one is the irradiance vector, which is
// the same to first order and has no sign to mistake; lights on surfaces are discs, G = cos cos / (d^2 + r^2) on their
// axes, since what single points near by change by is the points' doing, not the surface's. Where the clamp holds light
// counts as constant, as do a lamp's range and cone.
#include "renderer/cut/light_slopes.h"

#include "renderer/base/isa_clones.h"
#include "renderer/base/lobe.h"

namespace render2mpeg::renderer {
namespace {

/// What unit intensity changes by.
struct LaneSlope {
    float px, py, pz;  ///< with place
    float nx, ny, nz;  ///< with the normal
};

struct SlopeLight {
    float x, y, z, nx, ny, nz, disc2, largest_g;
    float range2, spot_scale, spot_offset;
};

template <LightFamily family>
RENDER2MPEG_ALWAYS_INLINED LaneSlope slope_of(const GatherLanes& lanes, int i, const SlopeLight& l) {
    const float nx = lanes.normal.axis.x[i], ny = lanes.normal.axis.y[i], nz = lanes.normal.axis.z[i];
    float x = l.x, y = l.y, z = l.z;
    if constexpr (family == LightFamily::directional) {
        const bool lit = nx * x + ny * y + nz * z > 0.0f &&
                         lanes.geometric.x[i] * x + lanes.geometric.y[i] * y + lanes.geometric.z[i] * z > 0.0f;
        return {0.0f, 0.0f, 0.0f, lit ? x : 0.0f, lit ? y : 0.0f, lit ? z : 0.0f};
    }
    x -= lanes.position.x[i];
    y -= lanes.position.y[i];
    z -= lanes.position.z[i];
    const float r2 = inlined::max(x * x + y * y + z * z, 1e-12f);
    const float a = nx * x + ny * y + nz * z;
    const float front = lanes.geometric.x[i] * x + lanes.geometric.y[i] * y + lanes.geometric.z[i] * z;
    const float b = -(l.nx * x + l.ny * y + l.nz * z);
    if constexpr (family == LightFamily::oriented) {
        const float soft = r2 + l.disc2, inverse2 = 1.0f / r2, scale = inverse2 / soft;
        const bool lit = a > 0.0f && front > 0.0f && b > 0.0f && a * b * inverse2 * inverse2 <= l.largest_g;
        const float k = 2.0f * a * b * (inverse2 + 1.0f / soft), m = lit ? scale : 0.0f;
        return {m * (a * l.nx - b * nx + k * x),
                m * (a * l.ny - b * ny + k * y),
                m * (a * l.nz - b * nz + k * z),
                m * b * x,
                m * b * y,
                m * b * z};
    }
    const float inverse = 1.0f / inlined::sqrt(r2), inverse2 = inverse * inverse;
    const float reach2 = r2 / l.range2;
    const float window = inlined::min(inlined::max(1.0f - reach2 * reach2, 0.0f), 1.0f);
    const float spot = inlined::min(inlined::max(b * inverse * l.spot_scale + l.spot_offset, 0.0f), 1.0f);
    const float m = a > 0.0f && front > 0.0f ? window * spot * spot * inverse2 * inverse : 0.0f;
    const float k = 3.0f * a * inverse2;
    return {m * (k * x - nx), m * (k * y - ny), m * (k * z - nz), m * x, m * y, m * z};
}

template <LightFamily family>
RENDER2MPEG_ALWAYS_INLINED void add_lanes(const GatherLanes& __restrict lanes, const StandIn& light, float scale,
                                          const Vec3Lanes& __restrict visible, SlopeLanes& __restrict out) {
    float nx = 0, ny = 0, nz = 0;
    unpack_normal(light.light->axis, nx, ny, nz);
    const TreeLight& t = *light.light;
    const SlopeLight l{t.position.x,
                       t.position.y,
                       t.position.z,
                       nx,
                       ny,
                       nz,
                       t.disc2,
                       scale / inlined::max(t.disc2, lobe::tiny * scale),
                       t.disc2,
                       light.spot != nullptr ? light.spot->scale : 0.0f,
                       light.spot != nullptr ? light.spot->offset : 1.0f};
    const float red = light.intensity.x, green = light.intensity.y, blue = light.intensity.z;
    for (int i = 0; i < lane_count; ++i) {
        const LaneSlope s = slope_of<family>(lanes, i, l);
        const float r = red * visible.x[i], g = green * visible.y[i], b = blue * visible.z[i];
        out.by_place[0].x[i] += r * s.px;
        out.by_place[0].y[i] += r * s.py;
        out.by_place[0].z[i] += r * s.pz;
        out.by_place[1].x[i] += g * s.px;
        out.by_place[1].y[i] += g * s.py;
        out.by_place[1].z[i] += g * s.pz;
        out.by_place[2].x[i] += b * s.px;
        out.by_place[2].y[i] += b * s.py;
        out.by_place[2].z[i] += b * s.pz;
        out.by_normal[0].x[i] += r * s.nx;
        out.by_normal[0].y[i] += r * s.ny;
        out.by_normal[0].z[i] += r * s.nz;
        out.by_normal[1].x[i] += g * s.nx;
        out.by_normal[1].y[i] += g * s.ny;
        out.by_normal[1].z[i] += g * s.nz;
        out.by_normal[2].x[i] += b * s.nx;
        out.by_normal[2].y[i] += b * s.ny;
        out.by_normal[2].z[i] += b * s.nz;
    }
}

}  // namespace

RENDER2MPEG_CLONES
void add_slopes(const GatherLanes& lanes, LightFamily family, const StandIn& light, GeometryClamp clamp,
                const Vec3Lanes& visible, SlopeLanes& out) {
    if (family == LightFamily::oriented)
        add_lanes<LightFamily::oriented>(lanes, light, clamp.scale, visible, out);
    else if (family == LightFamily::punctual)
        add_lanes<LightFamily::punctual>(lanes, light, clamp.scale, visible, out);
    else
        add_lanes<LightFamily::directional>(lanes, light, clamp.scale, visible, out);
}

}  // namespace render2mpeg::renderer
