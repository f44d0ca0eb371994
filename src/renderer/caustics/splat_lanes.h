#pragma once
// A landing against sixteen gather points: the innermost loops of caustics.
#include <cstdint>
#include <glm/glm.hpp>

namespace render2mpeg::renderer {

/// Points of a leaf, lane by lane; lanes without a point face nowhere.
struct alignas(64) SplatPoints {
    float x[16], y[16], z[16];
    float shading_x[16], shading_y[16], shading_z[16];        ///< unit, 0: no point
    float geometric_x[16], geometric_y[16], geometric_z[16];  ///< unit
    std::uint32_t object[16];
};

/// A landing as the loop reads it.
struct SplatQuery {
    glm::vec3 position{0}, direction{0}, normal{0};
    glm::vec3 axes[2]{};     ///< a point at e lies at the squared distance (e . axes[0])^2 + (e . axes[1])^2
    float peak = 0;          ///< irradiance over flux and cosine in the middle
    float plane = 0;         ///< within this of the landing's plane a point of its object is surely lit
    float along = 0;         ///< as far along the way points are lit
    float least_facing = 0;  ///< cosine between normals, of points that are surely lit
    std::uint32_t object = 0;
};

/// Effect of a landing on the lanes: irradiance over flux, and whether it is sure (1), asks a ray (2) or is none (0).
struct alignas(64) SplatShares {
    float weight[16];
    std::uint32_t state[16];
};

/// Returns the states of all lanes, or-ed.
std::uint32_t weigh(const SplatPoints& points, const SplatQuery& query, SplatShares& out);

/// Light of a leaf's lanes, summed up.
struct alignas(64) SplatSums {
    float red[16], green[16], blue[16];  ///< irradiance
    float squares[16];                   ///< of luminances
};

void add(const SplatShares& weights, glm::vec3 flux, SplatSums& sums);

}  // namespace render2mpeg::renderer
