#pragma once
// Finds the largest triangles of a scene.
#include <cstddef>
#include <vector>

#include "scene/model/animation.h"
#include "scene/pose/snapshot.h"

namespace render2mpeg::renderer {

/// Four times the squared area of a triangle; 0 where it is not finite.
float area2(const scene::Triangle& t);

/// The same in the mesh's own space, of its largest triangle.
double largest_area2(const scene::Mesh& mesh);

/// By at most how much a transform multiplies that.
double widening2(const glm::mat4& m);

/// Keeps the largest of any number of triangles, in memory for four times as many as are wanted.
class LargestTriangles {
  public:
    /// `most`: 1 or more.
    explicit LargestTriangles(std::size_t most) : most_(most) {}

    void add(const scene::Triangle& t);

    /// Lower limit of area2: smaller triangles would be left out; below 0 while none would.
    double least() const { return least_; }

    /// The `most` largest so far, of several as large those that came first, in the order in which they came.
    std::vector<scene::Triangle> in_order();

  private:
    struct Kept {
        float area2;
        std::size_t place;
        scene::Triangle triangle;
    };
    void leave_out_small();

    std::size_t most_, added_ = 0;
    double least_ = -1.0;
    std::vector<Kept> kept_;
};

}  // namespace render2mpeg::renderer
