#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "core/wrap.h"
#include "image/image.h"

namespace render2mpeg::reference {

/// An image in linear values, looked up at points: bilinear or nearest, without any filter.
class Texels {
  public:
    /// `srgb`: code values are sRGB's [sRGB], except for images that hold floats.
    Texels(const image::Image& image, bool srgb);

    /// `uv` (0, 0) is the upper left corner of the image. `covers`: colours count by their alpha.
    glm::dvec4 at(glm::dvec2 uv, core::Wrap wrap_u, core::Wrap wrap_v, bool nearest, bool covers) const;

    int width() const { return width_; }
    int height() const { return height_; }
    glm::dvec4 texel(int x, int y) const;

  private:
    int width_, height_;
    std::vector<glm::dvec4> values_;
};

}  // namespace render2mpeg::reference
