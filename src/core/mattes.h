#pragma once
// The border type of mattes: materials and objects that cover each pixel.
#include <cstdint>
#include <span>
#include <vector>

#include "core/plane.h"
#include "core/surface_address.h"

namespace render2mpeg::core {

/// Share of a pixel that one material of one object covers as the camera sees it: straight, mirrors and glass as
/// themselves. no_id: a hole (holdouts, and the world where it is transparent).
struct Matte {
    std::uint32_t object = no_id;    ///< index into Animation::objects
    std::uint32_t material = no_id;  ///< index into Animation::materials
    float share = 0;                 ///< 0..1
};

/// All of a frame, by pixel in raster order. Shares of a pixel sum to 1, or less where there is fog or a world.
struct Mattes {
    int width = 0, height = 0;
    std::vector<std::size_t> starts;  ///< where each pixel's begin, and the end
    std::vector<Matte> parts;

    bool empty() const { return starts.empty(); }
    std::span<const Matte> of_pixel(std::size_t pixel) const {
        return std::span(parts).subspan(starts[pixel], starts[pixel + 1] - starts[pixel]);
    }
    /// Coverage, 0..1.
    float alpha(std::size_t pixel) const {
        float open = 0;
        for (const Matte& part : of_pixel(pixel)) open += part.object == no_id ? part.share : 0.0f;
        return open < 1.0f ? 1.0f - open : 0.0f;
    }
};

}  // namespace render2mpeg::core
