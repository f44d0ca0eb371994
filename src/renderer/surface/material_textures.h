#pragma once
// A material's textures.
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "image/texture.h"
#include "renderer/base/plan.h"
#include "renderer/surface/texture_store.h"
#include "scene/model/animation.h"

namespace render2mpeg::renderer {

/// The roles that an image can have in a material.
enum class TextureRole {
    base_color,
    alpha,
    metallic_roughness,
    specular_glossiness,
    normal,
    emission,
    transmission,
    specular_weight,
    specular_tint,
    coat,
    coat_roughness,
    sheen,
    sheen_roughness,
    iridescence,
    film,
    anisotropy,
    diffuse_transmission,
    diffuse_transmission_color,
    other_base_color,
    other_emission,
    count
};

/// How a material uses an image in this role.
const scene::TextureUse& use_of(const scene::Material& material, TextureRole role);

/// The textures of all materials that some object has.
class MaterialTextures {
  public:
    /// Throws core::Error for images that cannot be read.
    MaterialTextures(const scene::Animation& animation, const Plan& plan, TextureStore& store);

    /// Nothing where the material has no image in this role, or nobody looks at it.
    const image::Texture* of(std::uint32_t material, TextureRole role) const {
        const int index = index_[material][static_cast<std::size_t>(role)];
        return index < 0 ? nullptr : textures_[static_cast<std::size_t>(index)].get();
    }

    std::size_t size() const { return textures_.size(); }

  private:
    std::vector<std::shared_ptr<const image::Texture>> textures_;
    std::vector<std::array<int, static_cast<std::size_t>(TextureRole::count)>> index_;  ///< by material; -1: none
};

}  // namespace render2mpeg::renderer
