#include "renderer/geometry/surface_shape.h"

#include <algorithm>
#include <cmath>

#include "core/numeric.h"
#include "renderer/geometry/strands.h"

namespace render2mpeg::renderer {
namespace {

glm::vec3 absolute(glm::vec3 v) {
    return {std::abs(v.x), std::abs(v.y), std::abs(v.z)};
}
float largest(glm::vec3 v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

template <class T>
T mix3(const std::vector<T>& values, glm::uvec3 corners, glm::vec3 weights) {
    return weights.x * values[corners.x] + weights.y * values[corners.y] + weights.z * values[corners.z];
}

scene::Triangle triangle_of(const ObjectInstant& object, glm::uvec3 corners) {
    return {object.position(corners.x), object.position(corners.y), object.position(corners.z)};
}

/// The footprint's edge as a change of barycentrics: least squares over the triangle's plane, 0 for triangles without
/// area.
glm::vec2 to_barycentric(glm::dvec3 e1, glm::dvec3 e2, glm::dvec3 edge) {
    const double a = glm::dot(e1, e1), b = glm::dot(e1, e2), c = glm::dot(e2, e2);
    const double p = glm::dot(e1, edge), q = glm::dot(e2, edge);
    const double determinant = a * c - b * b;
    return {static_cast<float>(core::divide_or(c * p - b * q, determinant, 0.0)),
            static_cast<float>(core::divide_or(a * q - b * p, determinant, 0.0))};
}

/// Interpolating corners, and intersecting them with rays from about here, each err by some ulp of the coordinates,
/// axis by axis. chosen: 8 ulp; with 2^-22 no ray of 24 closed spheres (1e-4..1e6 in size, up to 1e4 radii away, still
/// and instanced) meets the surface it leaves, with 2^-24 1 % do.
constexpr float position_digits = 0x1p-20f;

/// How far points lie from their triangle's edges at least, in units of their position's error. chosen: 4, which is
/// beyond the error of the other wall of a seam, and of the ray that starts there.
constexpr float edge_distance = 4.0f;

/// How far the point may lie off the surface that rays meet, along its normal.
float error_at(const SurfaceShape& shape, const scene::Triangle& triangle, const scene::ObjectState& state,
               bool instanced) {
    // In a plane x = const the error along the normal is that of x alone.
    constexpr float relative = position_digits;
    const glm::vec3 extent = glm::max(glm::max(absolute(triangle.a), absolute(triangle.b)), absolute(triangle.c));
    // Where that is 0, on the floor y = 0, a ray still must not start in the plane: Embree takes distance 0 for a hit.
    const float own = relative * (glm::dot(absolute(shape.front_normal), extent) + relative * largest(extent));
    if (!instanced) return own;

    // A ray that goes through a transform errs by ulps of what is added up on the way, times how much the transform
    // distorts.
    const glm::mat4& m = state.to_world;
    const float distortion = std::min(distortion_of(m), 1024.0f);
    return own + relative * distortion * (largest(shape.position) + largest(glm::vec3(m[3])));
}

/// Weights of the point of the triangle that lies at least `distance` from its edges, next to the one of these weights;
/// they themselves where the triangle has no room for that. On the seam of two walls a point would lie in the plane of
/// the other wall, and rounding would decide whether that hides all light from it.
glm::vec3 off_edges(glm::vec3 weights, const SurfaceShape& shape, float distance) {
    const float area = glm::length(glm::cross(shape.edge1, shape.edge2));  // twice the triangle's
    if (!(area > 0.0f)) return weights;
    // A weight is the distance from the edge opposite to its corner, over the triangle's height there.
    const glm::vec3 least =
        distance / area *
        glm::vec3(glm::length(shape.edge2 - shape.edge1), glm::length(shape.edge2), glm::length(shape.edge1));
    if (!(least.x + least.y + least.z < 0.5f)) return weights;
    const glm::vec3 inside = glm::max(weights, least);
    if (inside == weights) return weights;
    // Take what was added from what is above its least.
    const glm::vec3 above = inside - least;
    const float sum = above.x + above.y + above.z, wanted = 1.0f - (least.x + least.y + least.z);
    return least + above * (wanted / sum);
}

}  // namespace

float distortion_of(const glm::mat4& m) {
    const float lengths[3] = {glm::length(glm::vec3(m[0])), glm::length(glm::vec3(m[1])), glm::length(glm::vec3(m[2]))};
    const auto [low, high] = std::minmax({lengths[0], lengths[1], lengths[2]});
    return core::divide_or(high, low, 1.0f);
}

glm::vec3 smooth_normal_at(const ObjectInstant& object, const SurfaceShape& shape, float u, float v) {
    if (!object.has_normals()) return shape.front_normal;
    const glm::uvec3 c = shape.corners;
    const glm::vec3 mixed = (1.0f - u - v) * object.normal(c.x) + u * object.normal(c.y) + v * object.normal(c.z);
    const glm::vec3 world = object.deforms() ? mixed : object.state().normal_to_world * mixed;
    const glm::vec3 normal = core::normalize_or(world, shape.front_normal);
    // Normals on the wrong side come from files that are wrong; the triangle's own is right.
    return glm::dot(normal, shape.front_normal) > 0.0f ? normal : shape.front_normal;
}

SurfaceShape shape_at(const ObjectInstant& object, const core::SurfaceAddress& address,
                      const SurfaceFootprint& footprint, bool instanced) {
    const scene::ObjectState& state = object.state();
    SurfaceShape shape;
    shape.mesh = &object.mesh();
    set_corners(shape, address);
    const scene::Triangle triangle = triangle_of(object, shape.corners);
    shape.edge1 = triangle.b - triangle.a;
    shape.edge2 = triangle.c - triangle.a;
    shape.position = shape.weights.x * triangle.a + shape.weights.y * triangle.b + shape.weights.z * triangle.c;

    const bool mirrored = state.deformed < 0 && glm::determinant(glm::mat3(state.to_world)) < 0.0f;
    const glm::vec3 wound = glm::cross(shape.edge1, shape.edge2);
    shape.front_normal = core::normalize_or(mirrored ? -wound : wound, {0, 0, 1});
    shape.smooth_normal = smooth_normal_at(object, shape, address.u, address.v);
    shape.position_error = error_at(shape, triangle, state, instanced);
    const glm::vec3 inside =
        off_edges(shape.weights, shape,
                  edge_distance * std::max(shape.position_error, position_digits * largest(shape.position)));
    if (inside != shape.weights) {
        shape.weights = inside;
        shape.position = inside.x * triangle.a + inside.y * triangle.b + inside.z * triangle.c;
    }
    if (footprint.dx != glm::vec3{0.0f} || footprint.dy != glm::vec3{0.0f}) {
        shape.barycentric_dx = to_barycentric(shape.edge1, shape.edge2, footprint.dx);
        shape.barycentric_dy = to_barycentric(shape.edge1, shape.edge2, footprint.dy);
    }
    return shape;
}

/// After [Hanika2021], for triangles whose normals can be meant. Changed: half of the lift, which is the curved surface
/// to second order (the whole lies as far above that again); and the surface has a normal too, that of shading, which
/// takes the triangle's place in deciding what light comes from behind.
SmoothSurface smooth_surface_at(const ObjectInstant& object, const SurfaceShape& shape, bool back_side) {
    // Normals of coarse meshes stand off their triangles; those that do by more, as of a box with the normals of a
    // ball, stand for no surface. chosen: 30 degrees, as of spheres of 8 segments around, fading out to 45.
    constexpr float meant = 0.866f, senseless = 0.707f;
    if (!object.has_normals()) return {};
    const glm::uvec3 c = shape.corners;
    const glm::vec3 normals[3] = {object.normal(c.x), object.normal(c.y), object.normal(c.z)};
    if (normals[0] == normals[1] && normals[1] == normals[2]) return {};
    const scene::ObjectState& state = object.state();
    const float side = back_side ? -1.0f : 1.0f;
    const glm::vec3 first = shape.position - shape.weights.y * shape.edge1 - shape.weights.z * shape.edge2;
    const glm::vec3 corner[3] = {first, first + shape.edge1, first + shape.edge2};
    SmoothSurface smooth;
    float least = 1.0f;
    for (int k = 0; k < 3; ++k) {
        const glm::vec3& own = normals[k];
        const glm::vec3 world = object.deforms() ? own : state.normal_to_world * own;
        const glm::vec3 normal = side * core::normalize_or(world, shape.front_normal);
        least = std::min(least, side * glm::dot(normal, shape.front_normal));
        // Move onto the corner's tangent plane where that lies above, and mix the three places.
        const float above = -glm::dot(shape.position - corner[k], normal);
        if (above > 0.0f) smooth.lift += shape.weights[k] * above * normal;
    }
    const float share = std::clamp((least - senseless) / (meant - senseless), 0.0f, 1.0f);
    if (share == 0.0f) return {};
    smooth.lift *= 0.5f * share;
    const glm::vec3 triangle = side * shape.front_normal;
    const glm::vec3 mixed = triangle + share * (side * shape.smooth_normal - triangle);
    smooth.tilt = core::normalize_or(mixed, triangle) - triangle;
    return smooth;
}

TextureSite site_of(const SurfaceShape& shape, const scene::TextureUse& use) {
    const std::vector<glm::vec2>& uv = shape.mesh->uv[static_cast<std::size_t>(use.uv_set)];
    if (uv.empty()) return {};
    const glm::vec2 at = mix3(uv, shape.corners, shape.weights);
    const glm::vec2 du = uv[shape.corners.y] - uv[shape.corners.x], dv = uv[shape.corners.z] - uv[shape.corners.x];
    const auto& m = use.transform;
    const auto turn = [&](glm::vec2 d) {
        return glm::vec2{m[0][0] * d.x + m[0][1] * d.y, m[1][0] * d.x + m[1][1] * d.y};
    };
    TextureSite site;
    site.uv = turn(at) + glm::vec2{m[0][2], m[1][2]};
    site.footprint.dx = turn(shape.barycentric_dx.x * du + shape.barycentric_dx.y * dv);
    site.footprint.dy = turn(shape.barycentric_dy.x * du + shape.barycentric_dy.y * dv);
    return site;
}

bool tangents_of(const ObjectInstant& object, const SurfaceShape& shape, const scene::TextureUse& use, glm::vec3& right,
                 glm::vec3& up) {
    // Take the mesh's own tangents where its vertices have not moved among themselves.
    const glm::vec3 n = shape.smooth_normal;
    if (!shape.mesh->tangents.empty() && !object.deforms()) {
        const glm::vec4 t = mix3(shape.mesh->tangents, shape.corners, shape.weights);
        const glm::mat3 turn(object.state().to_world);
        const float mirror = glm::determinant(turn) < 0.0f ? -1.0f : 1.0f;
        const glm::vec3 along = turn * glm::vec3(t);
        right = core::normalize_or(along - glm::dot(along, n) * n, glm::vec3{0.0f});
        up = glm::cross(n, right) * (t.w < 0.0f ? -mirror : mirror);
        return right != glm::vec3{0.0f};
    }

    // Else solve for the directions in which the texture coordinates grow; the image's up is towards smaller v.
    const std::vector<glm::vec2>& uv = shape.mesh->uv[static_cast<std::size_t>(use.uv_set)];
    if (uv.empty()) return false;
    const auto& m = use.transform;
    const auto turn = [&](glm::vec2 d) {
        return glm::vec2{m[0][0] * d.x + m[0][1] * d.y, m[1][0] * d.x + m[1][1] * d.y};
    };
    const glm::vec2 d1 = turn(uv[shape.corners.y] - uv[shape.corners.x]);
    const glm::vec2 d2 = turn(uv[shape.corners.z] - uv[shape.corners.x]);
    const float sign = d1.x * d2.y - d2.x * d1.y < 0.0f ? -1.0f : 1.0f;
    const glm::vec3 along_u = sign * (d2.y * shape.edge1 - d1.y * shape.edge2);
    const glm::vec3 along_v = sign * (d1.x * shape.edge2 - d2.x * shape.edge1);
    right = core::normalize_or(along_u - glm::dot(along_u, n) * n, glm::vec3{0.0f});
    up = glm::cross(n, right);
    if (glm::dot(up, along_v) > 0.0f) up = -up;
    return right != glm::vec3{0.0f} && d1.x * d2.y != d2.x * d1.y;
}

glm::vec4 vertex_color(const SurfaceShape& shape) {
    return shape.mesh->colors.empty() ? glm::vec4{1.0f} : mix3(shape.mesh->colors, shape.corners, shape.weights);
}

}  // namespace render2mpeg::renderer
