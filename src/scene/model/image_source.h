#pragma once
// Where an encoded image is: a file, or bytes.
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "core/wrap.h"

namespace render2mpeg::scene {

/// An encoded image (PNG, JPEG, EXR, HDR, ...): a file, or embedded bytes.
struct ImageSource {
    std::string name;              ///< for messages
    std::filesystem::path path;    ///< empty where `bytes` holds it
    std::vector<std::byte> bytes;  ///< empty where `path` names it
};

/// Use of an image: texture coordinates, transform, wrapping.
struct TextureUse {
    int image = -1;  ///< index into Animation::images; -1: no texture, the factor alone counts
    int uv_set = 0;  ///< 0 or 1
    core::Wrap wrap_u = core::Wrap::repeat;
    core::Wrap wrap_v = core::Wrap::repeat;
    bool nearest = false;  ///< no interpolation when magnified
    /// uv' = (m00 u + m01 v + m02, m10 u + m11 v + m12) [KHR_texture_transform]; (0, 0) is the image's upper left.
    float transform[2][3] = {{1, 0, 0}, {0, 1, 0}};

    bool present() const { return image >= 0; }
};

}  // namespace render2mpeg::scene
