#pragma once
// Textures and sky of one animation, made once for all its renderers.
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "core/wrap.h"
#include "image/sky_map.h"
#include "image/stored_image.h"
#include "image/texture.h"
#include "scene/model/animation.h"

namespace render2mpeg::renderer {

/// Everything that makes one texture of an image different from another.
struct TextureKey {
    int image;
    image::Encoding encoding;
    core::Wrap wrap_u, wrap_v;
    bool nearest;
    image::AlphaMeaning alpha;

    auto order() const { return std::tuple(image, encoding, wrap_u, wrap_v, nearest, alpha); }
    bool operator<(const TextureKey& other) const { return order() < other.order(); }
};

/// Textures and sky of one animation, made once for all its renderers: a film's exposure is measured before its frames
/// are lit. Thread-safe.
class TextureStore {
  public:
    /// Hands out the animation's image of a number. Throws core::Error.
    using Read = std::function<image::StoredImage(int image)>;

    /// Images are read in this process.
    explicit TextureStore(const scene::Animation& animation);
    TextureStore(const scene::Animation& animation, Read read) : animation_(animation), read_(std::move(read)) {}

    /// Of keys in their order. An image that is used in several ways is read once. What is missing is made in parallel.
    /// Throws core::Error for images that cannot be read.
    std::vector<std::shared_ptr<const image::Texture>> textures(std::span<const TextureKey> keys);

    /// The animation's sky. Throws likewise.
    std::shared_ptr<const image::SkyMap> sky();

    /// A line for each image so far with values that are no numbers or infinite, and what they count as.
    std::vector<std::string> notes() const;

  private:
    image::StoredImage read(int image);

    const scene::Animation& animation_;
    Read read_;
    mutable std::mutex mutex_;
    std::map<TextureKey, std::shared_ptr<const image::Texture>> made_;
    std::shared_ptr<const image::SkyMap> sky_;
    std::map<int, std::string> notes_;  ///< by image
};

}  // namespace render2mpeg::renderer
