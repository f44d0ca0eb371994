#include "renderer/geometry/strands.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <utility>

#include "core/box.h"
#include "core/numeric.h"
#include "renderer/geometry/embree.h"
#include "scene/model/curves.h"

namespace render2mpeg::renderer {
namespace {

/// Points of strands lie so far above the fibre that rays leave, by its radius and by where it lies. chosen: a
/// hundredth, since strands bend, and the digits of surfaces (surface_shape.cpp).
constexpr float share_of_radius = 0.01f, strand_digits = 0x1p-20f;

/// Segments to a box in which strands are counted, if they were spread over all of the mesh. chosen: 64; a shell of fur
/// fills some tenth of its box.
constexpr double segments_to_box = 64;

}  // namespace

StrandPoint strand_at(const ObjectInstant& object, const core::SurfaceAddress& address) {
    const scene::Mesh& mesh = object.mesh();
    const scene::CurveWeights weights(static_cast<double>(address.u));
    const std::uint32_t first = mesh.curves[address.primitive];
    glm::dvec3 axis(0), along(0), chord(0);
    double radius = 0;
    for (std::uint32_t k = 0; k < 4; ++k) {
        const glm::dvec3 p(object.position(first + k));
        axis += weights.value[k] * p;
        along += weights.derivative[k] * p;
        radius += weights.value[k] * static_cast<double>(mesh.radii[first + k]);
        chord += k == 1 ? -p : k == 2 ? p : glm::dvec3(0);
    }
    StrandPoint point;
    point.axis = glm::vec3(axis);
    point.tangent = core::normalize_or(glm::vec3(along), core::normalize_or(glm::vec3(chord), glm::vec3(0, 0, 1)));
    const float width = object.deforms() ? 1.0f : scene::width_scale(object.state().to_world);
    point.radius = width * static_cast<float>(std::max(radius, 0.0));
    return point;
}

SurfaceShape strand_shape_at(const ObjectInstant& object, const core::SurfaceAddress& address, glm::vec3 outgoing,
                             bool instanced) {
    const StrandPoint strand = strand_at(object, address);
    SurfaceShape shape;
    shape.mesh = &object.mesh();
    set_corners(shape, address);
    const glm::vec3 towards =
        core::normalize_or(outgoing - glm::dot(outgoing, strand.tangent) * strand.tangent, strand.tangent);
    const glm::vec3 across = glm::cross(strand.tangent, towards);
    const float h = 2.0f * address.v - 1.0f;
    const glm::vec3 normal =
        core::normalize_or(h * across + core::sqrt_or_zero(1.0f - h * h) * towards, glm::vec3(0, 0, 1));
    shape.position = strand.axis + strand.radius * normal;
    shape.front_normal = shape.smooth_normal = normal;
    shape.edge1 = strand.tangent;
    shape.edge2 = across;
    const glm::vec3 a = glm::abs(shape.position);
    const float distortion = instanced ? 1.0f + distortion_of(object.state().to_world) : 1.0f;
    shape.position_error = share_of_radius * strand.radius + strand_digits * distortion * std::max({a.x, a.y, a.z});
    return shape;
}

void set_corners(SurfaceShape& shape, const core::SurfaceAddress& address) {
    if (shape.mesh->has_curves()) {
        const std::uint32_t from = shape.mesh->curves[address.primitive] + 1;
        shape.corners = {from, from + 1, from + 1};
        shape.weights = {1.0f - address.u, address.u, 0.0f};
        return;
    }
    shape.corners = shape.mesh->triangles[address.primitive];
    shape.weights = {1.0f - address.u - address.v, address.u, address.v};
}

float free_path_among(const scene::Mesh& mesh) {
    const auto bounds = core::Box::about(mesh.positions);
    const glm::dvec3 extent(bounds.size());
    const double widest = std::max({extent.x, extent.y, extent.z}), volume = std::max(extent.x, 0.01 * widest) *
                                                                             std::max(extent.y, 0.01 * widest) *
                                                                             std::max(extent.z, 0.01 * widest);
    const double side = std::max(
        std::cbrt(volume * segments_to_box / std::max(static_cast<double>(mesh.curves.size()), 1.0)), widest * 0x1p-20);
    // Cover of each box, as seen from all sides: a cylinder shows pi / 4 of its length times its width.
    std::vector<std::pair<std::uint64_t, double>> areas;
    for (const std::uint32_t first : mesh.curves) {
        const glm::dvec3 a(mesh.positions[first + 1]), b(mesh.positions[first + 2]);
        const glm::dvec3 at = (0.5 * (a + b) - glm::dvec3(bounds.low)) / side;
        std::uint64_t box = 0;
        for (int k = 0; k < 3; ++k) box = box << 21 | static_cast<std::uint64_t>(std::max(at[k], 0.0));
        const auto width = static_cast<double>(mesh.radii[first + 1] + mesh.radii[first + 2]);
        areas.emplace_back(box, 0.25 * std::numbers::pi * glm::length(b - a) * width);
    }
    std::sort(areas.begin(), areas.end());
    double all = 0, squares = 0;
    for (std::size_t first = 0, last = 0; first < areas.size(); first = last) {
        double sum = 0;
        for (; last < areas.size() && areas[last].first == areas[first].first; ++last) sum += areas[last].second;
        all += sum;
        squares += sum * sum;
    }
    return squares > 0 ? static_cast<float>(side * side * side * all / squares)
                       : std::numeric_limits<float>::infinity();
}

RTCGeometryTy* new_strands(RTCDeviceTy* device, const scene::Mesh& mesh,
                           std::span<const std::vector<glm::vec3>* const> steps, float width) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_FLAT_CATMULL_ROM_CURVE);
    rtcSetGeometryTimeStepCount(geometry, static_cast<unsigned>(steps.size()));
    for (unsigned k = 0; k < steps.size(); ++k) {
        const std::vector<glm::vec3>& positions = *steps[k];
        auto* const points = static_cast<glm::vec4*>(rtcSetNewGeometryBuffer(
            geometry, RTC_BUFFER_TYPE_VERTEX, k, RTC_FORMAT_FLOAT4, sizeof(glm::vec4), positions.size()));
        if (points == nullptr) continue;
        for (std::size_t i = 0; i < positions.size(); ++i) points[i] = glm::vec4(positions[i], width * mesh.radii[i]);
    }
    void* const first = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT,
                                                sizeof(std::uint32_t), mesh.curves.size());
    if (first != nullptr) std::memcpy(first, mesh.curves.data(), mesh.curves.size() * sizeof(std::uint32_t));
    rtcSetGeometryMask(geometry, 0xffffffffu);
    return geometry;
}

bool move_strands(glm::vec4* points, const std::vector<glm::vec3>& positions) {
    bool moved = false;
    for (std::size_t i = 0; i < positions.size(); ++i) {
        if (glm::vec3(points[i]) == positions[i]) continue;
        points[i] = glm::vec4(positions[i], points[i].w);
        moved = true;
    }
    return moved;
}

}  // namespace render2mpeg::renderer
