#pragma once
// All that dims and scatters light on its way between surfaces: fog and volumes.
#include <cstddef>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "renderer/base/fog_medium.h"
#include "renderer/base/lit_fog.h"
#include "renderer/base/volume_light.h"
#include "renderer/base/volume_medium.h"

namespace render2mpeg::renderer {

/// How a ray looks at volumes. `rough`: longer steps, and no flames: light points send their light to surfaces.
enum class VolumeView { eye, rough };

/// Air of an instant. Directions are unit vectors, distances >= 0 and may be infinite.
class Air {
  public:
    Air(const std::optional<FogMedium>& fog, std::vector<VolumeMedium> volumes)
        : fog_(fog), volumes_(std::move(volumes)) {}

    const FogMedium* fog() const { return fog_ ? &*fog_ : nullptr; }
    const std::vector<VolumeMedium>& volumes() const { return volumes_; }

    /// Share of light that is left of a way.
    glm::vec3 transmittance(glm::vec3 from, glm::vec3 direction, float distance) const;
    /// The same of light that comes from there: from infinitely far it is the sky's, or a sun's.
    glm::vec3 left_of_light(glm::vec3 from, glm::vec3 direction, float distance) const;
    /// Its optical depth, and the fog's part of it.
    glm::vec3 depth_of_light(glm::vec3 from, glm::vec3 direction, float distance) const;
    float fog_of_light(glm::vec3 from, glm::vec3 direction, float distance) const;
    /// Optical depth of volumes.
    glm::vec3 depth_of_volumes(glm::vec3 from, glm::vec3 direction, float distance) const;

    /// Light within `volumes`, as many, and within fog. Until then they are black.
    void light(std::vector<VolumeLight> lights) { lights_ = std::move(lights); }
    void light(LitFog lit_fog) { lit_fog_ = std::move(lit_fog); }
    const LitFog& lit_fog() const { return lit_fog_; }
    bool is_lit() const { return (volumes_.empty() || !lights_.empty()) && (!fog_ || !lit_fog_.empty()); }
    const std::vector<VolumeLight>& lights() const { return lights_; }
    /// Adds the radiance that volumes before each of `count` distances, which rise, send to the origin.
    void add_light(glm::vec3 from, glm::vec3 direction, VolumeView view, const float* ends, std::size_t count,
                   glm::vec3* sums) const;
    /// The same as far as one distance.
    glm::vec3 light_of_volumes(glm::vec3 from, glm::vec3 direction, float distance, VolumeView view) const;
    /// What a ray that looks for light sees of the air before `distance`: volumes roughly, and fog.
    glm::vec3 light_for_rays(glm::vec3 from, glm::vec3 direction, float distance) const;

  private:
    std::optional<FogMedium> fog_;
    std::vector<VolumeMedium> volumes_;
    std::vector<VolumeLight> lights_;
    LitFog lit_fog_;
};

}  // namespace render2mpeg::renderer
