#include "renderer/cut/shields.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>

#include "core/numeric.h"
#include "renderer/base/isa_clones.h"
#include "renderer/geometry/largest_triangles.h"
#include "renderer/tree/lane_sums.h"

namespace render2mpeg::renderer {
namespace {

/// How far inside a shield a way must pass, as a share of its length, and how far from its plane both ends must lie, as
/// a share of the largest coordinate. chosen: 1e-4, a thousand roundings.
constexpr float margin = 1e-4f;

/// By what rounding may move a corner or an origin, as a share of the largest coordinate: some 7 ulp.
constexpr float rounding = 4e-7f;

/// Shields smaller than this solid angle are not worth asking. As a pseudo angle (see pseudo_angle): about 0.02 sr.
constexpr float least_seen = 0.01f;

using Corner = std::tuple<float, float, float>;
Corner corner_of(glm::vec3 p) {
    return {p.x, p.y, p.z};
}

/// Whether walking around the corners always turns the same way, about `normal`.
bool is_convex(const Shield& s, glm::vec3 normal) {
    for (int k = 0; k < 4; ++k) {
        const glm::vec3 before = s.corner[(k + 3) % 4], at = s.corner[k], after = s.corner[(k + 1) % 4];
        if (!(glm::dot(glm::cross(at - before, after - at), normal) > 0.0f)) return false;
    }
    return true;
}

/// The quad of two triangles that share the edge from corner k of the first to the next; no area: it is not convex, or
/// not flat.
bool join(const scene::Triangle& a, int k, const scene::Triangle& b, Shield& quad) {
    const glm::vec3 first[3] = {a.a, a.b, a.c}, second[3] = {b.a, b.b, b.c};
    const glm::vec3 from = first[k], to = first[(k + 1) % 3], own = first[(k + 2) % 3];
    glm::vec3 other = second[0];
    for (const glm::vec3 p : second)
        if (p != from && p != to) other = p;
    const glm::vec3 na = glm::cross(a.b - a.a, a.c - a.a), nb = glm::cross(b.b - b.a, b.c - b.a);
    const float cosine =
        core::divide_or(glm::dot(na, nb), std::sqrt(glm::dot(na, na)) * std::sqrt(glm::dot(nb, nb)), 0.0f);
    if (!(std::abs(cosine) > 1.0f - 1e-6f)) return false;
    quad = {{own, from, other, to}};
    return is_convex(quad, na);
}

}  // namespace

std::vector<Shield> shields_of(const std::vector<scene::Triangle>& triangles, std::size_t count) {
    std::vector<std::uint32_t> order(triangles.size());
    std::iota(order.begin(), order.end(), 0u);
    // Two triangles make a shield at best.
    const std::size_t kept = std::min(order.size(), 2 * count);
    std::vector<float> areas;
    for (const scene::Triangle& t : triangles) areas.push_back(area2(t));
    std::partial_sort(
        order.begin(), order.begin() + static_cast<std::ptrdiff_t>(kept), order.end(),
        [&](std::uint32_t i, std::uint32_t j) { return areas[i] != areas[j] ? areas[i] > areas[j] : i < j; });
    order.resize(kept);

    std::map<std::pair<Corner, Corner>, std::size_t> open;  // edges of triangles that stand alone yet
    std::vector<Shield> shields;
    std::vector<std::uint32_t> source;
    std::vector<bool> paired;
    for (const std::uint32_t i : order) {
        const scene::Triangle& t = triangles[i];
        if (!(areas[i] > 0.0f)) break;
        const glm::vec3 corners[3] = {t.a, t.b, t.c};
        bool found = false;
        for (int k = 0; k < 3 && !found; ++k) {
            const Corner p = corner_of(corners[k]), q = corner_of(corners[(k + 1) % 3]);
            const auto edge = open.find(std::minmax(p, q));
            if (edge == open.end() || paired[edge->second]) continue;
            const std::size_t other = edge->second;
            Shield quad;
            if (!join(t, k, triangles[source[other]], quad)) continue;
            shields[other] = quad;
            paired[other] = found = true;
        }
        if (found) continue;
        for (int k = 0; k < 3; ++k)
            open.emplace(std::minmax(corner_of(corners[k]), corner_of(corners[(k + 1) % 3])), shields.size());
        shields.push_back({{t.a, t.b, t.c, t.c}});
        source.push_back(i);
        paired.push_back(false);
    }
    const auto size2 = [](const Shield& s) {
        const glm::vec3 n = glm::cross(s.corner[2] - s.corner[0], s.corner[3] - s.corner[1]);
        return glm::dot(n, n);
    };
    std::stable_sort(shields.begin(), shields.end(),
                     [&](const Shield& a, const Shield& b) { return size2(a) > size2(b); });
    if (shields.size() > count) shields.resize(count);
    return shields;
}

ShieldList::ShieldList(std::vector<Shield> shields) : shields_(std::move(shields)) {
    padded_ = (shields_.size() + 15) / 16 * 16;
    places_.assign(12 * padded_, 0.0f);
    for (std::size_t i = 0; i < shields_.size(); ++i)
        for (std::size_t k = 0; k < 4; ++k)
            for (int c = 0; c < 3; ++c)
                places_[(3 * k + static_cast<std::size_t>(c)) * padded_ + i] = shields_[i].corner[k][c];
}

namespace {

struct Away {
    float x, y, z, length;
};

/// Rises with the solid angle of a triangle between these directions. [VanOosterom1983]
RENDER2MPEG_ALWAYS_INLINED float pseudo_angle(const Away& a, const Away& b, const Away& c) {
    const float det = a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x);
    const float ab = a.x * b.x + a.y * b.y + a.z * b.z, bc = b.x * c.x + b.y * c.y + b.z * c.z,
                ca = c.x * a.x + c.y * a.y + c.z * a.z;
    const float down = a.length * b.length * c.length + ab * c.length + bc * a.length + ca * b.length;
    const float up = inlined::abs(det);
    const float sum = inlined::max(up + inlined::abs(down), 1e-30f);
    return down >= 0.0f ? up / sum : 2.0f - up / sum;
}

}  // namespace

