#include "bench/occluding_spheres.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "core/isa_clones.h"

namespace render2mpeg::bench {
namespace {

/// How far each place is from the nearest surface.
std::vector<float> clearances(const SurfaceCloud& cloud) {
    std::vector<float> found;
    for (const glm::vec3& c : cloud.inside) {
        float least = std::numeric_limits<float>::infinity();
        for (const glm::vec3& p : cloud.places) least = std::min(least, glm::dot(p - c, p - c));
        found.push_back(std::sqrt(least));
    }
    return found;
}

/// A ball about the starts and another about the ends of a packet's rays.
struct Beam {
    glm::vec3 start{0}, along{0};
    float length2 = 0, radius = 0;
};

Beam beam_of(const renderer::ShadowPacket& p) {
    glm::vec3 from{0}, to{0};
    float count = 0;
    const auto start = [&p](int i) { return glm::vec3(p.origin_x[i], p.origin_y[i], p.origin_z[i]); };
    const auto end = [&p, &start](int i) {
        return start(i) + p.far[i] * glm::vec3(p.direction_x[i], p.direction_y[i], p.direction_z[i]);
    };
    for (std::uint32_t left = p.active; left != 0; left &= left - 1, count += 1) {
        from += start(std::countr_zero(left));
        to += end(std::countr_zero(left));
    }
    Beam beam;
    beam.start = from / count;
    beam.along = to / count - beam.start;
    beam.length2 = std::max(glm::dot(beam.along, beam.along), std::numeric_limits<float>::min());
    for (std::uint32_t left = p.active; left != 0; left &= left - 1) {
        const int i = std::countr_zero(left);
        beam.radius = std::max(
            {beam.radius, glm::distance(start(i), beam.start), glm::distance(end(i), beam.start + beam.along)});
    }
    return beam;
}

RENDER2MPEG_ALWAYS_INLINED float within(float low, float v, float high) {
    return core::inlined::min(core::inlined::max(v, low), high);
}

constexpr std::size_t block = 16;

/// Whether each of a block's spheres comes near a beam; returns whether any does.
RENDER2MPEG_CLONES
int near_beam(const Beam& beam, const float* x, const float* y, const float* z, const float* radius, int* near) {
    int any = 0;
    const float each = 1.0f / beam.length2;
    for (std::size_t k = 0; k < block; ++k) {  // distance of the sphere's middle from the beam's axis
        const float dx = x[k] - beam.start.x, dy = y[k] - beam.start.y, dz = z[k] - beam.start.z;
        const float t = within(0.0f, (dx * beam.along.x + dy * beam.along.y + dz * beam.along.z) * each, 1.0f);
        const float ex = dx - t * beam.along.x, ey = dy - t * beam.along.y, ez = dz - t * beam.along.z;
        const float reach = radius[k] + beam.radius;
        near[k] = ex * ex + ey * ey + ez * ez < reach * reach ? 1 : 0;
        any |= near[k];
    }
    return any;
}

/// Bit i: ray i meets the sphere, active or not.
RENDER2MPEG_CLONES
std::uint32_t meeting(const renderer::ShadowPacket& p, float x, float y, float z, float r2) {
    std::uint32_t met = 0;
    for (std::uint32_t i = 0; i < 16; ++i) {  // nearest place of ray i to the sphere's middle
        const float dx = x - p.origin_x[i], dy = y - p.origin_y[i], dz = z - p.origin_z[i];
        const float ax = p.direction_x[i], ay = p.direction_y[i], az = p.direction_z[i];
        const float t = within(0.0f, (dx * ax + dy * ay + dz * az) / (ax * ax + ay * ay + az * az), p.far[i]);
        const float ex = dx - t * ax, ey = dy - t * ay, ez = dz - t * az;
        met |= (ex * ex + ey * ey + ez * ez < r2 ? 1u : 0u) << i;
    }
    return met;
}

}  // namespace

OccludingSpheres::OccludingSpheres(const SurfaceCloud& cloud, int most) {
    const std::vector<float> clearance = clearances(cloud);
    std::vector<bool> filled(cloud.inside.size(), false);
    std::vector<int> fills(cloud.inside.size(), 0);
    const auto fills_at = [&](std::size_t sphere, std::size_t place) {
        const glm::vec3 d = cloud.inside[sphere] - cloud.inside[place];
        return glm::dot(d, d) <= clearance[sphere] * clearance[sphere];
    };
    for (std::size_t i = 0; i < fills.size(); ++i)
        for (std::size_t k = 0; k < fills.size(); ++k) fills[i] += fills_at(i, k);
    for (int n = 0; n < most; ++n) {
        const auto best = std::max_element(fills.begin(), fills.end());
        if (best == fills.end() || *best == 0) break;
        const auto chosen = static_cast<std::size_t>(best - fills.begin());
        x_.push_back(cloud.inside[chosen].x);
        y_.push_back(cloud.inside[chosen].y);
        z_.push_back(cloud.inside[chosen].z);
        radius_.push_back(clearance[chosen]);
        for (std::size_t k = 0; k < filled.size(); ++k) {
            if (filled[k] || !fills_at(chosen, k)) continue;
            filled[k] = true;
            for (std::size_t i = 0; i < fills.size(); ++i) fills[i] -= fills_at(i, k);
        }
    }
    count_ = radius_.size();
    for (; radius_.size() % block != 0; radius_.push_back(0)) {  // whole blocks: far away, nothing meets them
        for (auto* far : {&x_, &y_, &z_}) far->push_back(1e15f);
    }
}

std::uint32_t OccludingSpheres::occluded(const renderer::ShadowPacket& packet) const {
    if (packet.active == 0) return 0;
    const Beam beam = beam_of(packet);
    std::uint32_t blocked = 0;
    int near[block];
    for (std::size_t first = 0; first < radius_.size(); first += block) {
        if (near_beam(beam, &x_[first], &y_[first], &z_[first], &radius_[first], near) == 0) continue;
        for (std::size_t k = first; k < first + block; ++k) {
            if (near[k - first] == 0) continue;
            blocked |= meeting(packet, x_[k], y_[k], z_[k], radius_[k] * radius_[k]) & packet.active;
            if (blocked == packet.active) return blocked;
        }
    }
    return blocked;
}

}  // namespace render2mpeg::bench
