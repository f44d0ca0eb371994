#include "renderer/cache/plane_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/color.h"
#include "core/numeric.h"

namespace render2mpeg::renderer {
namespace {

/// Sum of the weights' sizes: 1 within the records' hull. chosen: 1.25, which lets
/// the rim of the picture be served; not tuned.
constexpr float most_stretch = 1.25f;

/// Most relative excess of samples in two columns over two exact columns (in_two_columns). chosen: 0.15: three columns
/// alike exceed it by 0.5, two that scatter evenly by a seventh of their distance to either side by 0.15; not tuned.
constexpr double two_columns = 0.15;

}  // namespace

bool PlaneFit::fit() {
    if (count_ < least) return false;
    freedoms_ = 3;
    // Normal equations of a plane about the point.
    double s = 0, sx = 0, sy = 0, sxx = 0, sxy = 0, syy = 0;
    for (int i = 0; i < count_; ++i) {
        const Sample& n = samples_[static_cast<std::size_t>(i)];
        const double w = n.closeness, x = n.offset.x, y = n.offset.y;
        s += w;
        sx += w * x;
        sy += w * y;
        sxx += w * x * x;
        sxy += w * x * y;
        syy += w * y * y;
    }
    const glm::dmat3 moments(s, sx, sy, sx, sxx, sxy, sy, sxy, syy);
    const double determinant = glm::determinant(moments);
    // Records along a line carry no plane: compare with the determinant of records all around, s^3 r^4 / 4.
    if (!(determinant > 1e-3 * s * s * s)) return false;
    const glm::dmat3 inverse = glm::inverse(moments);
    double stretch = 0;
    glm::dvec3 plane[3]{};
    for (int i = 0; i < count_; ++i) {
        const Sample& n = samples_[static_cast<std::size_t>(i)];
        const glm::dvec3 row = inverse * glm::dvec3(1.0, n.offset.x, n.offset.y) * static_cast<double>(n.closeness);
        weights_[static_cast<std::size_t>(i)] = static_cast<float>(row.x);
        stretch += std::abs(row.x);
        for (int k = 0; k < 3; ++k) plane[k] += row[k] * glm::dvec3(n.value);
    }
    for (int k = 0; k < 3; ++k) plane_[k] = glm::vec3(plane[k]);
    return stretch <= most_stretch && core::is_finite(plane_[0]);
}

bool PlaneFit::fit_mean() {
    if (count_ < 3) return false;
    freedoms_ = 1;
    float sum = 0;
    for (int i = 0; i < count_; ++i) sum += samples_[static_cast<std::size_t>(i)].closeness;
    plane_[0] = plane_[1] = plane_[2] = glm::vec3(0);
    for (int i = 0; i < count_; ++i) {
        const Sample& n = samples_[static_cast<std::size_t>(i)];
        weights_[static_cast<std::size_t>(i)] = core::divide_or(n.closeness, sum, 0.0f);
        plane_[0] += weights_[static_cast<std::size_t>(i)] * n.value;
    }
    return core::is_finite(plane_[0]);
}

float PlaneFit::reach() const {
    float sum = 0, square = 0;
    glm::vec2 middle(0);
    for (int i = 0; i < count_; ++i) {
        const Sample& n = samples_[static_cast<std::size_t>(i)];
        const float w = std::sqrt(n.closeness);
        sum += w;
        middle += w * n.offset;
    }
    if (!(sum > 0.0f)) return std::numeric_limits<float>::infinity();
    middle /= sum;
    // About their middle: the difference of two mean squares has no digits left where they lie in one place.
    for (int i = 0; i < count_; ++i) {
        const Sample& n = samples_[static_cast<std::size_t>(i)];
        square += std::sqrt(n.closeness) * glm::dot(n.offset - middle, n.offset - middle);
    }
    return std::sqrt(core::divide_or(glm::dot(middle, middle), square / sum, std::numeric_limits<float>::infinity()));
}

float PlaneFit::residual() const {
    // The nearest count for more, but less so than in the plane: an edge just beyond them is near.
    float sum = 0, luminance = 0, red = 0, blue = 0;
    for (int i = 0; i < count_; ++i) {
        const Sample& n = samples_[static_cast<std::size_t>(i)];
        const glm::vec3 off = n.value - plane_[0] - n.offset.x * plane_[1] - n.offset.y * plane_[2];
        const float y = core::luminance(off), cr = (off.x - y) / 1.5748f, cb = (off.z - y) / 1.8556f;
        const float w = std::sqrt(n.closeness);
        sum += w;
        luminance += w * y * y;
        red += w * cr * cr;
        blue += w * cb * cb;
    }
    // Chroma counts for half, as everywhere [BT709, 3.3]; freedoms that went into the plane are none of it.
    const float square = core::divide_or(std::max(luminance, 0.25f * std::max(red, blue)), sum, 0.0f);
    const auto n = static_cast<float>(count_);
    return std::sqrt(square * n / (n - static_cast<float>(freedoms_)));
}

int PlaneFit::nearest() const {
    const auto found = std::min_element(samples_.begin(), samples_.begin() + count_, [](const auto& a, const auto& b) {
        return glm::dot(a.offset, a.offset) < glm::dot(b.offset, b.offset);
    });
    return static_cast<int>(found - samples_.begin());
}

float PlaneFit::distance(int i) const {
    return glm::length(samples_[static_cast<std::size_t>(i)].offset);
}

/// Whether the samples' places along a direction are two, or nearly.
bool PlaneFit::in_two_columns(glm::vec2 along) const {
    float sum = 0, middle = 0;
    for (int i = 0; i < count_; ++i) {
        const Sample& n = samples_[static_cast<std::size_t>(i)];
        const float w = std::sqrt(n.closeness);
        sum += w;
        middle += w * glm::dot(n.offset, along);
    }
    middle = core::divide_or(middle, sum, 0.0f);
    // Moments about their middle.
    double second = 0, third = 0, fourth = 0;
    for (int i = 0; i < count_; ++i) {
        const Sample& n = samples_[static_cast<std::size_t>(i)];
        const double w = core::divide_or(std::sqrt(n.closeness), sum, 0.0f), at = glm::dot(n.offset, along) - middle;
        second += w * at * at;
        third += w * at * at * at;
        fourth += w * at * at * at * at;
    }
    // Kurtosis exceeds the square of skewness by 1 for two columns, by more for all else [Pearson1916].
    return fourth * second - third * third <= (1.0 + two_columns) * second * second * second;
}

float PlaneFit::unsure_rise() const {
    const glm::vec2 slope{core::luminance(plane_[1]), core::luminance(plane_[2])};
    const float steepest = glm::length(slope);
    float most = 0;
    for (const glm::vec2 along : {glm::vec2(1, 0), glm::vec2(0, 1), slope / steepest}) {
        const float rise = std::abs(glm::dot(slope, along));
        if (rise > most && in_two_columns(along)) most = rise;
    }
    return most * distance(nearest());
}

float PlaneFit::rise() const {
    return std::hypot(core::luminance(plane_[1]), core::luminance(plane_[2])) * distance(nearest());
}

}  // namespace render2mpeg::renderer
