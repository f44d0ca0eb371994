#pragma once
// Looks through the pixels of a tile, and again through some of them.
#include <array>
#include <cstddef>
#include <glm/glm.hpp>
#include <vector>

#include "renderer/surface/frame.h"
#include "renderer/view/eye_path.h"
#include "renderer/view/mattes.h"
#include "renderer/view/see.h"

namespace render2mpeg::renderer {

/// Inputs that all tiles share.
struct Looking {
    const RayTracer& tracer;
    const EyePaths& paths;
    const scene::Camera& camera;
    const std::vector<glm::vec2>& pattern;  ///< samples of each pixel
    float spacing;                          ///< of samples, pixels
    bool keeps_places = false;              ///< GatherPoint::more_places
};

/// Rays of neighbouring pixels that are traced together, and the first surface that each meets.
struct EyeRays {
    std::vector<EyeRay> rays;
    std::vector<RayQuery> queries;
    std::vector<Hit> hits;

    void clear();
    /// Adds sample `sample` of a pixel.
    void add(EyeRay ray, float far, glm::ivec2 pixel, int sample);
    void trace(const RayTracer& tracer);
};

/// Which pixels of a tile are meant, by row and column.
using PixelMarks = std::array<std::array<bool, tile_size>, tile_size>;

/// A tile's pixels in the picture, `end` not included.
struct TileArea {
    glm::ivec2 first, end;
};
TileArea area_of(const Frame& seen, std::size_t tile);

/// Fibre sample of a pixel from a fragment that shows a fibre.
FibreSample fibre_sample(const Fragment& fragment, std::uint16_t pixel, glm::vec3 weight);
/// Takes back those of the last pixel.
void forget_fibres(std::uint16_t pixel, FibreTile& fibres);

/// Whether a fragment lies on the surface that a point stands for. `pixel_extent`: of a pixel there, scene units.
bool same_surface(const GatherPoint& point, const Fragment& fragment, float pixel_extent);

/// Adds `share` of the air in a sample of the last pixel.
void add_air(const EyeSample& sample, std::uint16_t pixel, float share, SeenAir& air);

/// Removes the air of the last pixel.
void forget_air(std::uint16_t pixel, SeenAir& air);

/// Looks through all pixels of a tile; tells whose samples differ.
PixelMarks look_through(const Looking& looking, std::size_t tile, Frame& seen, SeeCounts& counts);

/// Looks again through those pixels of a tile that are marked; the others stay. What Visible records
/// stays.
void look_again(const Looking& looking, std::size_t tile, const PixelMarks& marks, Frame& seen, SeeCounts& counts);

}  // namespace render2mpeg::renderer
