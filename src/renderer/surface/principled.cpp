// [Burley2012] as Blender 3 has it: a lobe over a diffuse part that knows nothing of it. Blender 4 lays the same lobe
// over what its reflectance leaves, gives metals an edge tint [Kutz2021] and rough lobes their lost light
// [Turquin2019]. Changed: one lobe stands for all facets, whose reflectance under even light is exact and whose
// dependence on light is that of Schlick's term.
#include "renderer/surface/principled.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/numeric.h"
#include "renderer/base/lobe.h"
#include "renderer/surface/lobe_albedo.h"
#include "renderer/surface/lobe_moments.h"
#include "scene/preparation/traits.h"

namespace render2mpeg::renderer {
namespace {

using scene::SurfaceModel;

/// What a surface reflects of even light by its facets, per channel, and what it takes from the part below.
struct FacetReflection {
    glm::vec3 f0{0};       ///< by the reflectance of facets that face light
    glm::vec3 grazing{0};  ///< by what Fresnel's term adds to it
    float covers = 0;      ///< share taken from the part below, 0..1
};

float largest_channel(glm::vec3 v) {
    return std::max({v.x, v.y, v.z});
}

/// Facets seen from one direction.
class Facets {
  public:
    Facets(float cosine, float alpha, bool smooth, bool multiscatter, SurfaceModel model)
        : cosine_(std::clamp(cosine, 0.0f, 1.0f)),
          alpha_(alpha),
          smooth_(smooth),
          multiscatter_(multiscatter),
          follows_(model == SurfaceModel::principled_3) {
        // Blender 3 masks light and eye apart, but where it follows light from facet to facet.
        masking_ = model == SurfaceModel::principled_3 && !multiscatter ? Masking::separable : Masking::correlated;
        schlick_ = smooth ? lobe::schlick(cosine_) : lobe_albedo(cosine_, alpha).f90;
    }

    /// (F - F0) / (1 - F0) goes on from `f0` to 1.
    FacetReflection dielectric(glm::vec3 f0, float root_f0) const {
        const LobeMoments m = moments(root_f0);
        const float mean = mean_fresnel(root_f0);
        const glm::vec3 regain = regained(f0 + (1.0f - f0) * mean);
        FacetReflection out{regain * f0 * (m.whole - m.fresnel), regain * m.fresnel};
        // What is lost among facets without multiple scattering is lost to the part below as well.
        const float seen = multiscatter_ ? 1.0f : core::divide_or(1.0f, m.whole, 1.0f);
        out.covers = std::clamp(seen * largest_channel(out.f0 + out.grazing), 0.0f, 1.0f);
        return out;
    }

    /// Schlick's term less what `tint` takes at 82 degrees. [Kutz2021]
    FacetReflection metal(glm::vec3 f0, glm::vec3 tint) const {
        constexpr float c = 1.0f / 7, there = (1 - c) * (1 - c) * (1 - c) * (1 - c) * (1 - c);
        const glm::vec3 dip = (f0 + (1.0f - f0) * there) * (1.0f - tint) / (c * there * (1 - c));
        const LobeMoments m = moments(0.0f);
        const glm::vec3 regain = regained(glm::clamp(f0 + (1.0f - f0) / 21.0f - dip / 126.0f, 0.0f, 1.0f));
        const glm::vec3 facing = f0 * (m.whole - schlick_);
        const glm::vec3 all = glm::max(facing + schlick_ - dip * m.edge, 0.0f);
        const glm::vec3 kept = regain * all / glm::max(facing + schlick_, 1e-6f);
        return {kept * facing, kept * schlick_, 1.0f};
    }

    /// The same from all directions.
    FacetReflection even(glm::vec3 color) const {
        const LobeMoments m = moments(0.0f);
        const glm::vec3 all = regained(color) * color;
        return {all * (m.whole - schlick_), all * schlick_, 1.0f};
    }

  private:
    LobeMoments moments(float root_f0) const {
        if (!smooth_) return lobe_moments(cosine_, alpha_, root_f0, masking_);
        return {1.0f, relative_fresnel(cosine_, root_f0), cosine_ * std::pow(1.0f - cosine_, 6.0f)};
    }
    /// What comes after more reflections, of facets that reflect so much in the mean, over what comes after one.
    /// Blender 3 follows light among them, and nearly all of it leaves after the second.
    glm::vec3 regained(glm::vec3 mean) const {
        if (!multiscatter_ || smooth_) return glm::vec3(1);
        const float whole = moments(0.0f).whole, average = mean_whole(alpha_);
        const glm::vec3 more = follows_ ? mean : mean * average / (1.0f - mean * (1.0f - average));
        return 1.0f + more * (core::divide_or(1.0f, whole, 1.0f) - 1.0f);
    }

