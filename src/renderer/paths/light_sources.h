#pragma once
// Chooses directions towards lamps, shining surfaces and the sky, and knows how likely it does.
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "core/surface_address.h"
#include "renderer/base/plan.h"
#include "renderer/paths/source_tree.h"
#include "renderer/surface/posed_scene.h"

namespace render2mpeg::renderer {

/// Light from one direction. What a surface scatters of it: f_s cos x `light`, if nothing is in the way.
struct LightSample {
    glm::vec3 light{0};  ///< radiance over `density`, or irradiance across the beam over the chance of the choice
    glm::vec3 direction{0, 0, 1};  ///< unit, to the light
    glm::vec3 ray{0, 0, 1};        ///< the shadow ray's, from the query's origin
    float far = 0;                 ///< where that ends, in units of `ray`
    float density = 0;             ///< of choosing the direction, per steradian; 0: rays cannot meet the light
};

/// All that shines at the posed instant: punctual lights, suns, surfaces, the sky (docs/model/truth.md). Three choices
/// of a direction: to a lamp, to a surface, to the sky; each brings all light of its kind in the mean.
class LightSources {
  public:
    LightSources(const PosedScene& posed_scene, const Plan& plan);

    bool has_lamps() const { return !lamps_.empty(); }
    std::size_t lamp_count() const { return lamps_.size(); }
    bool has_surfaces() const { return !emitters_.empty(); }
    bool has_sky() const { return !sky_.empty(); }

    /// To a punctual light or a sun. `u`: for suns with a size.
    LightSample to_lamp(const LightQuery& query, float choice, glm::vec2 u) const;
    /// To a shining surface. What that emits is textured, and its coverage counts.
    LightSample to_surface(const LightQuery& query, float choice, glm::vec2 u) const;
    /// To the sky, where that is an image; one of one colour is met as often as it should.
    LightSample to_sky(const LightQuery& query, float choice, glm::vec2 u) const;

    /// Radiance of suns with a size that are in this direction, each times what `weight` makes of its density.
    template <class Weight>
    glm::vec3 suns(const LightQuery& query, glm::vec3 direction, Weight&& weight) const {
        glm::vec3 sum(0);
        for (const std::size_t i : suns_)
            if (glm::dot(direction, lamps_[i].to_light) >= lamps_[i].cosine)
                sum += lamps_[i].radiance * weight(lamp_density(query, i));
        return sum;
    }

    /// Density of `to_surface` in the direction of a place on a surface that it may choose; 0 on others.
    float surface_density(const LightQuery& query, const core::SurfaceAddress& address) const;
    /// Density of `to_sky`.
    float sky_density(glm::vec3 direction) const;

  private:
    struct Lamp {
        scene::LightState state;
        glm::vec3 to_light{0};       ///< directional
        float sine = 0, cosine = 1;  ///< suns: of half the angle; sine 0: a point
        glm::vec3 radiance{0};       ///< suns with a size
        float cone = 0;              ///< their solid angle
    };
    struct Emitter {
        std::uint32_t object = 0;
        glm::vec3 centre{0};
        float radius = 0;
        double power = 0;
        std::vector<double> sums;      ///< of area x luminance, triangle by triangle, rising
        std::vector<float> luminance;  ///< of each triangle
    };

    void find_lamps();
    void find_surfaces();
    void find_sky();
    float lamp_weight(const LightQuery& query, const Lamp& lamp) const;
    float lamp_density(const LightQuery& query, std::size_t index) const;
    LightSample lamp_sample(const LightQuery& query, const Lamp& lamp, float chance, glm::vec2 u) const;
    double emitter_chance(const LightQuery& query, std::size_t index) const;
    static double emitter_weight(const LightQuery& query, const Emitter& emitter);

    const PosedScene& posed_scene_;
    std::vector<Lamp> lamps_;
    std::vector<std::size_t> suns_;  ///< lamps with a size
    std::vector<Emitter> emitters_;
    SourceTree lamp_tree_, emitter_tree_;
    std::vector<int> emitter_of_;  ///< by object; -1: shines not
    std::vector<double> sky_;      ///< sums over cells of the sky, rising; empty: none is chosen
};

}  // namespace render2mpeg::renderer
