#pragma once
// A coarse picture of where surfaces are, before there is a ray tracer.
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "scene/model/animation.h"
#include "scene/pose/extent.h"

namespace render2mpeg::scene {

/// A coarse picture of where a film's surfaces are at one instant, good enough to judge a view before there is a ray
/// tracer. Cubic cells, at most 48 along the longest side.
class SurfaceGrid {
  public:
    SurfaceGrid(const Animation& animation, double seconds, const Extent& extent);

    /// Cells that a view sees, each once.
    struct Frame {
        int front = 0;      ///< their surface faces the eye
        int back = 0;       ///< it is turned away
        double detail = 0;  ///< of the facing cells: sum of log2(1 + triangles in the cell)
    };

    /// View of a camera looking along -z of `axes` (right, up, back), 58 by 40 degrees, by a raster of 18 x 12 rays.
    Frame seen_from(glm::dvec3 eye, const glm::dmat3& axes);

    /// Whether neither the cell of this point nor one beside it holds a surface.
    bool is_free(glm::dvec3 point) const;

    /// Whether cells with surfaces lie all around a point, so that no way leads from it to the outside of the grid.
    /// False for points that touch a surface with all cells about them, since nothing can be said of those.
    bool closes_in(glm::dvec3 point) const;

  private:
    struct Cell {
        glm::vec3 normal{0};        ///< sum over the samples
        std::uint32_t samples = 0;  ///< 0: empty
        std::uint32_t triangles = 0;
        std::uint32_t last_triangle = 0;
        std::uint32_t seen = 0;  ///< number of the last view that counted it
    };

    std::size_t samples_needed(const std::vector<std::vector<glm::dvec3>>& positions, const Animation& animation) const;
    void add_triangle(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c, double side);
    void set_size(int longest);
    glm::ivec3 cell_of(glm::dvec3 point) const;
    bool inside(glm::ivec3 cell) const;
    Cell& at(glm::ivec3 cell) { return cells_[index(cell)]; }
    std::size_t index(glm::ivec3 cell) const;
    void look_along(glm::dvec3 eye, glm::dvec3 direction, Frame& seen);

    Extent extent_;
    double cell_ = 1;  ///< edge length
    glm::ivec3 size_{1};
    std::vector<Cell> cells_;
    std::uint32_t view_ = 0;
    std::uint32_t triangle_ = 0;  ///< number of the one that is being added, from 1
};

}  // namespace render2mpeg::scene
