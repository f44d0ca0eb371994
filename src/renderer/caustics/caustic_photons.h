#pragma once
// Follows aimed photons through mirrors and glass to where light lands.
#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "renderer/base/plan.h"
#include "renderer/caustics/casters.h"
#include "renderer/surface/posed_scene.h"

namespace render2mpeg::renderer {

/// Light that a specular way brought to a surface that scatters.
struct Landing {
    glm::vec3 position{0}, normal{0};  ///< normal: geometric, unit, where the light comes from
    glm::vec3 direction{0};            ///< unit, of the light
    glm::vec3 flux{0};
    /// How place and direction differ for the photon's neighbours on caster and lamp, a kernel's semi-axis away.
    std::array<glm::vec3, 4> edges{}, turns{};
    float length = 0;                 ///< of the last way
    float spread = 0;                 ///< radius by which rough glass blurs it
    float time = scene::middle_time;  ///< of the shutter
    std::uint64_t photon = 0;         ///< its index
    std::uint32_t object = 0;         ///< where it lands
    std::uint32_t caster = 0;         ///< object that threw it there
};

struct LandingCounts {
    std::uint64_t photons = 0, rays = 0;
};

/// Photons first <= index < end of `count` (Casters::aim), by order of index; bounces end after twelve surfaces. Any
/// thread.
void follow_photons(const PosedScene& posed_scene, const Casters& casters, std::uint64_t first, std::uint64_t end,
                    std::uint64_t count, std::vector<Landing>& landings, LandingCounts& counts);

}  // namespace render2mpeg::renderer
