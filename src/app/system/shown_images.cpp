#include "app/system/shown_images.h"

namespace render2mpeg::app {

std::set<int> images_of(const scene::Animation& film) {
    std::set<int> images;
    for (const scene::Object& object : film.objects) {
        const scene::Material& m = film.materials[static_cast<std::size_t>(object.material)];
        for (const scene::TextureUse* use :
             {&m.base_color_texture, &m.metallic_roughness_texture, &m.specular_glossiness_texture, &m.normal_texture,
              &m.emission_texture, &m.alpha_texture, &m.transmission_texture})
            if (use->present()) images.insert(use->image);
    }
    if (film.sky.image >= 0) images.insert(film.sky.image);
    return images;
}

}  // namespace render2mpeg::app
