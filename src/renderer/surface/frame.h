#pragma once
// The eye's view of one instant: surfaces, their shares of pixels, and light that needs no gathering.
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "core/mattes.h"
#include "core/visible.h"
#include "renderer/surface/gather_point.h"

namespace render2mpeg::renderer {

/// Light of the air on a straight segment from the eye: `weight` times radiance that air scatters to the eye up to it.
struct AirSpan {
    std::uint16_t pixel = 0;  ///< as GatherPoint's
    float distance = 0;       ///< from where the eye's ray begins; infinite: to the sky
    glm::vec3 weight{0};      ///< may be below 0: the segment begins there
};

/// The same of a path that mirrors or glass have turned.
struct AirPath {
    std::uint16_t pixel = 0;
    std::uint8_t path = direct_path;  ///< GatherPoint::path
    glm::vec3 origin{0}, direction{0};
    float distance = 0;
    glm::vec3 weight{0};
};

/// Which air the pixels of a tile show, by pixel in raster order.
struct SeenAir {
    std::vector<AirSpan> straight;
    std::vector<AirPath> beyond;
};

/// Matte of a pixel of a tile, by pixel in raster order (mattes.h).
struct SeenMatte {
    std::uint16_t pixel = 0;  ///< as GatherPoint's
    core::Matte matte;
};

/// How samples of pixels differ that each show another strand.
struct Strands {
    core::Plane<float> light;      ///< of theirs, luminance of the pixel; empty: there are none
    core::Plane<float> of_sample;  ///< its standard error by one sample
    double rays = 1;               ///< that light a sample, about
};

/// How often pixels are sampled that shutter or lens blur, 1 to 4096 times: `fewest` where they blur little, up to
/// `most` where much.
struct ExposureSamples {
    int fewest = 1, most = 1;
    /// How a grey luminance is shown, in code values; empty: nobody knows, and no pixel is sampled again.
    std::function<float(float)> shown = {};
    /// Standard error, in code values, beyond which pixels as bright as white are sampled again.
    float visible = 0;
};

/// Contribution of one gather point to one exposed pixel.
struct Contribution {
    std::uint32_t point = 0;  ///< of all points of the frame: Exposure::first_point of its tile and its place there
    glm::vec3 weight{0};      ///< share of the pixel x transmittance of mirrors, glass and layers, summed over samples
    glm::vec3 diffuse{0};     ///< the same times each sample's own diffuse reflectance: textures are the samples' own
};

/// How points give light to the pixels that the shutter or the lens blurs (docs/model/exposure.md). Light is gathered
/// once for a surface point, in the middle of the shutter's time; where it goes is sampled.
struct Exposure {
    core::Plane<std::uint8_t> exposed;  ///< 1: the pixel is the sum of its contributions and `emitted`
    std::vector<std::vector<Contribution>> contributions;  ///< by tile, by pixel in raster order
    std::vector<std::vector<std::uint32_t>> starts;  ///< by tile: where each of its pixels' begin, and the end; or none
    core::Plane<float>
        coverage;  ///< share of a pixel's samples that show the object that its middle shows; 1 elsewhere
    core::Plane<glm::vec3> emitted, emitted_specular;  ///< as Frame's, of exposed pixels
    std::vector<std::uint32_t> first_point;            ///< by tile: points of all tiles before it; one more: of all
    std::vector<float> given;                          ///< by point: luminance of its weights in all exposed pixels
    std::vector<SeenAir> air{};                        ///< as Frame's, of exposed pixels
    std::vector<std::vector<SeenMatte>> mattes{};      ///< likewise
    std::vector<FibreTile> fibres{};                   ///< likewise

    bool is_exposed(std::size_t tile) const { return !starts[tile].empty(); }
    /// Of a pixel of a tile that has any: GatherPoint::pixel.
    std::span<const Contribution> of_pixel(std::size_t tile, int pixel) const {
        const std::vector<std::uint32_t>& s = starts[tile];
        const auto p = static_cast<std::size_t>(pixel);
        return std::span(contributions[tile]).subspan(s[p], s[p + 1] - s[p]);
    }
};

/// The eye's view of one instant, without light. `look` makes it, and it never changes: finer edges and exposure are
/// another frame.
struct Frame {
    core::Visible visible;
    std::vector<GatherTile> tiles;            ///< row by row, (width + 15) / 16 per row
    core::Plane<glm::vec3> emitted;           ///< radiance of emission, sky and unlit surfaces
    core::Plane<glm::vec3> emitted_specular;  ///< the part of `emitted` seen by mirrors or glass; empty without them
    core::Plane<core::SurfaceAddress>
        imaged{};  ///< surfaces shown by flat mirrors; no surface: none, or no mirror; may be empty
    core::Plane<std::uint16_t> samples{};  ///< eye samples of each pixel; empty where all have SeeSettings::samples
    std::vector<SeenAir> air{};            ///< by tile; empty: it is clear
    std::vector<std::vector<SeenMatte>> mattes{};  ///< by tile; empty: nobody wants them
    std::vector<FibreTile> fibres{};               ///< by tile; empty: the plan knows of none
    std::shared_ptr<const Exposure> exposure{};    ///< null: no pixel is blurred
    int tiles_across() const { return (visible.width() + tile_size - 1) / tile_size; }
    /// A tile's upper left pixel, and a pixel of it (GatherPoint::pixel), in the picture.
    glm::ivec2 corner_of(std::size_t tile) const {
        const auto across = static_cast<std::size_t>(tiles_across());
        return tile_size * glm::ivec2(static_cast<int>(tile % across), static_cast<int>(tile / across));
    }
    glm::ivec2 place_of(std::size_t tile, int pixel) const {
        return corner_of(tile) + glm::ivec2(pixel % tile_size, pixel / tile_size);
    }
};

}  // namespace render2mpeg::renderer
