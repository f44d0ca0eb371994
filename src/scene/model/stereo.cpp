#include "scene/model/stereo.h"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

namespace render2mpeg::scene {
namespace {

/// Halves of the distance to the right.
double side_of(Eye eye) {
    return eye == Eye::left ? -0.5 : eye == Eye::right ? 0.5 : 0.0;
}

/// Place and turn where the camera lies between the eyes.
glm::dmat4 about_middle(const Stereo& stereo, Eye eye) {
    const double aside = side_of(eye) * stereo.interocular_distance;
    const glm::dmat4 moved = glm::translate(glm::dmat4(1), glm::dvec3(aside, 0, 0));
    if (stereo.convergence != Convergence::toe_in) return moved;
    return glm::rotate(moved, std::atan2(aside, stereo.convergence_distance), glm::dvec3(0, 1, 0));
}

}  // namespace

double EyeCircle::at(double latitude) const {
    const double height = std::abs(latitude);
    if (!(merge_to > 0)) return aside;
    if (height >= merge_to) return 0;
    if (height <= merge_from) return aside;
    return aside * std::cos(0.5 * std::numbers::pi * (height - merge_from) / (merge_to - merge_from));
}

EyeCircle circle_of(const Stereo& stereo, Eye eye) {
    EyeCircle circle;
    circle.aside = side_of(eye) * stereo.interocular_distance;
    if (stereo.convergence != Convergence::parallel) circle.convergence_distance = stereo.convergence_distance;
    circle.merge_from = stereo.pole_merge_from;
    circle.merge_to = stereo.pole_merge_to;
    return circle;
}

glm::dmat4 place_of(const Stereo& stereo, Eye eye) {
    if (eye == Eye::single) return glm::dmat4(1);
    const Eye still = stereo.pivot == Pivot::left ? Eye::left : stereo.pivot == Pivot::right ? Eye::right : Eye::single;
    return glm::inverse(about_middle(stereo, still)) * about_middle(stereo, eye);
}

}  // namespace render2mpeg::scene
