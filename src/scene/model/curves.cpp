#include "scene/model/curves.h"

#include <cmath>

#include "core/error.h"

namespace render2mpeg::scene {

CurveWeights::CurveWeights(double u)
    : value{0.5 * u * (u * (2 - u) - 1), 0.5 * (u * u * (3 * u - 5) + 2), 0.5 * u * (u * (4 - 3 * u) + 1),
            0.5 * u * u * (u - 1)},
      derivative{0.5 * (u * (4 - 3 * u) - 1), 0.5 * u * (9 * u - 10), 0.5 * (u * (8 - 9 * u) + 1),
                 0.5 * u * (3 * u - 2)} {}

std::uint32_t add_strand(Mesh& mesh, std::span<const glm::vec3> points, std::span<const float> radii) {
    EXPECTS(points.size() >= 2 && radii.size() == points.size());
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    const auto add = [&](std::size_t k) {
        mesh.positions.push_back(points[k]);
        mesh.radii.push_back(radii[k]);
    };
    add(0);
    for (std::size_t k = 0; k < points.size(); ++k) add(k);
    add(points.size() - 1);
    for (std::uint32_t k = 0; k + 1 < points.size(); ++k) mesh.curves.push_back(first + k);
    return first + 1;
}

float width_scale(const glm::mat4& m) {
    return std::cbrt(std::abs(glm::determinant(glm::mat3(m))));
}

}  // namespace render2mpeg::scene
