#pragma once
// Facts of a film that decide which passes run.
#include "scene/model/animation.h"

namespace render2mpeg::scene {

/// Facts of a film that decide which passes run: true when any frame may show it.
struct Traits {
    bool has_surfaces = false;
    bool has_punctual_lights = false;
    bool has_emissive_surfaces = false;
    bool has_even_lamps = false;  ///< surfaces that keep their shape and shine evenly, or suns with a size
    bool has_shining_sky = false;
    bool has_diffuse_surfaces = false;  ///< any surface that light can bounce off diffusely
    bool has_glossy_surfaces = false;   ///< reflects in a lobe that light points can fill
    bool has_narrow_lobes = false;      ///< of them, in one so narrow that rays look along it
    bool has_mirrors = false;           ///< smooth enough that only a traced ray shows its reflection
    bool has_glass = false;             ///< transmission > 0
    bool has_bodies = false;            ///< of refractive glass
    bool casts_caustics = false;        ///< things that mirror or bend the light of lamps onto others
    bool has_alpha_mask = false;
    bool has_alpha_blend = false;
    bool has_hair = false;  ///< strands that scatter light as fibres
    bool has_subsurface = false;
    bool has_normal_maps = false;
    bool has_textures = false;
    bool camera_moves = false;
    bool objects_move = false;  ///< rigidly
    bool objects_deform = false;
    bool lights_change = false;  ///< move, or change their strength; emissive surfaces included
    bool has_cuts = false;
    bool has_open_shutter = false;
    bool has_aperture = false;            ///< a lens with defocus blur
    bool has_edited_reflections = false;  ///< of surfaces that mirror, sharply or in a lobe
    bool edits_move = false;              ///< or where they are to point
    bool has_glare = false;
    bool has_fog = false;
    bool has_volumes = false;
    bool volumes_change = false;  ///< move, or have other grids from frame to frame

    bool shows_motion() const {
        return has_open_shutter && (camera_moves || objects_move || objects_deform || lights_change);
    }
    bool changes_light() const { return objects_move || objects_deform || lights_change || volumes_change; }
    bool anything_moves() const { return camera_moves || edits_move || changes_light(); }
};

Traits traits_of(const Animation& animation);

/// Whether an object has a surface, no strands, that mirrors sharply or in a lobe.
bool mirrors(const Animation& animation, const Object& object);

/// Below this perceptual roughness a lobe counts as a mirror: light points would show as dots in it.
/// chosen: GGX alpha 0.01; tried 0.05..0.2, see docs/model/materials.md.
inline constexpr float mirror_roughness = 0.1f;

/// Share of light that a surface mirrors, about, seen from above; 0: it mirrors none.
float mirrored_share(const Material& material);

/// Whether a track moves the material's base colour, and so its alpha.
bool is_faded(const Animation& animation, std::uint32_t material);

/// Below this perceptual roughness a lobe counts as narrow: light points stand too far apart in it, and rays look along
/// it (final_gather.h). chosen: 0.35, where half the lobe spans some 14 degrees; not tuned.
inline constexpr float narrow_roughness = 0.35f;

}  // namespace render2mpeg::scene
