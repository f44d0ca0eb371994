#include "renderer/view/normal_spread.h"

#include <algorithm>
#include <cmath>

#include "core/numeric.h"
#include "core/sampling.h"
#include "renderer/surface/lobe_albedo.h"

namespace render2mpeg::renderer {
namespace {

/// Lobes keep their width where its square grows by less. chosen: a twentieth, of which roughness grows by 1 %.
constexpr float least_growth = 0.05f;

/// Round lobes stay round where their widths differ by less: those have records. chosen: twice.
constexpr float round_enough = 2.0f;

/// Normals that differ by more belong to other points (same_normal).
constexpr float farthest_turn = 0.2f;

/// A symmetric matrix ((a, b), (b, d)).
struct Symmetric {
    float a = 0, b = 0, d = 0;

    void add(glm::vec2 axis, float square) {
        a += square * axis.x * axis.x;
        b += square * axis.x * axis.y;
        d += square * axis.y * axis.y;
    }
    /// Its eigenvalues, the larger first, and the unit vector of that.
    glm::vec2 values() const {
        const float middle = 0.5f * (a + d), off = std::hypot(0.5f * (a - d), b);
        return {middle + off, std::max(middle - off, 0.0f)};
    }
    glm::vec2 axis() const {
        const float angle = 0.5f * std::atan2(2.0f * b, a - d);
        return {std::cos(angle), std::sin(angle)};
    }
};

}  // namespace

void NormalSpread::add(glm::vec3 normal, const SurfaceFootprint& turn, float weight) {
    if (first_ == glm::vec3(0)) first_ = normal;
    const glm::vec3 off = normal - first_;
    weight_ += weight;
    sum_ += weight * off;
    squares_ += weight * glm::outerProduct(off, off);
    for (glm::vec3 change : {turn.dx, turn.dy}) {
        const float length = glm::length(change);
        if (length > farthest_turn) change *= farthest_turn / length;
        squares_ += weight / 12.0f * glm::outerProduct(change, change);
    }
}

void NormalSpread::fold_into(SurfacePoint& point) const {
    if (!(weight_ > 0.0f) || (sum_ == glm::vec3(0) && squares_ == glm::mat3(0))) return;
    const glm::vec3 mean = sum_ / weight_, normal = core::normalize_or(first_ + mean, point.shading_normal);
    if (!(glm::dot(normal, point.geometric_normal) > 0.0f && glm::dot(normal, point.outgoing) > 0.0f)) return;
    point.shading_normal = normal;
    Bsdf& bsdf = point.bsdf;
    if (!bsdf.has_lobe()) return;
    glm::vec3 x, y;
    core::make_frame(normal, x, y);
    const auto varies = [&](glm::vec3 u, glm::vec3 v) {
        return glm::dot(u, squares_ * v) / weight_ - glm::dot(u, mean) * glm::dot(v, mean);
    };
    Symmetric widths{2.0f * varies(x, x), 2.0f * varies(x, y), 2.0f * varies(y, y)};
    if (!(widths.values().x > least_growth * bsdf.alpha * bsdf.alpha)) return;
    const float across2 = bsdf.alpha * bsdf.alpha, along2 = bsdf.alpha_along * bsdf.alpha_along;
    widths.add({1, 0}, across2);
    widths.add({0, 1}, across2);
    if (bsdf.is_stretched()) widths.add({glm::dot(x, bsdf.along), glm::dot(y, bsdf.along)}, along2 - across2);
    const float cosine = glm::dot(normal, point.outgoing), reflected = lobe_albedo(cosine, bsdf.mean_alpha()).whole();
    // It stays one that rays look along.
    const float widest = bsdf.has_narrow_lobe() ? 0.999f * narrow_alpha : 1.0f;
    const glm::vec2 alphas = glm::min(glm::sqrt(widths.values()), glm::vec2(1, widest));
    if (bsdf.is_stretched() || alphas.x > round_enough * alphas.y) {
        const glm::vec2 axis = widths.axis();
        bsdf.along = axis.x * x + axis.y * y;
        bsdf.alpha_along = alphas.x;
        bsdf.alpha = alphas.y;
    } else {
        bsdf.along = glm::vec3(0);
        bsdf.alpha_along = 1;
        bsdf.alpha = std::min(std::sqrt(alphas.x * alphas.y), widest);
    }
    // Facets of the surface hide one another, bends of it do not.
    const float kept = core::divide_or(reflected, lobe_albedo(cosine, bsdf.mean_alpha()).whole(), 1.0f);
    bsdf.f0 *= kept;
    bsdf.f90 *= kept;
}

}  // namespace render2mpeg::renderer