    float cosine_, alpha_;
    bool smooth_, multiscatter_, follows_;
    Masking masking_;
    float schlick_ = 0;  ///< Schlick's part of a lobe that reflects all
};

FacetReflection sum(const FacetReflection& a, glm::vec3 share_a, const FacetReflection& b, glm::vec3 share_b) {
    return {share_a * a.f0 + share_b * b.f0, share_a * a.grazing + share_b * b.grazing, 0.0f};
}

/// Makes a lobe of the width of `bsdf` reflect as much of even light, seen at this cosine.
void set_lobe(Bsdf& bsdf, const FacetReflection& of, float cosine) {
    // Where facets are nowhere grazing, grazing reflectance is any.
    constexpr float least = 0.004f;
    const LobeAlbedo lobe = lobe_albedo(cosine, bsdf.mean_alpha());
    bsdf.covered = 0.0f;
    bsdf.f90 = lobe.f90 > least ? of.grazing / lobe.f90 : glm::vec3(largest_channel(of.f0) > 0.0f ? 1.0f : 0.0f);
    bsdf.f0 = glm::max(of.f0 + of.grazing - bsdf.f90 * lobe.f90, 0.0f) / std::max(lobe.f0, least);
}

}  // namespace

void reflect_as_principled(const PrincipledInputs& in, Bsdf& bsdf) {
    const Facets facets(in.cosine, bsdf.mean_alpha(), in.smooth, in.multiscatter, in.model);
    const auto root_of = [](float f0) { return std::sqrt(std::clamp(f0, 0.0f, 0.25f)); };
    const float glass = (1.0f - in.metallic) * in.transmission;
    const FacetReflection clear = glass > 0.0f
                                      ? facets.dielectric(glm::min(in.glass_f0 * in.tint, 1.0f), root_of(in.glass_f0))
                                      : FacetReflection{};
    FacetReflection all;
    float below = 1.0f;
    if (in.model == SurfaceModel::principled_3) {
        const glm::vec3 f0 = glm::mix(glm::min(in.specular_f0 * in.tint, 1.0f), in.base, in.metallic);
        all = sum(facets.dielectric(f0, root_of(in.specular_f0)), glm::vec3(1.0f - glass), clear, glm::vec3(glass));
        bsdf.shape = DiffuseShape::disney(in.roughness);
    } else {
        const FacetReflection specular =
            facets.dielectric(glm::min(in.specular_f0 * in.tint, 1.0f), root_of(in.specular_f0));
        const float opaque = (1.0f - in.metallic) * (1.0f - in.transmission);
        below = 1.0f - specular.covers;
        all = sum(specular, glm::vec3(opaque), clear, glm::vec3(glass));
        if (in.metallic > 0.0f)
            all = sum(all, glm::vec3(1), facets.metal(in.base, glm::min(in.tint, 1.0f)), glm::vec3(in.metallic));
    }
    if (in.gloss != glm::vec3(0)) all = sum(all, glm::vec3(1), facets.even(in.gloss), glm::vec3(1));
    bsdf.diffuse *= below;
    bsdf.f0 = bsdf.f90 = glm::vec3(0);
    bsdf.covered = 0.0f;
    if (in.smooth)
        bsdf.mirror = all.f0 + all.grazing;
    else
        set_lobe(bsdf, all, in.cosine);
}

/// Mirrors or takes the lobe's place as glTF's.
void lay_coat(const scene::Material& m, const CoatInputs& in, Bsdf& bsdf) {
    const bool smooth = in.roughness < scene::mirror_roughness || largest_channel(bsdf.f0) > most_of_dielectrics;
    const float root = (m.coat_ior - 1.0f) / (m.coat_ior + 1.0f);
    FacetReflection film =
        Facets(in.cosine, in.roughness * in.roughness, smooth, false, m.model).dielectric(glm::vec3(root * root), root);
    if (m.model == SurfaceModel::principled_3) {
        // Disney's coat hides light as a lobe of 1/4 does, whatever its own width. [Burley2012, 5.6]
        const float masked = unhidden(in.cosine, 0.25f) / unhidden(in.cosine, in.roughness * in.roughness);
        film.f0 *= masked;
        film.grazing *= masked;
    } else {
        const float inside = core::sqrt_or_zero(1.0f - (1.0f - in.cosine * in.cosine) / (m.coat_ior * m.coat_ior));
        const glm::vec3 tint = glm::pow(m.coat_tint, glm::vec3(core::divide_or(1.0f, inside, 1.0f)));
        bsdf.scale((1.0f - in.share * film.covers) * glm::mix(glm::vec3(1), tint, in.share));
    }
    if (smooth) {
        if (in.mirrors) bsdf.mirror += in.share * (film.f0 + film.grazing);
        return;
    }
    if (!in.glossy) return;
    const glm::vec3 lobe = glossy_albedo(bsdf, in.cosine);
    bsdf.alpha = in.roughness * in.roughness;
    bsdf.along = glm::vec3(0);
    set_lobe(bsdf, {in.share * film.f0, in.share * film.grazing}, in.cosine);
    bsdf.diffuse += lobe / diffuse_share(bsdf, in.cosine);
}

void roughen(const scene::Material& m, glm::vec3 color, float cosine, Bsdf& bsdf) {
    bsdf.shape = DiffuseShape::oren_nayar(m.diffuse_roughness);
    if (m.model != scene::SurfaceModel::principled_4) return;
    constexpr float pi = std::numbers::pi_v<float>;
    const float seen = std::min(bsdf.shape.albedo(cosine), 1.0f);
    const float mean = bsdf.shape.flat + bsdf.shape.rough * (2.0f / 3 - 28.0f / (15 * pi));
    // Blender has the colour once more than [Portsmouth2025].
    const glm::vec3 more = color * color * (mean * (1.0f - seen)) / (1.0f - color * (1.0f - mean));
    bsdf.diffuse *= 1.0f + more / std::max(seen, 0.1f);
}

void keep_energy(Bsdf& bsdf, float cosine) {
    const float even = diffuse_share(bsdf, cosine);
    const glm::vec3 rest = 1.0f - glossy_albedo(bsdf, cosine) - bsdf.mirror - bsdf.transmission;
    bsdf.diffuse = glm::min(bsdf.diffuse, glm::max(rest, 0.0f) / std::max(even, 1e-6f));
}

}  // namespace render2mpeg::renderer
