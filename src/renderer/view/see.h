#pragma once
// Primary visibility: what every pixel sees.
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "renderer/surface/frame.h"
#include "renderer/surface/posed_scene.h"

namespace render2mpeg::renderer {

/// Settings of `see`.
struct SeeSettings {
    scene::PictureFormat format;
    int samples = 4;           ///< eye samples per pixel, >= 1
    int edge_samples = 0;      ///< of pixels with edges; 0 or `samples`: no more
    int specular_depth = 6;    ///< mirrors after one another; 0: none
    bool mattes = false;       ///< mattes are looked for
    bool transparent = false;  ///< the eye sees no sky but in mirrors and through glass
    int spaced_as = 0;         ///< textures are seen as by so many samples; 0: as by `samples`
};

/// Rays that `see` shot, for the statistics.
struct SeeCounts {
    std::uint64_t primary_rays = 0;   ///< from the eye, and on through layers
    std::uint64_t specular_rays = 0;  ///< from mirrors
    double sky_seconds = 0;           ///< CPU, about: looking at the sky

    void add(const SeeCounts& more) {
        primary_rays += more.primary_rays;
        specular_rays += more.specular_rays;
        sky_seconds += more.sky_seconds;
    }
};

/// Primary visibility of the posed snapshot, with antialiasing (docs/model/visibility.md). Pixels whose samples show
/// different surfaces, or whose neighbours do, get `edge_samples` instead of `samples`. The weights of a pixel's
/// gather points and its `emitted` together stand for the whole pixel: light gathered at a point is multiplied by
/// its weight and added. A gather point always has something to gather (a diffuse or glossy part) and a weight > 0. The
/// result does not depend on the number of threads. Adds to `counts`.
Frame see(const PosedScene& posed_scene, const SeeSettings& settings, const Plan& plan, SeeCounts& counts);

/// Where the samples of a pixel lie, in pixels from its upper left corner: the same in every pixel and every frame, so
/// that what is still stays still. Sample 0 is the centre, and (for more than two) so is their mean.
std::vector<glm::vec2> sample_pattern(int samples);

}  // namespace render2mpeg::renderer
