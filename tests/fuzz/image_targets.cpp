#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/error.h"
#include "core/numeric.h"
#include "encoder/av/y4m_reader.h"
#include "fuzz/input.h"
#include "fuzz/targets.h"
#include "image/image.h"
#include "image/motion_file.h"
#include "image/sky_map.h"
#include "image/texture.h"

namespace render2mpeg::fuzz {
namespace {

/// Whether an image is of a size that shows something: larger ones only take time, and what refuses them by their
/// header was asked by then. chosen: 2^18 pixels.
bool is_small(Input input, const char* name) {
    const image::ImageHeader header = image::read_image_header({}, std::as_bytes(input), name);
    return static_cast<std::size_t>(header.width) * static_cast<std::size_t>(header.height) <= 1u << 18;
}

bool is_finite(const glm::vec4& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z) && std::isfinite(v.w);
}

}  // namespace

bool image(Input input) {
    try {
        // By this name, what has no mark of its own is a TGA file.
        if (!is_small(input, "image.tga")) return false;
        const image::Image read = image::read_image({}, std::as_bytes(input), "image.tga");
        if (read.pixels.size() == 0) throw std::logic_error("an image without pixels");
        const image::Texture texture(read, image::Encoding::srgb, core::Wrap::repeat, core::Wrap::mirrored_repeat);
        for (const glm::vec2 uv : {glm::vec2(0), glm::vec2(0.7f, -3.3f), glm::vec2(1e30f)})
            if (!is_finite(texture.sample(uv, {{0.1f, 0}, {0, 0.3f}})))
                throw std::logic_error("a texture is not finite");
        return true;
    } catch (const core::Error&) {
        return false;
    }
}

bool sky(Input input) {
    try {
        if (!is_small(input, "sky.tga")) return false;
        const image::Image read = image::read_image({}, std::as_bytes(input), "sky.tga");
        const image::SkyMap map(read, glm::vec3(1), 0.3f);
        for (const glm::vec3 direction : {glm::vec3(0, 1, 0), glm::vec3(0, -1, 0), glm::vec3(1, 0, 0)})
            if (!core::is_finite(map.radiance(direction, 0.01f))) throw std::logic_error("a sky is not finite");
        return true;
    } catch (const core::Error&) {
        return false;
    }
}

bool layers(Input input) {
    bool taken = false;
    try {
        if (!is_small(input, "layers.exr")) return false;
    } catch (const core::Error&) {
        // Another reader may take it all the same.
    }
    const std::filesystem::path file = input_file().write("layers.exr", input);
    for (const image::MotionConvention convention : {image::MotionConvention::blender, image::MotionConvention::nuke}) {
        try {
            const image::FrameMotion motion = image::read_motion(file, 3, 4, 2, convention);
            for (std::size_t i = 0; i < motion.to_next.vector.size(); ++i)
                if (motion.to_next.kind.values()[i] != core::PixelClass::none &&
                    !core::is_finite(motion.to_next.vector.values()[i]))
                    throw std::logic_error("motion to nowhere");
            taken = true;
        } catch (const core::Error&) {
            // Refused by this convention.
        }
    }
    return taken;
}

bool y4m(Input input) {
    try {
        av::Y4mReader reader(input_file().write("film.y4m", input));
        for (std::int64_t n = 0; n < std::min<std::int64_t>(reader.frames(), 4); ++n) {
            const core::Picture picture = reader.read(n);
            if (picture.width() != reader.format().width || picture.height() != reader.format().height)
                throw std::logic_error("a picture of another size than the film's");
        }
        return true;
    } catch (const core::Error&) {
        return false;
    }
}

}  // namespace render2mpeg::fuzz
