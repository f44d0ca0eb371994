#include "scene/preparation/traits.h"

#include <algorithm>

#include "scene/preparation/validate.h"

namespace render2mpeg::scene {
namespace {

/// Possible effects of a material, with its textures taken at their extremes (they multiply the factors by 0..1).
void add_material(const Material& material, Traits& traits) {
    const bool rough_texture = material.metallic_roughness_texture.present() ||
                               material.specular_glossiness_texture.present() ||
                               material.curve_of(AngledInput::roughness) != nullptr;
    const float roughness = material.specular_glossiness ? 1 - material.glossiness : material.roughness;
    const float largest_roughness = material.specular_glossiness && rough_texture ? 1.0f : roughness;
    const float smallest_roughness = rough_texture && !material.specular_glossiness ? 0.0f : roughness;
    const bool all_metal = !material.specular_glossiness && material.metallic >= 1 &&
                           !material.metallic_roughness_texture.present() &&
                           material.curve_of(AngledInput::metallic) == nullptr;
    const bool has_base = material.base_color.x > 0 || material.base_color.y > 0 || material.base_color.z > 0;
    const bool all_glass = material.transmission >= 1 && !material.transmission_texture.present() &&
                           material.curve_of(AngledInput::transmission) == nullptr;
    const bool reflects = material.specular_glossiness
                              ? material.specular != glm::vec3(0)
                              : material.ior > 1 || (material.metallic > 0 && has_base) || material.has_gloss();
    const bool smooth_coat = material.coat > 0 && (material.coat_roughness < mirror_roughness || all_metal ||
                                                   material.coat_roughness_texture.present());
    const bool rough_coat = material.coat > 0 && material.coat_roughness >= mirror_roughness;

    const bool shaped = material.model == SurfaceModel::principled_3 || material.diffuse_roughness > 0;

    if (!material.unlit) {
        if (shaped && has_base && !all_metal && !all_glass) traits.has_glossy_surfaces = true;
        if (has_base && !all_metal && !all_glass) traits.has_diffuse_surfaces = true;
        if (reflects && largest_roughness >= mirror_roughness) traits.has_glossy_surfaces = true;
        if (reflects && largest_roughness >= mirror_roughness && smallest_roughness < narrow_roughness)
            traits.has_narrow_lobes = true;
        if (reflects && smallest_roughness < mirror_roughness) traits.has_mirrors = true;
        if (smooth_coat || (material.coat > 0 && material.metallic > 0)) traits.has_mirrors = true;
        if (rough_coat) traits.has_glossy_surfaces = true;
        if (rough_coat && (material.coat_roughness < narrow_roughness || material.coat_roughness_texture.present()))
            traits.has_narrow_lobes = true;
        if (material.has_sheen()) traits.has_diffuse_surfaces = true;
        if (material.transmission > 0 && !all_metal) traits.has_glass = true;
        if (material.normal_texture.present()) traits.has_normal_maps = true;
    }
    if (material.emits()) traits.has_emissive_surfaces = true;
    if (material.alpha_mode == AlphaMode::mask) traits.has_alpha_mask = true;
    if (material.alpha_mode == AlphaMode::blend) traits.has_alpha_blend = true;
    for (const auto& [use, name] : texture_uses)
        if ((material.*use).present()) traits.has_textures = true;
}

bool camera_moves(const Animation& animation, const std::vector<char>& moves) {
    const auto moved = [&](int camera) {
        const int node = animation.cameras[static_cast<std::size_t>(camera)].node;
        if (node >= 0 && moves[static_cast<std::size_t>(node)]) return true;
        return std::any_of(animation.tracks.begin(), animation.tracks.end(), [&](const Track& track) {
            return track.target == TrackTarget::field_of_view && track.index == camera && varies(track);
        });
    };
    if (animation.shots.empty()) return !animation.cameras.empty() && moved(0);
    return std::any_of(animation.shots.begin(), animation.shots.end(),
                       [&](const Shot& shot) { return moved(shot.camera); });
}

/// Whether any camera used by the film has defocus blur.
bool has_aperture(const Animation& animation) {
    const auto has = [&](int camera) { return animation.cameras[static_cast<std::size_t>(camera)].f_stop > 0; };
    if (animation.shots.empty()) return !animation.cameras.empty() && has(0);
    return std::any_of(animation.shots.begin(), animation.shots.end(),
                       [&](const Shot& shot) { return has(shot.camera); });
}

bool has_cuts(const Animation& animation) {
    return std::any_of(animation.shots.begin(), animation.shots.end(),
                       [&](const Shot& shot) { return shot.camera != animation.shots.front().camera; });
}

/// Whether the object's own deformation changes over time, not only its shape once and for all.
bool deforms(const Animation& animation, const Object& object, const std::vector<char>& moves) {
    if (object.mobility != Mobility::deforming) return false;
    if (object.skin >= 0)
        for (const int joint : animation.skins[static_cast<std::size_t>(object.skin)].joints)
            if (moves[static_cast<std::size_t>(joint)]) return true;
    return std::any_of(animation.tracks.begin(), animation.tracks.end(), [&](const Track& track) {
        return track.target == TrackTarget::weights && track.index == object.node && varies(track);
    });
}

void add_edits(const Animation& animation, const std::vector<char>& moves, Traits& traits) {
    traits.has_edited_reflections = !animation.reflections.empty();
    for (std::size_t k = 0; k < animation.reflections.size(); ++k) {
        const Reflection& edit = animation.reflections[k];
        const bool grows = std::any_of(animation.tracks.begin(), animation.tracks.end(), [&](const Track& t) {
            return (t.target == TrackTarget::reflection_radius || t.target == TrackTarget::reflection_border) &&
                   t.index == static_cast<int>(k) && varies(t);
        });
        if (grows || moves[static_cast<std::size_t>(edit.at)] || moves[static_cast<std::size_t>(edit.see)])
            traits.edits_move = true;
    }
}

}  // namespace

bool mirrors(const Animation& animation, const Object& object) {
    Traits traits;
    add_material(animation.materials[static_cast<std::size_t>(object.material)], traits);
    return (traits.has_mirrors || traits.has_glossy_surfaces) &&
           !animation.meshes[static_cast<std::size_t>(object.mesh)].has_curves();
}

Traits traits_of(const Animation& animation) {
    Traits traits;
    const std::vector<char> moves = moving_nodes(animation);
    traits.has_surfaces = !animation.objects.empty();
    traits.has_shining_sky = animation.sky.shines();
    traits.camera_moves = camera_moves(animation, moves);
    traits.has_cuts = has_cuts(animation);
    traits.has_open_shutter = animation.shutter.is_open();
    traits.has_aperture = has_aperture(animation);
    traits.has_glare = animation.glare.shows();
    traits.has_fog = animation.fog.shows();
    traits.has_volumes = !animation.volumes.empty();
    for (const Volume& volume : animation.volumes) {
        // Flames are lamps.
        if (volume.emits()) traits.has_punctual_lights = true;
        if (volume.files.size() > 1 || (volume.node >= 0 && moves[static_cast<std::size_t>(volume.node)]))
            traits.volumes_change = true;
    }

    add_edits(animation, moves, traits);
    for (const Object& object : animation.objects) {
        const Material& material = animation.materials[static_cast<std::size_t>(object.material)];
        add_material(material, traits);
        if (material.subsurface) traits.has_subsurface = true;
        if (material.hair && animation.meshes[static_cast<std::size_t>(object.mesh)].has_curves())
            traits.has_hair = true;
        if (object.body != Body::none) traits.has_bodies = true;
        if (object.body == Body::solid) traits.casts_caustics = true;
        const bool by_node = object.node >= 0 && moves[static_cast<std::size_t>(object.node)] && object.skin < 0;
        if (by_node) traits.objects_move = true;
        if (deforms(animation, object, moves)) traits.objects_deform = true;
        if (material.emits() && !material.unlit && !material.emission_texture.present() &&
            material.curve_of(AngledInput::emission) == nullptr && object.mobility != Mobility::deforming)
            traits.has_even_lamps = true;
        if (material.emits() && (by_node || deforms(animation, object, moves))) traits.lights_change = true;
    }
    if (traits.has_mirrors) traits.casts_caustics = true;
    for (const Light& light : animation.lights) {
        if (light.intensity <= 0 || light.color == glm::vec3(0)) continue;
        traits.has_punctual_lights = true;
        if (light.angle > 0) traits.has_even_lamps = true;
        if (light.node >= 0 && moves[static_cast<std::size_t>(light.node)]) traits.lights_change = true;
    }
    for (const Track& track : animation.tracks)
        if ((track.target == TrackTarget::light_intensity || track.target == TrackTarget::emission ||
             track.target == TrackTarget::light_color || track.target == TrackTarget::base_color) &&
            varies(track))
            traits.lights_change = true;
    return traits;
}

bool is_faded(const Animation& animation, std::uint32_t material) {
    return std::any_of(animation.tracks.begin(), animation.tracks.end(), [&](const Track& track) {
        return track.target == TrackTarget::base_color && track.index == static_cast<int>(material);
    });
}

float mirrored_share(const Material& m) {
    const auto largest = [](glm::vec3 v) { return std::max({v.x, v.y, v.z}); };
    if (m.specular_glossiness) {
        const bool smooth = 1.0f - m.glossiness < mirror_roughness || m.specular_glossiness_texture.present();
        return smooth ? largest(m.specular) : 0.0f;
    }
    const float r = (m.ior - 1.0f) / (m.ior + 1.0f);
    const bool smooth = m.roughness < mirror_roughness || m.metallic_roughness_texture.present() ||
                        m.curve_of(AngledInput::roughness) != nullptr;
    const float share =
        smooth ? std::max(m.metallic * largest(glm::vec3(m.base_color)), r * r * m.specular_weight) : 0.0f;
    return m.coat_roughness < mirror_roughness ? std::max(share, 0.04f * m.coat) : share;
}

}  // namespace render2mpeg::scene
