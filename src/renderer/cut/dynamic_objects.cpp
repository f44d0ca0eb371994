#include "renderer/cut/dynamic_objects.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/numeric.h"
#include "renderer/base/isa_clones.h"

namespace render2mpeg::renderer {
namespace {

/// What distances of a few metres may be off by, as a share of them, after some operations.
constexpr float rounding = 1e-5f;

/// What to divide by where a way may run along a box's planes, which it then meets as good as never.
RENDER2MPEG_ALWAYS_INLINED float not_zero(float v) {
    return inlined::abs(v) > 1e-30f ? v : 1e-30f;
}

/// Where a packet's rays enter and leave a box, in units of their directions: not at all where they leave first.
struct Crossing {
    alignas(64) Lanes in, out;
};
RENDER2MPEG_ALWAYS_INLINED void cross(const ShadowPacket& packet, const MiddleBox& box, Crossing& c) {
    for (int i = 0; i < lane_count; ++i) {
        c.in[i] = 0.0f;
        c.out[i] = packet.far[i];
    }
    // Between both planes across each axis.
    const auto cut = [&](const float* origin, const float* direction, float middle, float half) {
        for (int i = 0; i < lane_count; ++i) {
            const float inverse = 1.0f / not_zero(direction[i]);
            const float a = (middle - half - origin[i]) * inverse, b = (middle + half - origin[i]) * inverse;
            c.in[i] = inlined::max(c.in[i], inlined::min(a, b));
            c.out[i] = inlined::min(c.out[i], inlined::max(a, b));
        }
    };
    cut(packet.origin_x, packet.direction_x, box.middle.x, box.half.x);
    cut(packet.origin_y, packet.direction_y, box.middle.y, box.half.y);
    cut(packet.origin_z, packet.direction_z, box.middle.z, box.half.z);
}

}  // namespace

void GroupDynamicObjects::choose(const GatherLanes& lanes, std::span<const MiddleBox> boxes) {
    count_ = 0;
    if (boxes.empty()) return;
    glm::vec3 low(lanes.origin.x[0], lanes.origin.y[0], lanes.origin.z[0]), high = low;
    for (int i = 1; i < lanes.count; ++i) {
        const glm::vec3 p(lanes.origin.x[i], lanes.origin.y[i], lanes.origin.z[i]);
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    middle_ = 0.5f * (low + high);
    half_ = 0.5f * (high - low);
    float seen[most];
    for (const MiddleBox& box : boxes) {
        const float size = glm::length(box.half);
        const float looks = core::divide_or(size, std::max(glm::distance(box.middle, middle_), size), 0.0f);
        if (!(looks > 0.0f) || (count_ == most && !(looks > seen[most - 1]))) continue;
        int k = count_ < most ? count_++ : most - 1;
        for (; k > 0 && seen[k - 1] < looks; --k) {
            seen[k] = seen[k - 1];
            box_[k] = box_[k - 1];
        }
        seen[k] = looks;
        box_[k] = box;
    }
}

bool GroupDynamicObjects::can_hide(LightType type, const glm::vec3& middle, const glm::vec3& half) const {
    const bool far_away = type == LightType::directional;
    const glm::vec3 way = far_away ? middle : middle - middle_, narrows = far_away ? glm::vec3(0) : half_;
    for (int k = 0; k < count_; ++k) {
        // A part t of the way all places on the ways fill a box, of half_ to `half`: where along the way does that
        // meet the dynamic object's?
        const glm::vec3 to = box_[k].middle - middle_;
        float in = 0.0f, out = far_away ? std::numeric_limits<float>::infinity() : 1.0f;
        const auto at_most = [&](float rise, float end) {  // rise x t <= end
            if (std::abs(rise) < 1e-30f)
                out = end < 0.0f ? -1.0f : out;
            else if (rise > 0.0f)
                out = std::min(out, end / rise);
            else
                in = std::max(in, end / rise);
        };
        for (int axis = 0; axis < 3; ++axis) {
            const float size = box_[k].half[axis] + half_[axis] + rounding * (std::abs(to[axis]) + std::abs(way[axis]));
            const float opens = half[axis] - narrows[axis];
            at_most(-way[axis] - opens, size - to[axis]);
            at_most(way[axis] - opens, size + to[axis]);
        }
        if (in <= out) return true;
    }
    return false;
}

RENDER2MPEG_CLONES
std::uint32_t GroupDynamicObjects::met(const ShadowPacket& packet) const {
    std::uint32_t rays = 0;
    for (int k = 0; k < count_; ++k) {
        Crossing c;
        cross(packet, box_[k], c);
        for (int i = 0; i < lane_count; ++i) rays |= c.in[i] <= c.out[i] ? 1u << i : 0u;
    }
    return rays;
}

}  // namespace render2mpeg::renderer
