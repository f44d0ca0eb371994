// Checks materials, images and sky.
#include <algorithm>
#include <cmath>

#include "core/numeric.h"
#include "scene/model/wording.h"
#include "scene/preparation/validate.h"

namespace render2mpeg::scene {
namespace {

/// One material under check; remembers whether a value had to be clamped.
class MaterialCheck {
  public:
    MaterialCheck(Animation& animation, std::size_t index)
        : animation_(animation),
          material_(animation.materials[index]),
          name_(described("material", index, material_.name)) {}

    void run() {
        for (int k = 0; k < 4; ++k) clamp(material_.base_color[k], 0, 1, "base colour");
        clamp(material_.metallic, 0, 1, "metallic");
        clamp(material_.roughness, 0, 1, "roughness");
        for (int k = 0; k < 3; ++k) clamp(material_.specular[k], 0, 1, "specular colour");
        clamp(material_.glossiness, 0, 1, "glossiness");
        clamp(material_.transmission, 0, 1, "transmission");
        clamp(material_.specular_weight, 0, 1, "specular factor");
        for (int k = 0; k < 3; ++k) clamp(material_.specular_tint[k], 0, largest, "specular colour");
        clamp(material_.coat, 0, 1, "clearcoat");
        clamp(material_.coat_roughness, 0, 1, "clearcoat roughness");
        for (int k = 0; k < 3; ++k) clamp(material_.sheen[k], 0, 1, "sheen colour");
        clamp(material_.sheen_roughness, 0, 1, "sheen roughness");
        clamp(material_.iridescence, 0, 1, "iridescence");
        clamp(material_.film_ior, 1, 100, "index of the thin film");
        // chosen: a tenth of a millimetre, where no wave is told from the next.
        clamp(material_.film_thinnest, 0, 1e5f, "thickness of the thin film");
        clamp(material_.film_thickest, 0, 1e5f, "thickness of the thin film");
        clamp(material_.anisotropy, 0, 1, "anisotropy");
        clamp(material_.anisotropy_rotation, -largest, largest, "anisotropy's rotation");
        clamp(material_.diffuse_transmission, 0, 1, "diffuse transmission");
        for (int k = 0; k < 3; ++k)
            clamp(material_.diffuse_transmission_color[k], 0, 1, "diffuse transmission's colour");
        // chosen: 100 is beyond every substance; glTF itself sets no limit.
        clamp(material_.ior, 1, 100, "index of refraction");
        for (int k = 0; k < 3; ++k) clamp(material_.attenuation_color[k], 0, 1, "attenuation colour");
        clamp(material_.attenuation_distance, 0, largest, "attenuation distance");
        // chosen: 20 / 1, far beyond every substance; rutile has 2.
        clamp(material_.dispersion, 0, 20, "dispersion");
        clamp(material_.alpha_cutoff, 0, largest, "alpha cutoff");
        clamp(material_.normal_scale, -largest, largest, "normal scale");
        for (int k = 0; k < 3; ++k) clamp(material_.emission[k], 0, largest, "emission");

        check(material_.base_color_texture, "base colour texture");
        check(material_.metallic_roughness_texture, "metallic-roughness texture");
        check(material_.specular_glossiness_texture, "specular-glossiness texture");
        check(material_.normal_texture, "normal texture");
        check(material_.emission_texture, "emission texture");
        check(material_.alpha_texture, "alpha texture");
        check(material_.transmission_texture, "transmission texture");
        check(material_.specular_weight_texture, "specular texture");
        check(material_.specular_tint_texture, "specular colour texture");
        check(material_.coat_texture, "clearcoat texture");
        check(material_.coat_roughness_texture, "clearcoat roughness texture");
        check(material_.sheen_texture, "sheen colour texture");
        check(material_.sheen_roughness_texture, "sheen roughness texture");
        check(material_.iridescence_texture, "iridescence texture");
        check(material_.film_texture, "thin film's texture");
        check(material_.anisotropy_texture, "anisotropy texture");
        check(material_.diffuse_transmission_texture, "diffuse transmission texture");
        check(material_.diffuse_transmission_color_texture, "diffuse transmission colour texture");
    }

  private:
    /// Beyond it sums of light points leave single precision. chosen: 1e30, far above any real radiance.
    static constexpr float largest = 1e30f;

    void clamp(float& value, float low, float high, const char* what) {
        if (!std::isfinite(value)) refuse(animation_, name_, std::string(what) + " is not finite");
        if (value >= low && value <= high) return;
        value = std::clamp(value, low, high);
        note_once(animation_, name_ + ": " + what + " is out of range; clamped");
    }

    void check(const TextureUse& use, const char* what) {
        if (use.image < -1)
            refuse(animation_, name_, std::string(what) + " refers to image " + std::to_string(use.image));
        if (use.image >= static_cast<int>(animation_.images.size()))
            refuse(animation_, name_,
                   std::string(what) + " refers to image " + std::to_string(use.image) + ", but there are " +
                       std::to_string(animation_.images.size()));
        if (use.uv_set < 0 || use.uv_set > 1)
            refuse(animation_, name_,
                   std::string(what) + " uses texture coordinates " + std::to_string(use.uv_set) +
                       "; there are sets 0 and 1");
        for (const auto& row : use.transform)
            for (const float v : row)
                if (!std::isfinite(v))
                    refuse(animation_, name_, std::string(what) + " has a transform that is not finite");
    }

    Animation& animation_;
    Material& material_;
    std::string name_;
};

}  // namespace

void validate_looks(Animation& animation) {
    for (std::size_t i = 0; i < animation.materials.size(); ++i) MaterialCheck(animation, i).run();
    for (std::size_t i = 0; i < animation.images.size(); ++i) {
        const ImageSource& image = animation.images[i];
        if (image.path.empty() && image.bytes.empty())
            refuse(animation, described("image", i, image.name), "has neither a file nor bytes");
    }
    Sky& sky = animation.sky;
    if (!core::is_finite(sky.color) || sky.color.x < 0 || sky.color.y < 0 || sky.color.z < 0)
        refuse(animation, "sky", "its colour must be finite and not negative");
    if (!std::isfinite(sky.rotation)) refuse(animation, "sky", "its rotation is not finite");
    if (sky.image < -1 || sky.image >= static_cast<int>(animation.images.size()))
        refuse(animation, "sky",
               "refers to image " + std::to_string(sky.image) + ", but there are " +
                   std::to_string(animation.images.size()));
}

}  // namespace render2mpeg::scene
