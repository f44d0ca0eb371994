#pragma once

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <numeric>

#include "core/sampling.h"
#include "perceptual/visibility_model.h"
#include "tests/perceptual/mpeg2_quantisation.h"

/// A wall that is looked at, and how it is coded: what tests of the visibility model share.
namespace render2mpeg::perceptual {

inline constexpr int width = 72, height = 40;

/// A lit wall: dark to bright from left to right, rough below.
inline core::Radiance wall(std::int64_t frame, float noise = 0.0f) {
    core::Radiance radiance;
    radiance.frame = frame;
    radiance.combined = core::Plane<glm::vec3>(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const auto pixel = static_cast<std::uint64_t>(y * width + x);
            const float rough = y < height / 2 ? 1.0f : 0.4f + 1.2f * core::uniform(1, pixel);
            const float error =
                1.0f + noise * (2.0f * core::uniform(2, pixel, static_cast<std::uint64_t>(frame)) - 1.0f);
            radiance.combined.at(x, y) =
                glm::vec3(1.0f, 0.8f, 0.5f) * (rough * error * std::exp2(8.0f * static_cast<float>(x) / width - 7.0f));
        }
    return radiance;
}

inline std::shared_ptr<const core::Visible> seen() {
    core::Visible visible(0, width, height);
    for (std::size_t i = 0; i < visible.kind.size(); ++i) {
        visible.kind.values()[i] = core::PixelClass::surface;
        visible.address.values()[i] = {0, 0, 0.2f, 0.2f};
        visible.material.values()[i] = 0;
        visible.depth.values()[i] = 2.0f;
    }
    return std::make_shared<const core::Visible>(std::move(visible));
}

inline CodedFacts coded_as(std::int64_t number, const CodingPlan& plan) {
    CodedFacts facts;
    facts.number = number;
    facts.plan = plan;
    facts.intra = core::Plane<std::uint8_t>((width + 15) / 16, (height + 15) / 16, plan.intra ? 1 : 0);
    facts.scale = core::Plane<float>((width + 15) / 16, (height + 15) / 16, plan.scale);
    return facts;
}

inline CodingPlan plan_of(bool intra, int quantiser) {
    CodingPlan plan;
    plan.quantisation = default_quantisation();
    plan.intra = intra;
    plan.scale = static_cast<float>(quantiser) / 8.0f;
    return plan;
}

inline const Display display(0.0f, ColorMatrix::bt709);

inline TemporalState state_of(const VisibilityModel& model, const CodingPlan& plan) {
    const core::Radiance radiance = wall(0);
    return model.judge(model.observe(display.develop(radiance), radiance, seen()), coded_as(0, plan));
}

inline double mean(const core::Plane<float>& plane) {
    return std::accumulate(plane.values().begin(), plane.values().end(), 0.0) / static_cast<double>(plane.size());
}

inline double mean_absolute(const core::ToleranceMap& map) {
    double sum = 0;
    for (const core::Tolerance& t : map.pixels.values()) sum += static_cast<double>(t.absolute);
    return sum / static_cast<double>(map.pixels.size());
}

}  // namespace render2mpeg::perceptual
