#include "renderer/base/air.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/numeric.h"

namespace render2mpeg::renderer {
namespace {

/// Behind this optical depth nothing is looked for: a share of 6e-6.
constexpr float deepest = 12.0f;

/// A volume that a ray meets.
struct Met {
    std::size_t index;
    BrickWalk walk;
};

std::vector<Met> met_by(const std::vector<VolumeMedium>& volumes, glm::vec3 from, glm::vec3 direction) {
    std::vector<Met> met;
    for (std::size_t i = 0; i < volumes.size(); ++i) {
        const BrickWalk walk(volumes[i], from, direction);
        if (!walk.misses()) met.push_back({i, walk});
    }
    return met;
}

/// Calls step(middle, length, met) along the ray as far as `far`, wherever some volume is met, each step within one
/// brick of each; ends where it returns false.
template <class Step>
void march(std::vector<Met>& met, float from, float far, bool coarse, Step step) {
    while (from < far) {
        float end = far, length = std::numeric_limits<float>::infinity();
        for (Met& m : met) {
            while (m.walk.end() <= from) m.walk.advance();
            end = std::min(end, m.walk.end());
            if (m.walk.is_inside()) length = std::min(length, m.walk.step(coarse));
        }
        if (std::isinf(end) && std::isinf(length)) return;
        if (!std::isinf(length) && end > from) {
            const auto steps = static_cast<int>(std::clamp(std::ceil((end - from) / length), 1.0f, 1024.0f));
            const float part = (end - from) / static_cast<float>(steps);
            for (int i = 0; i < steps; ++i)
                if (!step(from + (static_cast<float>(i) + 0.5f) * part, part)) return;
        }
        from = end;
    }
}

}  // namespace

glm::vec3 Air::depth_of_volumes(glm::vec3 from, glm::vec3 direction, float distance) const {
    glm::vec3 depth(0);
    if (volumes_.empty()) return depth;
    std::vector<Met> met = met_by(volumes_, from, direction);
    if (met.empty()) return depth;
    march(met, 0.0f, distance, true, [&](float at, float length) {
        for (const Met& m : met)
            if (m.walk.is_inside()) depth += length * volumes_[m.index].extinction(m.walk.place(at));
        return std::min({depth.x, depth.y, depth.z}) < deepest;
    });
    return depth;
}

glm::vec3 Air::transmittance(glm::vec3 from, glm::vec3 direction, float distance) const {
    const float by_fog = fog_ ? std::exp(-fog_->optical_depth(from, direction, distance)) : 1.0f;
    return volumes_.empty() ? glm::vec3(by_fog) : by_fog * glm::exp(-depth_of_volumes(from, direction, distance));
}

float Air::fog_of_light(glm::vec3 from, glm::vec3 direction, float distance) const {
    if (!fog_) return 0;
    return std::isinf(distance) ? fog_->depth_to_sky(from, direction) : fog_->optical_depth(from, direction, distance);
}

glm::vec3 Air::depth_of_light(glm::vec3 from, glm::vec3 direction, float distance) const {
    return fog_of_light(from, direction, distance) + depth_of_volumes(from, direction, distance);
}

glm::vec3 Air::left_of_light(glm::vec3 from, glm::vec3 direction, float distance) const {
    const glm::vec3 depth = depth_of_light(from, direction, distance);
    return volumes_.empty() ? glm::vec3(std::exp(-depth.x)) : glm::exp(-depth);
}

void Air::add_light(glm::vec3 from, glm::vec3 direction, VolumeView view, const float* ends, std::size_t count,
                    glm::vec3* sums) const {
    if (lights_.empty() || count == 0) return;
    std::vector<Met> met = met_by(volumes_, from, direction);
    if (met.empty()) return;
    glm::vec3 light(0), depth(0);
    float begin = 0;
    for (std::size_t e = 0; e < count; ++e) {
        bool dark = false;
        march(met, begin, ends[e], view == VolumeView::rough, [&](float at, float length) {
            glm::vec3 extinction(0), source(0);
            for (const Met& m : met) {
                if (!m.walk.is_inside()) continue;
                const VolumeMedium& medium = volumes_[m.index];
                const glm::vec3 place = m.walk.place(at);
                const MediumPoint point = medium.at(place);
                extinction += point.extinction;
                if (point.scattering != glm::vec3(0))
                    source += point.scattering * lights_[m.index].scattered(medium, place, -direction);
                if (view == VolumeView::eye) source += point.emission;
            }
            // The mean of what is left within the step.
            const glm::vec3 taken = length * extinction;
            glm::vec3 mean(length);
            for (int c = 0; c < 3; ++c)
                if (taken[c] > 1e-4f) mean[c] = -std::expm1(-taken[c]) / extinction[c];
            glm::vec3 left = glm::exp(-depth) * mean;
            if (fog_) left *= std::exp(-fog_->optical_depth(from, direction, at));
            light += left * source;
            depth += taken;
            dark = std::min({depth.x, depth.y, depth.z}) >= deepest;
            return !dark;
        });
        begin = ends[e];
        sums[e] += light;
        if (!dark) continue;
        for (++e; e < count; ++e) sums[e] += light;
    }
}

glm::vec3 Air::light_of_volumes(glm::vec3 from, glm::vec3 direction, float distance, VolumeView view) const {
    glm::vec3 sum(0);
    add_light(from, direction, view, &distance, 1, &sum);
    return sum;
}

glm::vec3 Air::light_for_rays(glm::vec3 from, glm::vec3 direction, float distance) const {
    glm::vec3 light = light_of_volumes(from, direction, distance, VolumeView::rough);
    if (!fog_) return light;
    lit_fog_.along(*fog_, from, direction, distance, [&](glm::vec3 place, float share) {
        glm::vec3 part = share * fog_->albedo() * lit_fog_.light_at(place);
        if (!volumes_.empty()) part *= glm::exp(-depth_of_volumes(from, direction, glm::distance(from, place)));
        light += part;
    });
    return light;
}

}  // namespace render2mpeg::renderer
