#include "renderer/geometry/largest_triangles.h"

#include <algorithm>
#include <cmath>

namespace render2mpeg::renderer {

float area2(const scene::Triangle& t) {
    const glm::vec3 n = glm::cross(t.b - t.a, t.c - t.a);
    const float v = glm::dot(n, n);
    return std::isfinite(v) ? v : 0.0f;
}

double largest_area2(const scene::Mesh& mesh) {
    double largest = 0.0;
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::dvec3 a = mesh.positions[t.x], b = mesh.positions[t.y], c = mesh.positions[t.z];
        const glm::dvec3 n = glm::cross(b - a, c - a);
        largest = std::max(largest, glm::dot(n, n));
    }
    return largest;
}

double widening2(const glm::mat4& m) {
    // Normals go by the matrix of cofactors, whose largest singular value its Frobenius norm bounds.
    const glm::dvec3 x = glm::vec3(m[0]), y = glm::vec3(m[1]), z = glm::vec3(m[2]);
    const glm::dvec3 a = glm::cross(y, z), b = glm::cross(z, x), c = glm::cross(x, y);
    return glm::dot(a, a) + glm::dot(b, b) + glm::dot(c, c);
}

void LargestTriangles::add(const scene::Triangle& t) {
    const float size = area2(t);
    const std::size_t place = added_++;
    if (size < least_) return;
    kept_.push_back({size, place, t});
    if (kept_.size() >= 4 * most_) leave_out_small();
}

void LargestTriangles::leave_out_small() {
    if (kept_.size() <= most_) return;
    const auto last = kept_.begin() + static_cast<std::ptrdiff_t>(most_ - 1);
    std::nth_element(kept_.begin(), last, kept_.end(), [](const Kept& a, const Kept& b) {
        return a.area2 != b.area2 ? a.area2 > b.area2 : a.place < b.place;
    });
    least_ = last->area2;
    kept_.erase(last + 1, kept_.end());
}

std::vector<scene::Triangle> LargestTriangles::in_order() {
    leave_out_small();
    std::sort(kept_.begin(), kept_.end(), [](const Kept& a, const Kept& b) { return a.place < b.place; });
    std::vector<scene::Triangle> triangles;
    for (const Kept& k : kept_) triangles.push_back(k.triangle);
    return triangles;
}

}  // namespace render2mpeg::renderer
