#pragma once
// Strands of hair: uniform Catmull-Rom curves with a radius.
#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "scene/model/mesh.h"

namespace render2mpeg::scene {

/// Weights of a segment's four control points at `u` in 0..1, and those of the derivative. [Catmull1974]
struct CurveWeights {
    std::array<double, 4> value, derivative;
    explicit CurveWeights(double u);
};

/// Adds a strand that passes through its points, two at least, as many as radii; more points than that are its own
/// ends', doubled. Returns the index of each point's position: `points[k]` is the mesh's position `first + k`.
std::uint32_t add_strand(Mesh& mesh, std::span<const glm::vec3> points, std::span<const float> radii);

/// By how much a transform widens strands: the cube root of its volume's.
float width_scale(const glm::mat4& m);

}  // namespace render2mpeg::scene
