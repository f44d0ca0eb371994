// Point lights and spots.
#include "core/color.h"
#include "core/numeric.h"
#include "renderer/lights/light.h"

namespace render2mpeg::renderer {
namespace {

class PunctualLight final : public Light {
  public:
    explicit PunctualLight(const LightPoint& point) : point_(point) {}

    SourceExtent extent() const override {
        return {point_.position, 0, static_cast<double>(core::luminance(point_.intensity))};
    }
    double weight(const LightQuery& query) const override {
        const glm::vec3 d = point_.position - query.position;
        const float distance = glm::length(d);
        return query.may_see(d) ? core::luminance(point_.intensity) * falloff(distance, d / distance) : 0.0f;
    }
    LightSample sample(const LightQuery& query, double, glm::vec2) const override {
        const glm::vec3 d = point_.position - query.position, way = point_.position - query.origin;
        LightSample sample;
        sample.direction = core::normalize_or(d, query.normal);
        sample.light = point_.intensity * falloff(glm::length(d), sample.direction);
        sample.far = glm::length(way);
        sample.ray = core::normalize_or(way, query.normal);
        return sample;
    }
    std::optional<LightPoint> point() const override { return point_; }

  private:
    /// Irradiance across the beam over the intensity; `direction`: unit, to the light.
    float falloff(float distance, glm::vec3 direction) const {
        return core::divide_or(1.0f, distance * distance, 0.0f) * point_.emitted(-direction, distance * distance);
    }

    LightPoint point_;
};

}  // namespace

std::unique_ptr<Light> punctual_light(const scene::LightState& lamp) {
    LightPoint point = point_of_lamp(lamp);
    point.type = LightType::punctual;
    point.spot = spot_of(lamp);
    return std::make_unique<PunctualLight>(point);
}

std::unique_ptr<Light> flame_light(const LightPoint& point) {
    return std::make_unique<PunctualLight>(point);
}

}  // namespace render2mpeg::renderer
