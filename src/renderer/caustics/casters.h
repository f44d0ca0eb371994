#pragma once
// Casters of caustics, and photons aimed at them.
#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "renderer/base/discrete_distribution.h"
#include "renderer/base/light_point.h"
#include "renderer/lights/photon_source.h"
#include "renderer/lights/shining_surface.h"
#include "renderer/surface/light_ray.h"

namespace render2mpeg::renderer {

/// A photon as it leaves its lamp towards a caster.
struct AimedPhoton : LightRay {
    glm::vec3 flux{0};  ///< that it stands for; 0: none
    /// How neighbours differ in origin and direction, as the kernel's semi-axes: two of the same place of the lamp,
    /// and two of other places of it.
    std::array<glm::vec3, 4> place{}, turn{};
    std::uint32_t object = 0;  ///< that it is aimed at: light on another caster belongs to other photons
    std::uint64_t number = 0;  ///< among those of its beam, from 1: of the numbers that choose its way
};

/// Things that mirror or bend light, and the beams in which lamps light them. A beam is the rectangle about a thing, as
/// a point of the lamp sees it: photons stand evenly in it, and all carry about the same light. Beams share photons by
/// their light; a tenth evenly.
class Casters {
  public:
    /// Of the posed instant. `lights`: all of its light points. `sky_of_rays`: luminance up to which gather rays see
    /// the sky in panes; 0: they do not.
    Casters(const PosedScene& posed_scene, std::span<const LightPoint> lights, float sky_of_rays);

    bool empty() const { return beams_.empty(); }

    /// Photon `index` of `count`, 0 <= index < count. What comes of all adds up to the light of all lamps on all
    /// things.
    AimedPhoton aim(std::uint64_t index, std::uint64_t count) const;

  private:
    using Corners = BoxCorners;
    struct Thing {
        std::uint32_t object = 0;
        float weight = 0;   ///< share of light that it throws, about
        bool pane = false;  ///< glass that passes light straight, and throws what it mirrors
        Corners corners{};
        std::vector<Corners> knots{};  ///< of the sweep, where it moves
        Corners at(float time) const;
    };
    /// Lights that belong together: one shining object, the sky, a lamp, or all that are weaker than most.
    struct Lamp {
        std::vector<LightPoint> points{};
        std::vector<ShiningSurface> surfaces{};
        bool sky = false, sky_of_panes = false;  ///< what panes have of the sky is another lamp
        DiscreteDistribution choice{};           ///< of points, then of surfaces, by light
    };
    /// Where a photon begins.
    struct Origin {
        LightPoint light;                         ///< its intensity is the lamp's, as if all of it lay there
        const ShiningSurface* surface = nullptr;  ///< null: a point, or a part of the sky
        float share = 0;                          ///< of the lamp's photons that such a surface has
    };
    struct Beam {
        std::uint32_t lamp = 0, thing = 0;
        double light = 0;  ///< luminance flux that is sent on, about
        double share = 0;  ///< of the photons
    };
    void add_lamps(const PosedScene& posed_scene, std::span<const LightPoint> lights, float sky_of_rays);
    static Origin origin_of(const Lamp& lamp, glm::vec2 u);
    static double caustic_flux(const Lamp& lamp, const Thing& thing);
    const Beam& beam_of(std::uint64_t index, std::uint64_t count, std::uint64_t& first, std::uint64_t& end) const;
    float leave(const LightPoint& light, const SeenBox& seen, glm::vec2 u, AimedPhoton& photon) const;
    void spread(const Origin& origin, const SeenBox& seen, float photons, AimedPhoton& photon) const;

    std::vector<Thing> things_;
    std::vector<Lamp> lamps_;
    std::vector<Beam> beams_;
    float reach_ = 0;      ///< directional light comes from so far
    bool sweeps_ = false;  ///< things move while the shutter is open
};

}  // namespace render2mpeg::renderer
