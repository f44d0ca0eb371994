#pragma once

namespace render2mpeg::renderer {

/// How facets hide each other from light and eye: together [Heitz2014, eq. 99], or one apart from the other (eq. 98).
enum class Masking { correlated, separable };

/// A GGX lobe under even light, seen from one direction.
struct LobeMoments {
    float whole = 0;    ///< reflectance of facets that reflect all
    float fresnel = 0;  ///< of facets that reflect (F - F0) / (1 - F0), F of a dielectric [BornWolf, 1.5.2]
    float edge = 0;     ///< of facets that reflect c (1 - c)^6, c the cosine to them
};

/// By the cosine of the outgoing direction (0..1), the lobe's alpha (0.01..1) and the root of the dielectric's F0, 0 to
/// 0.5: interpolated between 16 x 16 x 9 of them, by 1,024 visible normals each, made when first asked for.
LobeMoments lobe_moments(float cosine, float alpha, float root_f0, Masking masking);

/// Mean of `whole` of correlated masking over directions with their cosine.
float mean_whole(float alpha);

/// The same of a smooth dielectric's (F - F0) / (1 - F0).
float mean_fresnel(float root_f0);

/// Share of light along a direction of this cosine that facets do not hide. [Heitz2014, eqs. 43, 72]
float unhidden(float cosine, float alpha);

/// (F - F0) / (1 - F0) of a smooth dielectric at this cosine (0..1).
float relative_fresnel(float cosine, float root_f0);

}  // namespace render2mpeg::renderer
