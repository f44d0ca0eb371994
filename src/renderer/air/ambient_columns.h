#pragma once
// Smooth light of the air along a coarse lattice of rays from the eye.
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "renderer/air/ambient_air.h"
#include "renderer/surface/frame.h"
#include "renderer/surface/posed_scene.h"

namespace render2mpeg::renderer {

/// Ambient light that air scatters before the eye, sampled at the corners of tiles and at evenly growing
/// distances; interpolated in between.
class AmbientColumns {
  public:
    /// As far as any of `seen` looks.
    AmbientColumns(const PosedScene& posed_scene, const Frame& seen, AmbientAir& ambient);

    /// From the eye as far as a distance, about the middle of a pixel.
    glm::vec3 light(glm::ivec2 pixel, float distance) const;
    /// The same along any ray.
    glm::vec3 along(const AirPath& path) const;
    std::uint64_t rays() const { return rays_; }

  private:
    struct Column {
        glm::vec3 origin{0}, direction{0};
        std::vector<glm::vec3> light;  ///< by step; the last beyond all
    };
    float distance_of(int step) const;
    glm::vec3 at(const Column& column, float distance) const;
    glm::vec3 fluence(const Column& column, int step) const;
    float lost(const Column& column, float distance) const;

    const Air& all_air_;
    const FogMedium& air_;
    const AmbientAir& ambient_;
    glm::vec3 eye_;
    int across_, steps_ = 1;
    std::vector<Column> columns_;
    std::uint64_t rays_ = 0;
};

}  // namespace render2mpeg::renderer
