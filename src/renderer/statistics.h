#pragma once
// Counts of the renderer.
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/visible.h"
#include "renderer/base/tolerance_bands.h"
#include "renderer/cache/cache_counts.h"
#include "renderer/caustics/caustics.h"
#include "renderer/cut/shade.h"
#include "renderer/hair/hair_counts.h"
#include "renderer/view/see.h"

namespace render2mpeg::renderer {

/// Counts of work and findings, summed since construction. Counts of rays are rays, not packets.
struct Statistics {
    std::uint64_t primary_rays = 0, shadow_rays = 0, photon_rays = 0, specular_rays = 0;
    std::uint64_t exposure_rays = 0, exposed_pixels = 0;  ///< of pixels that shutter or lens blur, over frames
    std::uint64_t air_rays = 0;                           ///< of the air between eye and surfaces
    std::uint64_t gather_rays = 0;                        ///< of final gathering, those that light its cells among them
    std::uint64_t caustic_photons = 0, caustic_landings = 0, caustic_rays = 0;
    std::uint64_t caustic_pairs = 0, caustic_doubts = 0;  ///< of landings and points; of them asked by a ray
    std::uint64_t gather_points = 0, capped_points = 0;   ///< capped: stopped by max_cut, tolerance not reached
    std::uint64_t true_paths = 0, true_pixels = 0, capped_pixels = 0;  ///< of frames by paths alone; capped: likewise
    std::uint64_t direct_clusters = 0, indirect_clusters = 0;
    std::uint64_t non_finite = 0;          ///< pixel values replaced by 0
    std::string first_non_finite;          ///< where: "frame 3, pixel (10, 20)"
    std::vector<std::string> image_notes;  ///< a line for each image, and about volumes, with values that were mended
    ToleranceBands bands;                  ///< of gather points
    double clamped_energy = 0;             ///< share of gathered luminance that clamping removed, 0..1
    std::size_t direct_points = 0, indirect_points = 0;  ///< light points of the last frame
    double luminance = 0;                                ///< that this is a share of: what arrived, clamped included
    double least_error_scale = 0, largest_error_scale = 0, mean_error_scale = 0;  ///< over frames lit; 0: none was
    std::uint64_t frames_calibrated = 0;                                          ///< the frames that these are over
    std::uint64_t calibrated_pixels = 0;  ///< gathered again for it; their rays count nowhere
    double calibration_seconds = 0;       ///< CPU, part of the time of shading
    double sky_seconds = 0;               ///< CPU, about, part of the time of seeing: looking at the sky
    double photon_energy = 0;             ///< luminance flux that photons brought to surfaces, bounce by bounce
    double photon_energy_lost = 0;        ///< of it, what ended since no surface counts as brighter than largest_albedo
    double layer_seconds = 0;             ///< likewise, of the time of shading: what translucent surfaces let through
    HairCounts hair;
    CacheCounts cache;  ///< of the irradiance cache (Settings::cache)
};

void add(const ShadeCounts& counts, const core::Visible& visible, Statistics& statistics);
void add(const CausticCounts& counts, Statistics& statistics);
void add(const SeeCounts& counts, Statistics& statistics);
/// Adds the error scale of one more frame.
void add_error_scale(double value, Statistics& statistics);

}  // namespace render2mpeg::renderer
