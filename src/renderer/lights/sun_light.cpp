// Directional lights: suns, with a size or without.
#include <cmath>
#include <limits>
#include <numbers>

#include "core/color.h"
#include "core/numeric.h"
#include "core/sampling.h"
#include "renderer/base/lobe.h"
#include "renderer/lights/light.h"

namespace render2mpeg::renderer {
namespace {

/// Suns whose half angle is less throw shadows that are too sharp to be interpolated. chosen: 1 degree.
constexpr float sharp_sun = 0.01745f;

/// Seen as a whole, a disc.
class SunLight final : public Light, public AreaLamp {
  public:
    SunLight(const LightPoint& point, float angle)
        : point_(point),
          towards_(-point.normal),
          sine_(std::sin(angle)),
          cosine_(std::cos(angle)),
          cone_(2.0f * std::numbers::pi_v<float> * sine_ * sine_ / (1.0f + cosine_)) {
        point_.disc2 = sine_ * sine_;
        if (sine_ > 0.0f) AreaLamp::radiance = point.intensity * (lobe::inverse_pi / point_.disc2);
        type = LightType::directional;
        sharp = angle < sharp_sun;
    }

    SourceExtent extent() const override {
        return {glm::vec3(0), 0, static_cast<double>(core::luminance(point_.intensity)), true};
    }
    double weight(const LightQuery& query) const override {
        return query.may_see(towards_, sine_) ? core::luminance(point_.intensity) : 0.0f;
    }
    /// With a size, evenly by solid angle.
    LightSample sample(const LightQuery&, double, glm::vec2 u) const override {
        LightSample sample;
        sample.light = point_.intensity;
        sample.direction = towards_;
        sample.far = std::numeric_limits<float>::infinity();
        if (sine_ > 0.0f) {
            sample.direction = core::sample_cone(towards_, cone_ / (2.0f * std::numbers::pi_v<float>), u);
            sample.density = 1.0f / cone_;
            sample.light = AreaLamp::radiance * cone_;
        }
        sample.ray = sample.direction;
        return sample;
    }
    float density(const LightQuery&, glm::vec3 direction, const core::SurfaceAddress&) const override {
        return holds(direction) ? 1.0f / cone_ : 0.0f;
    }
    glm::vec3 radiance(glm::vec3 direction) const override {
        return holds(direction) ? AreaLamp::radiance : glm::vec3(0);
    }
    std::optional<LightPoint> point() const override { return point_; }
    std::shared_ptr<AreaLamp> whole() const override {
        return sine_ > 0.0f ? std::make_shared<SunLight>(*this) : nullptr;
    }

    float irradiance(glm::vec3, glm::vec3 normal) const override {
        return static_cast<float>(
            cone_irradiance(glm::dot(glm::dvec3(towards_), glm::dvec3(normal)), double{sine_} * sine_));
    }
    void look(LampView& view) const override {
        for (int i = 0; i < lane_count; ++i) span(view, i, towards_, sine_);
    }

  private:
    bool holds(glm::vec3 direction) const { return sine_ > 0.0f && glm::dot(direction, towards_) >= cosine_; }

    LightPoint point_;
    glm::vec3 towards_;    ///< unit
    float sine_, cosine_;  ///< of half the angle that it spans; sine 0: a point
    float cone_;           ///< solid angle, without the cancellation of 1 - cos
};

}  // namespace

std::unique_ptr<Light> sun_light(const scene::LightState& lamp) {
    LightPoint point = point_of_lamp(lamp);
    point.type = LightType::directional;
    return std::make_unique<SunLight>(point, lamp.angle);
}

}  // namespace render2mpeg::renderer
