#pragma once
// Scenes of solid glass, and rays that are followed through them.
#include <cmath>
#include <limits>
#include <vector>

#include "core/numeric.h"
#include "renderer/surface/light_ray.h"
#include "stage.h"

namespace render2mpeg::test {

inline int add_glass(SceneBuilder& b, float ior = 1.5f) {
    const int m = b.add_material({1, 1, 1});
    scene::Material& glass = b.material(m);
    glass.specular_glossiness = false;
    glass.transmission = 1;
    glass.roughness = 0;
    glass.ior = ior;
    glass.thickness = scene::Thickness::solid;
    return m;
}

/// Where a ray is after it has passed all glass by its straightest way, and what is left of its light.
struct PassedRay : renderer::LightRay {
    glm::vec3 share{1};
    int boundaries = 0;
    core::SurfaceAddress address;  ///< of what it met last
};

inline PassedRay pass_glass(const Stage& stage, glm::vec3 origin, glm::vec3 direction,
                            renderer::Band band = renderer::Band::all) {
    PassedRay ray;
    ray.origin = origin;
    ray.direction = glm::normalize(direction);
    ray.band = band;
    for (int i = 0; i < 20; ++i) {
        const renderer::Hit hit = ray.meet(stage.posed_scene());
        if (!hit.found()) return ray;
        ray.share *= ray.left_by_bodies(stage.posed_scene(), hit);
        const renderer::SurfacePoint p = ray.surface_at(stage.posed_scene(), hit);
        ray.address = p.address;
        if (!p.bounds_body) return ray;
        ray.share *= p.bsdf.transmission;
        if (!ray.refract(stage.posed_scene(), p, p.shading_normal)) return ray;
        ++ray.boundaries;
    }
    return ray;
}

}  // namespace render2mpeg::test
