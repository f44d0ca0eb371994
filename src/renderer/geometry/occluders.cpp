#include "renderer/geometry/occluders.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>

#include "core/numeric.h"
#include "renderer/base/isa_clones.h"
#include "renderer/geometry/largest_triangles.h"

namespace render2mpeg::renderer {
namespace {

using Corner = std::tuple<float, float, float>;
Corner corner_of(glm::vec3 p) {
    return {p.x, p.y, p.z};
}

/// Whether walking around the corners always turns the same way, about `normal`.
bool is_convex(const Occluder& s, glm::vec3 normal) {
    for (int k = 0; k < 4; ++k) {
        const glm::vec3 before = s.corner[(k + 3) % 4], at = s.corner[k], after = s.corner[(k + 1) % 4];
        if (!(glm::dot(glm::cross(at - before, after - at), normal) > 0.0f)) return false;
    }
    return true;
}

/// The quad of two triangles that share the edge from corner k of the first to the next; no area: it is not convex, or
/// not flat.
bool join(const scene::Triangle& a, int k, const scene::Triangle& b, Occluder& quad) {
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

std::vector<Occluder> occluders_of(const std::vector<scene::Triangle>& triangles, std::size_t count) {
    std::vector<std::uint32_t> order(triangles.size());
    std::iota(order.begin(), order.end(), 0u);
    // Two triangles make an occluder at best.
    const std::size_t kept = std::min(order.size(), 2 * count);
    std::vector<float> areas;
    for (const scene::Triangle& t : triangles) areas.push_back(area2(t));
    std::partial_sort(
        order.begin(), order.begin() + static_cast<std::ptrdiff_t>(kept), order.end(),
        [&](std::uint32_t i, std::uint32_t j) { return areas[i] != areas[j] ? areas[i] > areas[j] : i < j; });
    order.resize(kept);

    std::map<std::pair<Corner, Corner>, std::size_t> open;  // edges of triangles that stand alone yet
    std::vector<Occluder> occluders;
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
            Occluder quad;
            if (!join(t, k, triangles[source[other]], quad)) continue;
            occluders[other] = quad;
            paired[other] = found = true;
        }
        if (found) continue;
        for (int k = 0; k < 3; ++k)
            open.emplace(std::minmax(corner_of(corners[k]), corner_of(corners[(k + 1) % 3])), occluders.size());
        occluders.push_back({{t.a, t.b, t.c, t.c}});
        source.push_back(i);
        paired.push_back(false);
    }
    const auto size2 = [](const Occluder& s) {
        const glm::vec3 n = glm::cross(s.corner[2] - s.corner[0], s.corner[3] - s.corner[1]);
        return glm::dot(n, n);
    };
    std::stable_sort(occluders.begin(), occluders.end(),
                     [&](const Occluder& a, const Occluder& b) { return size2(a) > size2(b); });
    if (occluders.size() > count) occluders.resize(count);
    return occluders;
}

OccluderList::OccluderList(std::vector<Occluder> occluders) : occluders_(std::move(occluders)) {
    padded_ = (occluders_.size() + 15) / 16 * 16;
    places_.assign(12 * padded_, 0.0f);
    for (std::size_t i = 0; i < occluders_.size(); ++i)
        for (std::size_t k = 0; k < 4; ++k)
            for (int c = 0; c < 3; ++c)
                places_[(3 * k + static_cast<std::size_t>(c)) * padded_ + i] = occluders_[i].corner[k][c];
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
void OccluderList::look_from(glm::vec3 at, glm::vec3 normal, float* seen) const {
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

}  // namespace render2mpeg::renderer
