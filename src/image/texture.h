#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "core/wrap.h"
#include "image/image.h"

namespace render2mpeg::image {

/// The area of texture that a pixel sees, as the two edges of a parallelogram in texture coordinates. Zero: a point.
struct Footprint {
    glm::vec2 dx{0, 0};
    glm::vec2 dy{0, 0};
};

enum class Encoding { linear, srgb };

/// An image with its mip pyramid, filtered anisotropically. Values come linear. Any finite or non-finite coordinate gives a finite
/// value.
class Texture {
 public:
    Texture() = default;
    Texture(const Image& image, Encoding encoding, core::Wrap wrap_u, core::Wrap wrap_v, bool nearest = false);

    /// Mean over the footprint about uv; uv (0, 0) is the upper left corner of the image.
    glm::vec4 sample(glm::vec2 uv, const Footprint& footprint) const;

    /// Mean of the whole texture.
    glm::vec4 mean() const;
    int width() const;
    int height() const;

 private:
    struct Level;
    std::vector<Level> levels_;
    core::Wrap wrap_u_ = core::Wrap::repeat, wrap_v_ = core::Wrap::repeat;
    bool nearest_ = false;
};

}  // namespace render2mpeg::image
