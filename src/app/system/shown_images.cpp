#include "app/system/shown_images.h"

namespace render2mpeg::app {

std::set<int> images_of(const scene::Animation& film) {
    std::set<int> images;
    for (const scene::Object& object : film.objects) {
        const scene::Material& m = film.materials[static_cast<std::size_t>(object.material)];
        for (const auto use : scene::texture_uses)
            if ((m.*use).present()) images.insert((m.*use).image);
    }
    if (film.sky.image >= 0) images.insert(film.sky.image);
    return images;
}

}  // namespace render2mpeg::app
