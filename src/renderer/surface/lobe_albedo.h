#pragma once

namespace render2mpeg::renderer {

/// Light takes no surface for brighter than this, so that a closed room has a sum of light and every path an end.
/// chosen: 0.99, above all real paints (0.97 for barium sulphate); a room of such walls holds 100 times its lamp's
/// light.
inline constexpr float largest_albedo = 0.99f;

/// Reflectance of a GGX lobe under even light, seen from one direction: `f0` x its reflectance at normal incidence +
/// `f90` x that at grazing incidence. Their sum is the lobe's directional albedo without Fresnel loss: below 1 by the
/// facets' shadowing of one another.
struct LobeAlbedo {
    float f0 = 0, f90 = 0;
    float whole() const { return f0 + f90; }
};

/// Integrals of D V cos (1 - s) and of D V cos s over light directions, where s is Schlick's fifth power, by the cosine
/// of the outgoing direction (0..1) and the lobe's alpha (0.01..1): interpolated between 16 x 16 of them, within 0.015,
/// 0.002 on average. [Karis2013, "Environment BRDF"]
LobeAlbedo lobe_albedo(float cosine, float alpha);

/// Mean of Schlick's fifth power of the angle to the half vector over the hemisphere of light directions with the
/// cosine, by the cosine of the outgoing direction (0..1): what an even light loses at a Lambert surface under a coat.
/// Within 0.0004.
float mean_schlick(float cosine);

}  // namespace render2mpeg::renderer
