#pragma once
// How far below a surface light goes, after [Christensen2015]: a sum of two exponentials over the distance.
#include <array>
#include <glm/glm.hpp>

namespace render2mpeg::renderer {

/// Of light that enters a flat surface, the share that leaves at a distance, per area; without albedo: all of it
/// integrates to 1. One for each channel.
class SubsurfaceProfile {
  public:
    /// `albedo`: diffuse, 0..1; `free_path`: mean, scene units, > 0 in one channel at least.
    SubsurfaceProfile(glm::vec3 albedo, glm::vec3 free_path);

    /// [Christensen2015, eq. 3] at a distance > 0.
    glm::vec3 at(float distance) const;

    /// A distance on a plane for which `number` in [0, 1) chooses a channel and an exponential, `u` how far; and its
    /// density per area, mean over channels. Never beyond `reach`.
    float sample(float number, float u) const;
    float density(float distance) const;
    float reach() const { return reach_; }

  private:
    std::array<float, 3> d_{};  ///< shaping lengths; 0: light of the channel leaves where it enters
    float reach_ = 0;
};

}  // namespace render2mpeg::renderer
