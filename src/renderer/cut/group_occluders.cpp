#include "renderer/cut/group_occluders.h"

#include <vector>

#include "renderer/base/isa_clones.h"
#include "renderer/tree/lane_sums.h"

namespace render2mpeg::renderer {
namespace {

/// How far inside an occluder a way must pass, as a share of its length, and how far from its plane both ends must lie,
/// as a share of the largest coordinate. chosen: 1e-4, a thousand roundings.
constexpr float margin = 1e-4f;

/// By what rounding may move a corner or an origin, as a share of the largest coordinate: some 7 ulp.
constexpr float corner_rounding = 4e-7f;

/// Occluders smaller than this solid angle are not worth asking. As a pseudo angle (see OccluderList::look_from): about
/// 0.02 sr.
constexpr float least_seen = 0.01f;

}  // namespace

void GroupOccluders::choose(const GatherLanes& lanes, const OccluderList& occluders) {
    count_ = 0;
    if (occluders.size() == 0) return;
    thread_local std::vector<float> seen;
    seen.resize(occluders.padded());
    occluders.look_from({lanes.origin.x[0], lanes.origin.y[0], lanes.origin.z[0]},
                        {lanes.geometric.x[0], lanes.geometric.y[0], lanes.geometric.z[0]}, seen.data());
    // Keep the largest, in order.
    struct Candidate {
        float seen;
        std::size_t occluder;
    };
    Candidate best[most];
    for (std::size_t i = 0; i < occluders.size(); ++i) {
        if (!(seen[i] > least_seen) || (count_ == most && !(seen[i] > best[most - 1].seen))) continue;
        int k = count_ < most ? count_++ : most - 1;
        for (; k > 0 && best[k - 1].seen < seen[i]; --k) best[k] = best[k - 1];
        best[k] = {seen[i], i};
    }
    for (int k = 0; k < count_; ++k) set(chosen_[k], lanes, occluders[best[k].occluder]);
}

RENDER2MPEG_CLONES
void GroupOccluders::set(Chosen& chosen, const GatherLanes& lanes, const Occluder& occluder) const {
    const glm::vec3 d = occluder.corner[2] - occluder.corner[0], e = occluder.corner[3] - occluder.corner[1];
    const glm::vec3 wound{d.y * e.z - d.z * e.y, d.z * e.x - d.x * e.z, d.x * e.y - d.y * e.x};
    const float length = inlined::sqrt(inlined::max(wound.x * wound.x + wound.y * wound.y + wound.z * wound.z, 1e-30f));
    chosen.normal = {wound.x / length, wound.y / length, wound.z / length};
    float scale = 0.0f, low = 1e30f, high = -1e30f;
    for (const glm::vec3& c : occluder.corner) {
        scale =
            inlined::max(scale, inlined::max(inlined::abs(c.x), inlined::max(inlined::abs(c.y), inlined::abs(c.z))));
        const float along = chosen.normal.x * c.x + chosen.normal.y * c.y + chosen.normal.z * c.z;
        low = inlined::min(low, along);
        high = inlined::max(high, along);
    }
    for (int i = 0; i < lanes.count; ++i)
        scale = inlined::max(
            scale, inlined::max(inlined::abs(lanes.origin.x[i]),
                                inlined::max(inlined::abs(lanes.origin.y[i]), inlined::abs(lanes.origin.z[i]))));
    chosen.offset = 0.5f * (low + high);
    chosen.far = margin * scale + (high - low);
    const float nx = chosen.normal.x, ny = chosen.normal.y, nz = chosen.normal.z;
    Lanes valid;
    for (int i = 0; i < lane_count; ++i) {
        const float away = chosen.offset - (nx * lanes.origin.x[i] + ny * lanes.origin.y[i] + nz * lanes.origin.z[i]);
        chosen.sign[i] = away > 0.0f ? 1.0f : -1.0f;
        valid[i] = inlined::abs(away) > chosen.far ? margin : 0.0f;
    }
    chosen.any_before = chosen.any_behind = false;
    for (int i = 0; i < lane_count; ++i) {
        chosen.any_before = chosen.any_before || (chosen.sign[i] > 0.0f && valid[i] > 0.0f);
        chosen.any_behind = chosen.any_behind || (chosen.sign[i] < 0.0f && valid[i] > 0.0f);
    }
    for (int k = 0; k < edges; ++k) {
        const glm::vec3 &a = occluder.corner[k], &b = occluder.corner[(k + 1) % 4];
        const float ux = b.x - a.x, uy = b.y - a.y, uz = b.z - a.z;
        const float edge = inlined::sqrt(ux * ux + uy * uy + uz * uz);
        const float least = corner_rounding * scale * edge;
        // A triangle's fourth edge has no length and bounds nothing: repeat the third.
        if (!(edge > 0.0f) && k > 0) {
            chosen.inward[k] = chosen.inward[k - 1];
            continue;
        }
        for (int i = 0; i < lane_count; ++i) {
            const float ax = a.x - lanes.origin.x[i], ay = a.y - lanes.origin.y[i], az = a.z - lanes.origin.z[i];
            const float cx = ay * uz - az * uy, cy = az * ux - ax * uz, cz = ax * uy - ay * ux;
            const float size = inlined::sqrt(cx * cx + cy * cy + cz * cz);
            // margin + rounding / (distance to the edge's line) is what a way must be inside by.
            const float shorter = chosen.sign[i] * valid[i] / inlined::max(margin * size + least, 1e-30f);
            chosen.inward[k].x[i] = cx * shorter;
            chosen.inward[k].y[i] = cy * shorter;
            chosen.inward[k].z[i] = cz * shorter;
        }
    }
}

RENDER2MPEG_CLONES
bool GroupOccluders::hide(const GatherLanes& lanes, LightType type, const glm::vec3& middle, const glm::vec3& half,
                          std::uint16_t& viable) const {
    const bool far_away = type == LightType::directional;
    const float keep = far_away ? 0.0f : 1.0f;
    const float mx = middle.x, my = middle.y, mz = middle.z, hx = half.x, hy = half.y, hz = half.z;
    alignas(64) Lanes x, y, z, least, hidden;
    alignas(64) std::uint32_t flags[lane_count];
    for (int i = 0; i < lane_count; ++i) {
        x[i] = mx - keep * lanes.origin.x[i];
        y[i] = my - keep * lanes.origin.y[i];
        z[i] = mz - keep * lanes.origin.z[i];
        least[i] = margin * (inlined::abs(x[i]) + inlined::abs(y[i]) + inlined::abs(z[i]) + hx + hy + hz);
        hidden[i] = -1.0f;
    }
    for (unsigned left = viable & ((1u << count_) - 1u); left != 0; left &= left - 1) {
        const int k = __builtin_ctz(left);
        const Chosen& c = chosen_[k];
        float beyond = 1.0f, before = 1.0f;
        if (!far_away) {
            const float along = c.normal.x * mx + c.normal.y * my + c.normal.z * mz - c.offset;
            const float reach =
                inlined::abs(c.normal.x) * hx + inlined::abs(c.normal.y) * hy + inlined::abs(c.normal.z) * hz + c.far;
            beyond = along - reach;
            before = -along - reach;
            // Anything before an occluder is never hidden by it, nor is any part of it.
            if (!(c.any_before && along + reach > 0.0f) && !(c.any_behind && reach - along > 0.0f)) {
                viable = static_cast<std::uint16_t>(viable & ~(1u << k));
                continue;
            }
            if (!(c.any_before && beyond > 0.0f) && !(c.any_behind && before > 0.0f)) continue;
        }
        alignas(64) Lanes inside, outside;
        for (int i = 0; i < lane_count; ++i) {
            float in = c.sign[i] > 0.0f ? beyond : before, out = 1.0f;
            for (int e = 0; e < edges; ++e) {
                const Vec3Lanes& n = c.inward[e];
                const float s = n.x[i] * x[i] + n.y[i] * y[i] + n.z[i] * z[i];
                const float r = inlined::abs(n.x[i]) * hx + inlined::abs(n.y[i]) * hy + inlined::abs(n.z[i]) * hz;
                in = inlined::min(in, s - r - least[i]);
                out = inlined::min(out, s + r);
            }
            inside[i] = in;
            outside[i] = out;
        }
        for (int i = 0; i < lane_count; ++i) hidden[i] = inlined::max(hidden[i], inside[i]);
        for (int i = 0; i < lane_count; ++i) flags[i] = outside[i] > 0.0f ? 1u : 0u;
        if (!any_of(flags)) viable = static_cast<std::uint16_t>(viable & ~(1u << k));
    }
    for (int i = 0; i < lane_count; ++i) flags[i] = hidden[i] > 0.0f ? 0u : 1u;
    return !any_of(flags);
}

}  // namespace render2mpeg::renderer
