#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "renderer/geometry/surface_shape.h"
#include "renderer/surface/dielectric.h"
#include "renderer/surface/material_textures.h"
#include "renderer/surface/surface_point.h"

namespace render2mpeg::renderer {

/// The materials of an animation as surfaces show them (docs/model/materials.md).
class SurfaceMaterials {
  public:
    SurfaceMaterials(const scene::Animation& animation, const Plan& plan, TextureStore& store);

    /// Fills in normals, bsdf, emission, alpha and unlit of a point whose geometry (`shape`, `outgoing`, `back_side`,
    /// geometric normal) is known. `index`: where a body of glass is entered or left, what lies beyond over what lies
    /// before; 0: glass is thin.
    void fill(SurfacePoint& point, const SurfaceShape& shape, const ObjectInstant& object, float index = 0,
              Holes holes = Holes::filled) const;

    /// Light of the front, textured, without the animated factor; 0 for unlit materials. To a direction with this
    /// cosine to the normal; without one the mean of all.
    glm::vec3 emission_at(std::uint32_t material, const SurfaceShape& shape, std::optional<float> cosine) const;

    /// Share of light that goes straight through at a point, for shadow rays that meet it with this cosine to the
    /// normal, > 0: holes, and glass. `pane`: medium of the pane, so thick, of which this is a face; null: of none.
    glm::vec3 transmittance_at(std::uint32_t material, const SurfaceShape& shape, const scene::Snapshot& snapshot,
                               float cosine, const Medium* pane, float thickness) const;

    /// Whether surfaces of a material may let light through somewhere.
    bool is_translucent(std::uint32_t material) const;

    /// Whether textures alone say where surfaces of a material are holes, at all instants and from all sides, but for
    /// colours of vertices.
    bool is_cut_out(std::uint32_t material) const;
    const MaterialTextures& textures() const { return textures_; }

  private:
    glm::vec4 look_up(std::uint32_t material, TextureRole role, const SurfaceShape& shape) const;
    glm::vec3 seen(std::uint32_t material, scene::AngledInput input, glm::vec3 value, const SurfaceShape& shape,
                   std::optional<float> cosine) const;
    float seen(std::uint32_t material, scene::AngledInput input, float value, float cosine) const;
    glm::vec4 base_color_at(std::uint32_t material, const SurfaceShape& shape, const scene::Snapshot& snapshot,
                            float cosine) const;
    float coverage(std::uint32_t material, const SurfaceShape& shape, float base_alpha) const;
    float transmission_at(std::uint32_t material, const SurfaceShape& shape, float cosine) const;
    float metallic_at(std::uint32_t material, glm::vec4 texel, float cosine) const;
    void bend_normal(SurfacePoint& point, const SurfaceShape& shape, const ObjectInstant& object,
                     float& variance) const;
    /// Reflectance of a dielectric interface at normal and at grazing incidence [KHR_materials_specular].
    struct Dielectric {
        glm::vec3 f0{0};
        float f90 = 1;
    };
    Dielectric dielectric_at(std::uint32_t material, const SurfaceShape& shape) const;
    glm::vec3 film_over(std::uint32_t material, const SurfaceShape& shape, float cos_outgoing, glm::vec3 f0) const;
    /// How much of the Lambert part leaves on the other side, and its colour there.
    struct Leaf {
        float share = 0;
        glm::vec3 color{0};
    };
    Leaf leaf_at(std::uint32_t material, const SurfaceShape& shape) const;
    /// Detail of a material at a point's place in its surface.
    struct Detail {
        Leaf leaf;
        float normal_variance = 0;  ///< of the normal map's slopes within the footprint
        float anisotropy = 0;       ///< 0..1
        glm::vec3 along{0};         ///< see Bsdf
    };
    void reflect(SurfacePoint& point, const SurfaceShape& shape, const ObjectInstant& object, float index, Holes holes,
                 Detail detail) const;
    void brush(const SurfacePoint& point, const SurfaceShape& shape, const ObjectInstant& object, Detail& detail) const;
    void add_sheen(std::uint32_t material, const SurfaceShape& shape, float cos_outgoing, Bsdf& bsdf) const;
    static void stretch(const Detail& detail, Bsdf& bsdf);
    void reflect_as_blender(std::uint32_t material, const SurfaceShape& shape, glm::vec3 base_color, float roughness,
                            float cosine, Bsdf& bsdf) const;
    void add_coat(std::uint32_t material, const SurfaceShape& shape, float cos_outgoing, Bsdf& bsdf) const;
    Bsdf bsdf_at(std::uint32_t material, const SurfaceShape& shape, glm::vec3 base_color, float cos_outgoing,
                 const Detail& detail, float index) const;

    const scene::Animation& animation_;
    bool alpha_, mirrors_, glass_, glossy_, hair_, subsurface_;  ///< whether these passes run
    MaterialTextures textures_;
};

}  // namespace render2mpeg::renderer
