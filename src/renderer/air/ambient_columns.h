#pragma once
// Smooth light of the air along a coarse lattice of rays from the eye.
#include <glm/glm.hpp>
#include <vector>

#include "renderer/surface/frame.h"
#include "renderer/surface/posed_scene.h"

namespace render2mpeg::renderer {

/// Light that fog scatters before the eye of all but lamps' own, sampled at the corners of tiles and at evenly growing
/// distances; interpolated in between.
class AmbientColumns {
  public:
    /// As far as any of `seen` looks.
    AmbientColumns(const PosedScene& posed_scene, const Frame& seen);

    /// From the eye as far as a distance, about the middle of a pixel.
    glm::vec3 light(glm::ivec2 pixel, float distance) const;
    /// The same along any ray.
    glm::vec3 along(const AirPath& path) const;

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
    float least_distance_;  ///< light nearer to the eye counts as that there
    int across_, steps_ = 1;
    std::vector<Column> columns_;
};

}  // namespace render2mpeg::renderer
