#include "bench/imperfect_shadow_maps.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/sampling.h"

namespace render2mpeg::bench {

ImperfectShadowMaps::ImperfectShadowMaps(const SurfaceCloud& cloud, const std::vector<renderer::LightPoint>& lights,
                                         int splats, int side)
    : side_(side),
      radius_(cloud.radius),
      disc_radius_(std::sqrt(cloud.area / (std::numbers::pi_v<float> * static_cast<float>(splats)))),
      depths_(lights.size() * static_cast<std::size_t>(side * side), std::numeric_limits<float>::infinity()) {
    for (const renderer::LightPoint& l : lights) {
        Frame frame;
        frame.directional = l.kind == renderer::LightPointKind::directional;
        frame.origin = frame.directional ? cloud.middle - 2.0f * cloud.radius * l.normal : l.position;
        frame.z = l.normal;
        core::make_frame(frame.z, frame.x, frame.y);
        frames_.push_back(frame);
        draw(cloud, frames_.size() - 1, splats);
    }
}

ImperfectShadowMaps::Seen ImperfectShadowMaps::look(const Frame& frame, glm::vec3 place) const {
    const glm::vec3 d = place - frame.origin;
    const float half = 0.5f * static_cast<float>(side_);
    const glm::vec3 local{glm::dot(d, frame.x), glm::dot(d, frame.y), glm::dot(d, frame.z)};
    if (frame.directional) {
        const float scale = half / radius_;
        return {half + scale * glm::vec2(local), local.z, scale, local.z > 0};
    }
    const float distance = std::max(glm::length(d), 1e-6f * radius_);
    const float down = 1.0f + local.z / distance;  // paraboloid: (x, y) / (1 + z) of the unit direction
    if (!(local.z > 0)) return {};
    return {half + half * glm::vec2(local) / (distance * down), distance, half / (distance * down), true};
}

void ImperfectShadowMaps::draw(const SurfaceCloud& cloud, std::size_t light, int splats) {
    float* const map = &depths_[light * static_cast<std::size_t>(side_ * side_)];
    const Frame& frame = frames_[light];
    std::size_t k = static_cast<std::size_t>(core::mix(light) % cloud.places.size());
    for (int n = 0; n < splats; ++n, k = (k + 1) % cloud.places.size()) {
        const Seen s = look(frame, cloud.places[k]);
        if (!s.inside || s.distance < 2.0f * disc_radius_) continue;
        const float reach = std::min(s.scale * disc_radius_, 0.125f * static_cast<float>(side_));
        const int left = std::max(0, static_cast<int>(std::lround(s.at.x - reach))),
                  top = std::max(0, static_cast<int>(std::lround(s.at.y - reach)));
        const int right = std::min(side_, std::max(left + 1, static_cast<int>(std::lround(s.at.x + reach)))),
                  bottom = std::min(side_, std::max(top + 1, static_cast<int>(std::lround(s.at.y + reach))));
        for (int y = top; y < bottom; ++y)
            for (int x = left; x < right; ++x) map[y * side_ + x] = std::min(map[y * side_ + x], s.distance);
    }
}

std::uint32_t ImperfectShadowMaps::occluded(const renderer::ShadowPacket& packet, std::size_t light) const {
    const float* const map = &depths_[light * static_cast<std::size_t>(side_ * side_)];
    std::uint32_t blocked = 0;
    for (std::uint32_t left = packet.active; left != 0; left &= left - 1) {
        const int i = std::countr_zero(left);
        const Seen s = look(frames_[light], {packet.origin_x[i], packet.origin_y[i], packet.origin_z[i]});
        if (!s.inside) continue;
        const float bias =
            2.0f * disc_radius_ + 2.0f / s.scale;  // a splat and a texel of what faces the light at 45 degrees
        const int x = std::clamp(static_cast<int>(s.at.x), 0, side_ - 1),
                  y = std::clamp(static_cast<int>(s.at.y), 0, side_ - 1);
        blocked |= static_cast<std::uint32_t>(map[y * side_ + x] + bias < s.distance) << i;
    }
    return blocked;
}

}  // namespace render2mpeg::bench
