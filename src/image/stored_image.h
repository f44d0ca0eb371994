#pragma once
// An image in the numbers that its file holds.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <string>

#include "image/image.h"

namespace render2mpeg::image {

/// RGBA as code values.
struct Codes {
    std::uint8_t rgba[4];
};

/// A decoded image as its file holds it, row by row from the upper left: code values where 8 bits hold all of it, else
/// floats. Meanings are those of Image.
struct StoredImage {
    StoredImage() = default;
    /// The pixels of an Image, which must outlive it.
    StoredImage(const Image& image);  // NOLINT(google-explicit-constructor): what takes one takes the other

    int width = 0, height = 0;
    bool has_alpha = false, high_range = false;
    float pixel_aspect = 1;
    std::span<const Codes> codes = {};        ///< or empty
    std::span<const glm::vec4> values = {};   ///< or empty
    std::shared_ptr<const void> memory = {};  ///< of these, where they are no caller's

    std::size_t pixels() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
    /// As Image has it.
    glm::vec4 at(int x, int y) const {
        const std::size_t i =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
        return codes.empty() ? values[i] : value_of(codes[i]);
    }
    static glm::vec4 value_of(const Codes& c) {
        constexpr float unit = 1.0f / 255.0f;
        return {unit * static_cast<float>(c.rgba[0]), unit * static_cast<float>(c.rgba[1]),
                unit * static_cast<float>(c.rgba[2]), unit * static_cast<float>(c.rgba[3])};
    }
};

/// How many values of the image's colours are infinite or NaN.
std::size_t count_non_finite(const StoredImage& image);

/// read_image() without floats for what has none.
StoredImage read_stored_image(const std::filesystem::path& path, std::span<const std::byte> bytes,
                              const std::string& name);

/// Opens what read_stored_image() needs for such a file, which may take half a second and much address space: before
/// limits begin. Throws core::Error where a module is missing.
void open_decoder(const std::filesystem::path& path, std::span<const std::byte> bytes, const std::string& name);

}  // namespace render2mpeg::image
