#include "scene/pose/surface_grid.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "scene/pose/pose.h"

namespace render2mpeg::scene {
namespace {

/// Samples along the longest edge of a triangle, so that no cell between is missed.
std::size_t steps_for(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c, double cell) {
    const double longest = std::max({glm::length(b - a), glm::length(c - a), glm::length(c - b)});
    return static_cast<std::size_t>(std::ceil(2 * longest / cell));
}

/// Of a mirrored object the corners run the other way round.
double side_of(const Object& object, const Pose& pose) {
    if (object.skin >= 0) return 1;
    return glm::determinant(glm::dmat3(pose.world_of(object.node))) < 0 ? -1 : 1;
}

}  // namespace

SurfaceGrid::SurfaceGrid(const Animation& animation, double seconds, const Extent& extent) : extent_(extent) {
    EXPECTS(extent.radius() > 0);
    const Pose pose = pose_at(animation, seconds);
    std::vector<std::vector<glm::dvec3>> positions;
    for (const Object& object : animation.objects) positions.push_back(world_positions(animation, object, pose));

    // Take the finest grid that can be filled at once. chosen: 2e7 samples take 0.2 s; 48 cells tell the rooms, pillars
    // and openings of six interiors apart, 24 closed some of the openings.
    constexpr std::size_t most_samples = 20'000'000;
    int longest = 48;
    set_size(longest);
    while (longest > 6 && samples_needed(positions, animation) > most_samples) set_size(longest /= 2);
    cells_.resize(static_cast<std::size_t>(size_.x) * static_cast<std::size_t>(size_.y) *
                  static_cast<std::size_t>(size_.z));

    for (std::size_t o = 0; o < positions.size(); ++o) {
        if (positions[o].empty()) continue;
        const double side = side_of(animation.objects[o], pose);
        for (const glm::uvec3& t : animation.meshes[static_cast<std::size_t>(animation.objects[o].mesh)].triangles)
            add_triangle(positions[o][t.x], positions[o][t.y], positions[o][t.z], side);
    }
}

std::size_t SurfaceGrid::samples_needed(const std::vector<std::vector<glm::dvec3>>& positions,
                                        const Animation& animation) const {
    std::size_t sum = 0;
    for (std::size_t o = 0; o < positions.size(); ++o) {
        if (positions[o].empty()) continue;
        for (const glm::uvec3& t : animation.meshes[static_cast<std::size_t>(animation.objects[o].mesh)].triangles) {
            const std::size_t steps = steps_for(positions[o][t.x], positions[o][t.y], positions[o][t.z], cell_);
            sum += (steps + 1) * (steps + 2) / 2;
        }
    }
    return sum;
}

void SurfaceGrid::set_size(int longest) {
    const glm::dvec3 extent = extent_.high - extent_.low;
    cell_ = std::max({extent.x, extent.y, extent.z}) / longest;
    size_ = glm::ivec3(glm::floor(extent / cell_)) + 1;
}

void SurfaceGrid::add_triangle(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c, double side) {
    ++triangle_;
    const glm::dvec3 cross = glm::cross(b - a, c - a);
    const double length = glm::length(cross);
    const glm::vec3 normal = length > 0 ? glm::vec3(cross * (side / length)) : glm::vec3(0);
    const std::size_t steps = std::max<std::size_t>(1, steps_for(a, b, c, cell_));
    for (std::size_t i = 0; i <= steps; ++i) {
        for (std::size_t j = 0; i + j <= steps; ++j) {
            const double u = static_cast<double>(i) / static_cast<double>(steps),
                         v = static_cast<double>(j) / static_cast<double>(steps);
            const glm::ivec3 where = cell_of(a + u * (b - a) + v * (c - a));
            if (!inside(where)) continue;
            Cell& cell = at(where);
            cell.normal += normal;
            ++cell.samples;
            if (cell.last_triangle != triangle_) ++cell.triangles;
            cell.last_triangle = triangle_;
        }
    }
}

glm::ivec3 SurfaceGrid::cell_of(glm::dvec3 point) const {
    return glm::ivec3(glm::floor((point - extent_.low) / cell_));
}

bool SurfaceGrid::inside(glm::ivec3 cell) const {
    return cell.x >= 0 && cell.y >= 0 && cell.z >= 0 && cell.x < size_.x && cell.y < size_.y && cell.z < size_.z;
}

std::size_t SurfaceGrid::index(glm::ivec3 cell) const {
    return (static_cast<std::size_t>(cell.z) * static_cast<std::size_t>(size_.y) + static_cast<std::size_t>(cell.y)) *
               static_cast<std::size_t>(size_.x) +
           static_cast<std::size_t>(cell.x);
}

bool SurfaceGrid::is_free(glm::dvec3 point) const {
    const glm::ivec3 centre = cell_of(point);
    for (int z = -1; z <= 1; ++z)
        for (int y = -1; y <= 1; ++y)
            for (int x = -1; x <= 1; ++x) {
                const glm::ivec3 cell = centre + glm::ivec3(x, y, z);
                if (inside(cell) && cells_[index(cell)].samples > 0) return false;
            }
    return true;
}

bool SurfaceGrid::closes_in(glm::dvec3 point) const {
    // Begin in the point's cell, or beside it where a surface passes through it.
    std::vector<glm::ivec3> open;
    std::vector<char> reached(cells_.size(), 0);
    const auto visit = [&](glm::ivec3 cell) {
        if (!inside(cell)) return false;
        if (cells_[index(cell)].samples > 0 || reached[index(cell)] != 0) return true;
        reached[index(cell)] = 1;
        open.push_back(cell);
        return true;
    };
    const glm::ivec3 centre = cell_of(point);
    if (!visit(centre)) return false;
    for (int k = 0; k < 27 && open.empty(); ++k)
        if (!visit(centre + glm::ivec3(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1))) return false;
    if (open.empty()) return false;

    // Flood the free cells.
    while (!open.empty()) {
        const glm::ivec3 cell = open.back();
        open.pop_back();
        for (int axis = 0; axis < 3; ++axis)
            for (const int step : {-1, 1}) {
                glm::ivec3 next = cell;
                next[axis] += step;
                if (!visit(next)) return false;
            }
    }
    return true;
}

void SurfaceGrid::look_along(glm::dvec3 eye, glm::dvec3 direction, Frame& seen) {
    // Clip to the box.
    double from = 0, to = 1e300;
    for (int k = 0; k < 3; ++k) {
        if (direction[k] == 0) {
            if (eye[k] < extent_.low[k] || eye[k] > extent_.high[k]) return;
            continue;
        }
        double t0 = (extent_.low[k] - eye[k]) / direction[k], t1 = (extent_.high[k] - eye[k]) / direction[k];
        if (t0 > t1) std::swap(t0, t1);
        from = std::max(from, t0);
        to = std::min(to, t1);
    }

    // March by half cells to the first surface. A cell whose normals cancel (a thin wall with two faces) faces
    // everyone.
    for (double t = from; t <= to; t += 0.5 * cell_) {
        const glm::ivec3 where = cell_of(eye + t * direction);
        if (!inside(where)) continue;
        Cell& cell = at(where);
        if (cell.samples == 0) continue;
        const float facing = -glm::dot(cell.normal, glm::vec3(direction)) / static_cast<float>(cell.samples);
        if (cell.seen == view_) return;
        cell.seen = view_;
        const bool faces = facing >= -0.05f;
        ++(faces ? seen.front : seen.back);
        if (faces) seen.detail += std::log2(1.0 + cell.triangles);
        return;
    }
}

SurfaceGrid::Frame SurfaceGrid::seen_from(glm::dvec3 eye, const glm::dmat3& axes) {
    ++view_;
    constexpr int columns = 18, rows = 12;
    constexpr double half_width = 0.55, half_height = 0.3640;  // tangents of 29 and 20 degrees
    Frame seen;
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x) {
            const double right = half_width * ((2 * x + 1.0) / columns - 1),
                         up = half_height * (1 - (2 * y + 1.0) / rows);
            look_along(eye, glm::normalize(axes * glm::dvec3(right, up, -1)), seen);
        }
    return seen;
}

}  // namespace render2mpeg::scene