RENDER2MPEG_CLONES
void ShieldList::look_from(glm::vec3 at, glm::vec3 normal, float* seen) const {
    const float px = at.x, py = at.y, pz = at.z, mx = normal.x, my = normal.y, mz = normal.z;
    const std::size_t n = padded_;
    const float* const places = places_.data();
    for (std::size_t i = 0; i < n; ++i) {
        Away to[4];
        float above = -1.0f;
        for (std::size_t k = 0; k < 4; ++k) {
            Away& a = to[k];
            a.x = places[3 * k * n + i] - px;
            a.y = places[(3 * k + 1) * n + i] - py;
            a.z = places[(3 * k + 2) * n + i] - pz;
            a.length = inlined::sqrt(a.x * a.x + a.y * a.y + a.z * a.z);
            above = inlined::max(above, a.x * mx + a.y * my + a.z * mz);
        }
        const float angle = pseudo_angle(to[0], to[1], to[2]) + pseudo_angle(to[0], to[2], to[3]);
        seen[i] = above > 0.0f ? angle : 0.0f;
    }
}

void GroupShields::choose(const GatherLanes& lanes, const ShieldList& shields) {
    count_ = 0;
    if (shields.size() == 0) return;
    thread_local std::vector<float> seen;
    seen.resize(shields.padded());
    shields.look_from({lanes.origin.x[0], lanes.origin.y[0], lanes.origin.z[0]},
                      {lanes.geometric.x[0], lanes.geometric.y[0], lanes.geometric.z[0]}, seen.data());
    // Keep the largest, in order.
    struct Candidate {
        float seen;
        std::size_t shield;
    };
    Candidate best[most];
    for (std::size_t i = 0; i < shields.size(); ++i) {
        if (!(seen[i] > least_seen) || (count_ == most && !(seen[i] > best[most - 1].seen))) continue;
        int k = count_ < most ? count_++ : most - 1;
        for (; k > 0 && best[k - 1].seen < seen[i]; --k) best[k] = best[k - 1];
        best[k] = {seen[i], i};
    }
    for (int k = 0; k < count_; ++k) set(chosen_[k], lanes, shields[best[k].shield]);
}

RENDER2MPEG_CLONES
void GroupShields::set(Chosen& chosen, const GatherLanes& lanes, const Shield& shield) const {
    const glm::vec3 d = shield.corner[2] - shield.corner[0], e = shield.corner[3] - shield.corner[1];
    const glm::vec3 wound{d.y * e.z - d.z * e.y, d.z * e.x - d.x * e.z, d.x * e.y - d.y * e.x};
    const float length = inlined::sqrt(inlined::max(wound.x * wound.x + wound.y * wound.y + wound.z * wound.z, 1e-30f));
    chosen.normal = {wound.x / length, wound.y / length, wound.z / length};
    float scale = 0.0f, low = 1e30f, high = -1e30f;
    for (const glm::vec3& c : shield.corner) {
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
        const glm::vec3 &a = shield.corner[k], &b = shield.corner[(k + 1) % 4];
        const float ux = b.x - a.x, uy = b.y - a.y, uz = b.z - a.z;
        const float edge = inlined::sqrt(ux * ux + uy * uy + uz * uz);
        const float least = rounding * scale * edge;
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
bool GroupShields::hide(const GatherLanes& lanes, LightType type, const glm::vec3& middle, const glm::vec3& half,
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
            // What lies before a shield is never hidden by it, nor is anything of it.
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
