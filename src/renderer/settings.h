#pragma once
// Settings of the renderer.
#include <cstdint>

#include "core/isa.h"
#include "scene/model/animation.h"

namespace render2mpeg::renderer {

/// Whether near VPLs are clamped (docs/model/clamping.md).
enum class Clamp { bounded, none };

/// Where gathered light is kept for other pixels and frames (irradiance_cache.h).
enum class CacheUse {
    off,
    static_light,  ///< where light stays what it is all through a film, or rays gather it
    on             ///< everywhere; without rays a change of light forgets what was kept
};

/// How light that surfaces and skies send is gathered.
enum class Indirect {
    rays,      ///< by rays that ask a cache on surfaces (final_gather.h)
    lightcuts  ///< by cuts through trees of light points
};

struct Settings {
    Indirect indirect = Indirect::rays;
    scene::PictureFormat format;
    int samples = 4;       ///< eye samples per pixel, >= 1
    int edge_samples = 0;  ///< of pixels with edges; 0: as many
    int most_samples =
        0;  ///< of pixels whose edges show beyond their tolerance (refine_edges.h), 64 or 256; 0: no more
    /// Light points for emissive surfaces, and as many for a sky. chosen: of 1024 to 16384 the fewest with which narrow
    /// lobes of a title see long lamps by cuts instead of rays; twelve frames took 53, 46 (4096) and 44 CPU s.
    int direct_points = 4096;
    int vpls = 32768;                   ///< about: light points of indirect light; 0: none
    int bounces = 0;                    ///< longest photon path; 0: any
    std::uint64_t caustic_photons = 0;  ///< of a frame; 0: as many as its tolerance needs (caustics.h)
    int min_cut = 8;                    ///< clusters per gather point, both trees together
    int max_cut = 1000;
    int specular_depth = 6;    ///< mirrors and glass after one another
    bool mattes = false;       ///< frames know what covers pixels (mattes.h)
    bool transparent = false;  ///< the world is seen in mirrors and through glass alone
    Clamp clamp = Clamp::bounded;
    bool calibrate = true;  ///< let the film's own light decide the error scale of its cuts (calibration.h)
    CacheUse cache = CacheUse::off;
    core::Isa isa = core::Isa::sse2;
    std::uint64_t seed = 1;  ///< of representatives and light samples; photons use a fixed Halton sequence
    std::uint64_t draw = 0;  ///< other representatives for the same light: cuts err anew, the truth stays
};

}  // namespace render2mpeg::renderer
