#pragma once
// Draws directions along a narrow lobe.
#include <algorithm>
#include <glm/glm.hpp>

#include "core/numeric.h"
#include "core/sampling.h"
#include "renderer/base/lobe.h"
#include "renderer/surface/surface_point.h"

namespace render2mpeg::renderer {

/// Mirrors at a narrow lobe's facets, by its visible normals [Heitz2018].
class NarrowLobe {
  public:
    explicit NarrowLobe(const SurfacePoint& p) : normal_(p.shading_normal), lobe_(p.bsdf, p.shading_normal) {
        if (!p.bsdf.is_stretched()) lobe_.alpha = glm::vec2(p.bsdf.alpha);
        eye_ = lobe_.local(p.outgoing);
        eye_.z = std::max(eye_.z, 1e-3f);
        eye_ = glm::normalize(eye_);
    }

    struct Drawn {
        glm::vec3 direction{0};
        float weight = 0;  ///< G2 / G1 [Heitz2018]; 0: below the surface
        float schlick = 0, density = 0;
    };
    Drawn draw(glm::vec2 u) const {
        const glm::vec3 half = visible_normal(eye_, lobe_.alpha, u);
        const float eye_half = std::max(glm::dot(eye_, half), 0.0f);
        const glm::vec3 light = 2.0f * eye_half * half - eye_;
        if (!(light.z > 0.0f)) return {};
        const float density = lobe_.density(half, eye_);
        return {
            core::normalize_or(lobe_.world(light), normal_),
            core::divide_or(lobe_.distribution(half) * lobe_.masking(light, eye_) * light.z, density, 0.0f),
            lobe::schlick(eye_half),
            density,
        };
    }

  private:
    glm::vec3 normal_, eye_{0};
    StretchedLobe lobe_;
};

}  // namespace render2mpeg::renderer
