#pragma once
// Follows a gather ray until what it meets is known, or is to be asked of the surface cache.
#include <cstdint>
#include <glm/glm.hpp>
#include <numbers>
#include <span>
#include <vector>

#include "core/numeric.h"
#include "renderer/base/plan.h"
#include "renderer/base/stream.h"
#include "renderer/gather/light_cells.h"
#include "renderer/geometry/ray_tracer.h"
#include "renderer/paths/light_sources.h"
#include "renderer/surface/posed_scene.h"

namespace render2mpeg::renderer {

/// A place of a surface whose radiance towards `outgoing` is wanted, and the cell of the surface cache that it lies in.
struct CellQuery {
    std::uint64_t key = 0;  ///< of the cell; sorts cells about by place
    core::SurfaceAddress address;
    glm::vec3 outgoing{0};   ///< unit, to where it is seen from
    float size = 0;          ///< of the cell, world; textures are filtered over it
    float carried = 1;       ///< share of a gather ray's light that comes from here, bounces that lie between counted
    std::uint8_t depth = 0;  ///< of a cell of its own: how many such cells lie between it and the point; else 0
    bool fibre = false;      ///< of hair
    bool polished = false;   ///< its lobe is seen as narrow as it is, by the one ray whose cell this is

    bool operator<(const CellQuery& other) const { return key < other.key; }
};

/// Part of a ray's radiance that a cell knows.
struct RayTerm {
    std::uint32_t ray = 0;  ///< index that its owner gives it
    glm::vec3 weight{1};
    CellQuery place;
    float near = 0;                         ///< NearField::share of where the ray comes from
    std::uint32_t cell = LightCells::none;  ///< once its owner has looked it up
};

/// Directions to lights of a kind that a place's shadow ray has one of.
struct LightChoices {
    std::uint32_t lamps = 1, surfaces = 1;
};

/// Lights that a ray's owner asked for by next events as well: those that the ray meets count by the balance heuristic
/// [Veach1995].
struct AskedLights {
    const LightSources& lights;
    LightQuery query;   ///< from where they were asked
    float density = 0;  ///< of the ray's direction, per steradian
    LightChoices choices{};

    /// `other`: density of the choice of such a light, one of so many.
    float share(float other, std::uint32_t choices_of_kind) const {
        return core::divide_or(density, density + static_cast<float>(choices_of_kind) * other, 0.0f);
    }
};

/// Size of cells over the length of the ray that meets them. chosen: 0.12 of 0.03 to 0.3; half of it takes half more
/// time in Sponza, and errs by 0.5 % in the mean instead of 0.8.
inline constexpr float cell_spread = 0.12f;

/// Lobes seen by cells that rays share are at least so wide (alpha): what a mirror-like floor throws is a matter of
/// caustics, and would be noise there. chosen: 0.25, a roughness of 0.5; not tuned.
inline constexpr float least_alpha_of_cells = 0.25f;

/// How a ray is looked along.
struct RayRules {
    float near = 0;                      ///< hits nearer than this get a cell of their own, world
    float brightest = 0;                 ///< luminance that the sky shows at most
    const AskedLights* asked = nullptr;  ///< set: emitters are seen, but in mirrors; null: surfaces shine not
    bool bounces = true;                 ///< surfaces send what they bounce
    /// Of a narrow lobe: it is mirrored on, sees unlit surfaces, and polished metal by a cell of its own.
    bool is_lobe = false;
    float spread = cell_spread;  ///< size of cells over the ray's length
    /// Of the sky that it sees. chosen: pi / 1024 of pi / 64 to pi / 1024: wider ones show a floor the sky below its
    /// horizon, by pi / 64 2 % too much of a bright one.
    float solid_angle = std::numbers::pi_v<float> / 1024;
    /// By object: luminous intensity of each of its light points, over pi. So large a disc, of luminance as met, is
    /// seen by rays of lobes in part (`lobe::by_trees`). 0, or empty: they see none of it.
    std::span<const float> shining{};
    /// Solid bodies of glass pass what surfaces bounce: caustics have light of lamps and sky.
    bool bodies_block = false;
    std::uint8_t depth = 0;   ///< of the place that it leaves, if that has a cell of its own
    bool own_volume = false;  ///< it begins within a medium, whose owner knows what the first segment loses and gains
};

/// Follows rays through the posed scene.
class GatherRays {
  public:
    GatherRays(const PosedScene& posed_scene, const Plan& plan);

    /// Radiance along the ray as far as it is known: of the sky, of lamps that were asked. Appends to `terms` a surface
    /// whose light is to be asked, if it meets any. `hit`: what the ray meets first. `numbers`: of this ray alone.
    /// `rays` counts those that it takes more.
    glm::vec3 follow(RayQuery ray, Hit hit, const RayRules& rules, const Stream& numbers, std::uint32_t index,
                     std::vector<RayTerm>& terms, std::uint64_t& rays) const;

    const PosedScene& posed_scene() const { return posed_scene_; }

  private:
    glm::vec3 escaped(glm::vec3 direction, const RayRules& rules, bool mirrored) const;
    glm::vec3 sky_in_pane(const SurfacePoint& pane, float solid_angle, std::uint64_t& rays) const;
    float fibre_cell(std::uint32_t object) const;
    CellQuery cell_query(const RayQuery& ray, const Hit& hit, float distance, const RayRules& rules,
                         const Stream& numbers) const;

    const PosedScene& posed_scene_;
    bool sky_light_, bounces_;  ///< passes of the plan
    float sky_in_panes_;        ///< luminance that panes mirror of the sky at most; 0: none
    float extent_;              ///< of the scene, world: places are sorted by its parts
    int extent_level_;          ///< power of two in it: scaled scenes have the same cells
    std::vector<bool> plain_;   ///< by material: opaque, neither mirror nor glass
    std::vector<bool> metal_;   ///< by material: it may be polished metal
    std::vector<bool> shines_;
    std::vector<bool> cut_out_;       ///< by material: plain but for holes
    std::vector<float> fibre_cells_;  ///< by object: the least size of cells among its strands, in its own space;
                                      ///< empty: there is no hair
};

}  // namespace render2mpeg::renderer
