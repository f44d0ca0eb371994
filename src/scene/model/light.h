#pragma once
// Punctual lights.
#include <glm/glm.hpp>
#include <string>

namespace render2mpeg::scene {

enum class LightKind { point, spot, directional };

/// A punctual light [KHR_lights_punctual], in its node's space: it shines along -z.
struct Light {
    std::string name;
    int node = -1;
    LightKind kind = LightKind::point;
    glm::vec3 color{1, 1, 1};  ///< linear, 0..1
    float intensity = 1;  ///< point, spot: radiant intensity (W/sr or cd); directional: irradiance across the beam (lx)
    float range = 0;      ///< beyond it there is no light, faded as the extension says; 0: infinite
    float inner_cone = 0;          ///< spot: half angle of full light, radians
    float angle = 0;               ///< directional: half the angle that its disc spans, radians, 0..pi/2; 0: a point
    float outer_cone = 0.785398f;  ///< spot: half angle where the light ends, radians, > inner_cone
    float disc = 0;     ///< radius of the disc that mirrors and bodies of glass show, of suns at distance 1; 0: none
    bool seen = false;  ///< the eye sees that disc as well
    bool smooth_cosine = false;  ///< spot: dims by the cosine to the axis, between the cones by a smooth step in it
};

/// Background and sky light. Image (latitude-longitude, +y up, -z in the middle) times colour.
struct Sky {
    glm::vec3 color{0, 0, 0};  ///< radiance, or the factor of the image
    int image = -1;            ///< index into Animation::images; -1: constant colour
    float rotation = 0;        ///< about +y, radians

    bool shines() const { return color.x > 0 || color.y > 0 || color.z > 0; }
};

}  // namespace render2mpeg::scene
