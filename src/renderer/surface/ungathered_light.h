#pragma once
// Light of a frame's pixels that no gather point gathers.
#include <vector>

#include "core/plane.h"
#include "renderer/surface/frame.h"

namespace render2mpeg::renderer {

/// A plane's value; 0 where the plane is empty.
inline glm::vec3 value_or_zero(const core::Plane<glm::vec3>& plane, int x, int y) {
    return plane.empty() ? glm::vec3(0) : plane.at(x, y);
}

inline float value_or_zero(const core::Plane<float>& plane, int x, int y) {
    return plane.empty() ? 0.0f : plane.at(x, y);
}

/// Caustics at a gather point.
struct PointCaustic {
    glm::vec3 irradiance{0};  ///< over pi
    glm::vec3 glossy{0};      ///< radiance that its lobe scatters
};

/// Radiance that one effect brings to a frame's pixels; empty planes: none.
struct EffectLight {
    core::Plane<glm::vec3> all;
    core::Plane<glm::vec3> specular;  ///< the part of `all` seen by mirrors or glass; empty where a frame has none
    core::Plane<glm::vec3> exposed;   ///< in exposed pixels, in place of `all`
    core::Plane<float> error{}, exposed_error{};  ///< standard errors of their luminance; empty: not told

    /// Radiance seen neither by mirrors nor through glass.
    glm::vec3 straight_at(int x, int y) const { return value_or_zero(all, x, y) - value_or_zero(specular, x, y); }
};

/// Radiance of a frame's pixels that needs no gathering: emission, and what each effect finds by itself.
class UngatheredLight {
  public:
    UngatheredLight() = default;
    explicit UngatheredLight(const Frame& frame) : all_(frame.emitted), specular_(frame.emitted_specular) {}

    void add_caustics(EffectLight light, std::vector<PointCaustic> of_points);
    void add_hair(EffectLight light) { add(hair_ = std::move(light)); }
    void add_air(EffectLight light) { add(air_ = std::move(light)); }

    /// Sums over emission and effects.
    const core::Plane<glm::vec3>& all() const { return all_; }
    /// The part of them seen by mirrors or glass; empty without them.
    const core::Plane<glm::vec3>& specular() const { return specular_; }
    const EffectLight& caustics() const { return caustics_; }
    /// Of fibres and below surfaces.
    const EffectLight& hair() const { return hair_; }
    const EffectLight& air() const { return air_; }
    /// By point of the frame (Exposure::first_point), where pixels are exposed; else empty.
    const std::vector<PointCaustic>& caustics_of_points() const { return caustics_of_points_; }

  private:
    void add(const EffectLight& light);

    core::Plane<glm::vec3> all_, specular_;
    EffectLight caustics_, hair_, air_;
    std::vector<PointCaustic> caustics_of_points_;
};

}  // namespace render2mpeg::renderer
