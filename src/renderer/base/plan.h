#pragma once
// The plan: which passes run for a frame, and why.
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "scene/preparation/traits.h"

namespace render2mpeg::renderer {

/// Everything that may run for a frame, in dependency order: no pass reads what a later one writes in the same frame.
enum class Pass {
    pose,
    textures,
    normal_maps,
    alpha,
    mirrors,
    lobe_rays,
    glass,
    refraction,
    subsurface,
    sky_background,
    edited_reflections,
    see,
    shutter,
    lens,
    motion,
    punctual_lights,
    emissive_lights,
    sky_light,
    area_lamps,
    caustics,
    hair,
    direct_tree,
    photons,
    indirect_tree,
    glossy,
    air,
    volumes,
    shade,
    layers,
    glare,
    develop,
    encode,
    count
};

/// Requests of the user that decide which passes run.
struct Wanted {
    bool picture = true;          ///< shaded pixels at all
    bool film = true;             ///< coded pictures: develop, motion, encode
    bool layers = false;          ///< --aov
    bool indirect = true;         ///< --vpls above 0
    bool by_rays = false;         ///< --indirect rays: light points carry no bounced light
    bool caustics = true;         ///< --caustics
    bool developed = false;       ///< pictures for a display that are not coded (.y4m, .png): develop alone
    std::optional<Pass> without;  ///< an effect that is left out although the scene calls for it
};

/// One row of the plan: whether a pass runs, and why.
struct PlanRow {
    Pass pass;
    const char* name;
    bool runs = false;
    std::string reason;      ///< "no cause: nothing is transparent", "nobody reads it", or what calls for it
    const char* reads = "";  ///< inputs, and of which frames: n this one, n-1, the chunk (its first frame), the film
    const char* writes = "";
    const char* effect = "";  ///< loss in pictures where it is left out; empty: it cannot be left out by itself
};

/// Which passes run: a pass runs if its cause is in the scene and its product is wanted.
class Plan {
  public:
    explicit Plan(std::vector<PlanRow> rows) : rows_(std::move(rows)) {}
    bool runs(Pass pass) const { return rows_[static_cast<std::size_t>(pass)].runs; }
    const std::vector<PlanRow>& rows() const { return rows_; }
    /// Whether gather rays see the sky that panes mirror; else it is a caustic.
    bool rays_see_sky_in_panes() const {
        return runs(Pass::caustics) && runs(Pass::sky_light) && runs(Pass::indirect_tree) && !runs(Pass::photons);
    }

  private:
    std::vector<PlanRow> rows_;
};

Plan make_plan(const scene::Traits& traits, const Wanted& wanted);

}  // namespace render2mpeg::renderer
