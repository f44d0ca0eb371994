#pragma once

#include <cmath>
#include <glm/glm.hpp>

#include "scene/preparation/traits.h"

namespace render2mpeg::renderer {

/// GGX width below which a lobe counts as narrow.
/// A little below that of narrow_roughness: means over a pixel round, and a scene without narrow lobes has no point
/// with one.
inline constexpr float narrow_alpha = 0.999f * scene::narrow_roughness * scene::narrow_roughness;

/// How a diffuse part differs from Lambert's, by directions; with F(x) = (1 - x)^5 of the cosines of light and eye,
///     (flat (1 + a F(n.l)) (1 + a F(n.v)) + rough t),   a = retro (1 + l.v) - loss,
/// where t = l.v - n.l n.v, over the larger of n.l and n.v where it is positive. [Burley2012, 5.3; Fujii2012]
struct DiffuseShape {
    float retro = 0, loss = 0;  ///< Disney's: roughness and 1/2
    float flat = 1, rough = 0;  ///< [Oren1994], as Fujii has it

    bool is_lambert() const { return retro == 0 && loss == 0 && flat == 1 && rough == 0; }
    /// At cosines n.l > 0, n.v > 0 and l.v.
    float value(float nl, float nv, float lv) const;
    /// Its mean over even light, by n.v.
    float albedo(float nv) const;

    static DiffuseShape disney(float roughness) { return {roughness, 0.5f, 1, 0}; }
    static DiffuseShape oren_nayar(float roughness);
};

/// How a point scatters light: a diffuse part below one GGX lobe, plus what only a traced ray can follow. Reflectances
/// are per channel. With s Schlick's fifth power of the angle between light and half vector,
///     f_s = diffuse / pi x shape x (1 - covered s where there is a lobe) + D V (f0 (1 - s) + f90 s).
/// glTF 2.0's mixing has a Lambert part that is covered whole [glTF2, appendix B].
struct Bsdf {
    glm::vec3 diffuse{0};               ///< reflectance, 0..1; the lobe's s takes its part, all other losses are in it
    glm::vec3 f0{0};                    ///< reflectance of the GGX lobe at normal incidence; 0: no lobe
    float alpha = 1;                    ///< GGX width, roughness squared, >= mirror_roughness squared
    glm::vec3 mirror{0};                ///< share of light from the mirrored direction (smooth surfaces); 0: none
    glm::vec3 transmission{0};          ///< share that passes (glass), tinted
    float ior = 1.5f;                   ///< inside over outside, for glass; of bodies: beyond over before
    glm::vec3 diffuse_transmission{0};  ///< Lambert's to the other side (leaves), 0..1; all losses are in it
    glm::vec3 along{0};  ///< unit, in the surface: where the lobe is wider; 0: it is round [KHR_materials_anisotropy]
    float alpha_along = 1;  ///< GGX width along it, >= `alpha`, which is that across it
    glm::vec3 f90{1};       ///< reflectance of the GGX lobe at grazing incidence; as f0 above 1 on rough metals
    float covered = 1;      ///< how much of s the lobe takes from the diffuse part, 0..1
    DiffuseShape shape{};

    /// Multiplies all that leaves the surface.
    void scale(glm::vec3 by) {
        diffuse *= by;
        f0 *= by;
        f90 *= by;
        mirror *= by;
        transmission *= by;
        diffuse_transmission *= by;
    }
    void scale(float by) { scale(glm::vec3(by)); }
    bool has_lobe() const { return f0.x > 0 || f0.y > 0 || f0.z > 0; }
    /// Whether what is reflected depends on directions: a lobe, or a diffuse part that is not Lambert's.
    bool has_glossy() const { return has_lobe() || !shape.is_lambert(); }
    bool is_stretched() const { return along != glm::vec3(0); }
    /// Width of the round lobe that covers as much.
    float mean_alpha() const { return is_stretched() ? std::sqrt(alpha * alpha_along) : alpha; }
    /// Whether rays look along the lobe (final_gather.h).
    bool has_narrow_lobe() const { return has_lobe() && alpha < narrow_alpha; }
    /// Whether it mirrors, sharply or in a narrow lobe: black where that points below the triangle.
    bool shows_things() const { return has_narrow_lobe() || mirror.x > 0 || mirror.y > 0 || mirror.z > 0; }
    bool has_diffuse_transmission() const {
        return diffuse_transmission.x > 0 || diffuse_transmission.y > 0 || diffuse_transmission.z > 0;
    }
    bool has_diffuse() const { return diffuse.x > 0 || diffuse.y > 0 || diffuse.z > 0; }
};

/// f_s of the diffuse and the glossy part, per steradian, without the cosine; 0 where `to_light` or `outgoing` lies
/// behind the normal. All directions unit.
glm::vec3 evaluate(const Bsdf& bsdf, glm::vec3 normal, glm::vec3 outgoing, glm::vec3 to_light);

/// Reflectance of the diffuse part for a pair of unit directions over the normal.
glm::vec3 diffuse_weight(const Bsdf& bsdf, glm::vec3 normal, glm::vec3 outgoing, glm::vec3 to_light);

/// Share of `diffuse` that leaves under even light, seen from a direction with this cosine to the normal.
float diffuse_share(const Bsdf& bsdf, float cosine);

/// Reflectance of the two parts under even light, seen from a direction with this cosine to the normal.
glm::vec3 diffuse_albedo(const Bsdf& bsdf, float cosine);
glm::vec3 glossy_albedo(const Bsdf& bsdf, float cosine);

/// A direction that the GGX lobe may scatter to, chosen by its distribution of half vectors, and what it reflects over
/// the density of choosing it; 0 where the direction falls below the surface. [Walter2007, eqs. 35, 38, 41]
struct LobeSample {
    glm::vec3 direction{0};
    glm::vec3 weight{0};
};
LobeSample sample_glossy(const Bsdf& bsdf, glm::vec3 normal, glm::vec3 outgoing, glm::vec2 u);

/// A half vector in proportion to what is seen of facets of width `alpha` from `outgoing` (unit); z is along the
/// normal. [Heitz2018, listing 1]
glm::vec3 visible_normal(glm::vec3 outgoing, float alpha, glm::vec2 u);
/// The same of a lobe of width `alpha.x` along x and `alpha.y` along y.
glm::vec3 visible_normal(glm::vec3 outgoing, glm::vec2 alpha, glm::vec2 u);

/// A stretched lobe in its own axes: x along, y across, z the normal. Directions are unit and given in them.
struct StretchedLobe {
    glm::vec3 x, y, z;
    glm::vec2 alpha;

    StretchedLobe(const Bsdf& bsdf, glm::vec3 normal);
    glm::vec3 local(glm::vec3 v) const { return {glm::dot(x, v), glm::dot(y, v), glm::dot(z, v)}; }
    glm::vec3 world(glm::vec3 v) const { return v.x * x + v.y * y + v.z * z; }
    float distribution(glm::vec3 half) const;              ///< [Burley2012, eq. 13]
    float masking(glm::vec3 light, glm::vec3 view) const;  ///< height-correlated, over 4 nl nv; z > 0 of both
    /// Density of directions whose half vectors are visible normals, per steradian [Heitz2018, eq. 17].
    float density(glm::vec3 half, glm::vec3 view) const;

  private:
    float length(glm::vec3 v) const;
};

}  // namespace render2mpeg::renderer
