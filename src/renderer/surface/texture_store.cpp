#include "renderer/surface/texture_store.h"

#include <utility>

#include "parallel/loops.h"

namespace render2mpeg::renderer {
namespace {

/// Note on an image's values that are not finite; empty where all are.
std::string note_of(const image::StoredImage& image, const std::string& name) {
    if (!image.high_range) return {};
    const std::size_t count = image::count_non_finite(image);
    if (count == 0) return {};
    return name + ": " + std::to_string(count) + (count == 1 ? " value is" : " values are") +
           " not finite: NaN counts as 0, infinity as 65504";
}

}  // namespace

TextureStore::TextureStore(const scene::Animation& animation)
    : TextureStore(animation, [&animation](int image) {
          const scene::ImageSource& source = animation.images[static_cast<std::size_t>(image)];
          return image::read_stored_image(source.path, source.bytes, source.name);
      }) {}

image::StoredImage TextureStore::read(int image) {
    image::StoredImage read = read_(image);
    if (std::string note = note_of(read, animation_.images[static_cast<std::size_t>(image)].name); !note.empty()) {
        const std::lock_guard lock(mutex_);
        notes_[image] = std::move(note);
    }
    return read;
}

std::vector<std::shared_ptr<const image::Texture>> TextureStore::textures(std::span<const TextureKey> keys) {
    std::map<int, std::vector<TextureKey>> missing;
    {
        const std::lock_guard lock(mutex_);
        for (const TextureKey& key : keys)
            if (!made_.contains(key)) missing[key.image].push_back(key);
    }

    // Make all textures of an image together, so that few decoded images are in memory at a time.
    const std::vector<std::pair<int, std::vector<TextureKey>>> by_image(missing.begin(), missing.end());
    parallel::for_each(by_image.size(), [&](std::size_t i) {
        const image::StoredImage decoded = read(by_image[i].first);
        for (const TextureKey& key : by_image[i].second) {
            auto texture = std::make_shared<const image::Texture>(decoded, key.encoding, key.wrap_u, key.wrap_v,
                                                                  key.nearest, key.alpha);
            const std::lock_guard lock(mutex_);
            made_[key] = std::move(texture);
        }
    });
    std::vector<std::shared_ptr<const image::Texture>> found;
    const std::lock_guard lock(mutex_);
    for (const TextureKey& key : keys) found.push_back(made_.at(key));
    return found;
}

std::shared_ptr<const image::SkyMap> TextureStore::sky() {
    {
        const std::lock_guard lock(mutex_);
        if (sky_) return sky_;
    }
    const scene::Sky& sky = animation_.sky;
    const auto made = sky.image < 0 ? std::make_shared<const image::SkyMap>(sky.color)
                                    : std::make_shared<const image::SkyMap>(read(sky.image), sky.color, sky.rotation);
    const std::lock_guard lock(mutex_);
    return sky_ = made;
}

std::vector<std::string> TextureStore::notes() const {
    const std::lock_guard lock(mutex_);
    std::vector<std::string> lines;
    for (const auto& [image, note] : notes_) lines.push_back(note);
    return lines;
}

}  // namespace render2mpeg::renderer
