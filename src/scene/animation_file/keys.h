#pragma once
// Every key that an animation file may have.
#include <string_view>
#include <vector>

#include "core/text.h"

/// Keys of each kind of object; a test holds docs/animation-file.schema.json against them.
namespace render2mpeg::scene::animation_file_keys {

using Keys = std::vector<std::string_view>;
inline const Keys film = core::words_in(
    "$schema title scene closed_glass_is_solid size display_aspect frame_rate frames seconds times sky exposure camera "
    "cameras shots "
    "lights objects materials change sound view shutter shutter_phase rolling_shutter glare grain fog transparent "
    "limits "
    "stereo "
    "volumes chapters");
inline const Keys limits = core::words_in("layers");
inline const Keys fog = core::words_in("visibility color anisotropy height falloff bounces");
inline const Keys volume = core::words_in(
    "name file more frames first_frame size node position rotate scale visible keys interpolation loop density color "
    "anisotropy absorption_color emission emission_color blackbody blackbody_tint temperature density_grid "
    "temperature_grid color_grid");
inline const Keys volume_key = core::words_in("at position rotate scale visible");
inline const Keys glare = core::words_in("kind strength size seed");
inline const Keys view = core::words_in("name gamma");
inline const Keys camera = core::words_in(
    "position look_at rotate roll fov height interpolation keys loop near shift f_stop focus sensor_height "
    "blades blade_rotation squeeze far projection longitudes latitudes stereo");
inline const Keys stereo =
    core::words_in("interocular_distance convergence_distance convergence pivot spherical pole_merge");
inline const Keys camera_key = core::words_in("at position look_at rotate roll fov f_stop focus");
inline const Keys shot = core::words_in("at camera");
inline const Keys chapter = core::words_in("at title");
inline const Keys light = core::words_in(
    "name kind color intensity range position look_at rotate angle softness falloff elevation azimuth size radius "
    "power "
    "keys interpolation loop repeat colors stagger seen round");
inline const Keys light_key = core::words_in("at position look_at rotate power");
inline const Keys object = core::words_in(
    "name shape size radius top_radius tube_radius height opening profile crease segments strands tip_radius uv "
    "parts material position rotate scale visible keys interpolation loop repeat colors reflections");
inline const Keys object_key = core::words_in("at position rotate scale visible reflections");
inline const Keys reflection = core::words_in("at see radius border");
inline const Keys change = core::words_in("position rotate scale visible keys interpolation loop material reflections");
inline const Keys repeat = core::words_in("count step centered ring");
inline const Keys ring = core::words_in("count radius from to");
inline const Keys material = core::words_in(
    "base_color texture texture_scale alpha alpha_cutoff metallic roughness normal_texture normal_scale emission "
    "emission_texture transmission ior solid attenuation attenuation_distance dispersion hair subsurface "
    "model specular multiscatter gloss coat_ior coat_tint diffuse_roughness by_angle "
    "double_sided unlit holdout seen power keys interpolation loop");
inline const Keys hair = core::words_in("color absorption melanin redness roughness azimuthal_roughness coat ior tilt");
inline const Keys subsurface = core::words_in("weight free_path");
inline const Keys by_angle = core::words_in("base_color emission gloss metallic roughness alpha transmission coat");
inline const Keys angle_curve = core::words_in("other texture share");
inline const Keys material_key = core::words_in("at power");
inline const Keys checker = core::words_in("checker squares");
inline const Keys sky = core::words_in("color image rotation strength zenith horizon ground");

}  // namespace render2mpeg::scene::animation_file_keys
