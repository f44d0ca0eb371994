#include "renderer/statistics.h"

#include <algorithm>
#include <string>

namespace render2mpeg::renderer {

void add(const ShadeCounts& counts, const core::Visible& visible, Statistics& s) {
    if (s.non_finite == 0 && counts.non_finite > 0)
        s.first_non_finite = "frame " + std::to_string(visible.frame) + ", pixel (" +
                             std::to_string(counts.first_non_finite % visible.width()) + ", " +
                             std::to_string(counts.first_non_finite / visible.width()) + ")";
    s.non_finite += counts.non_finite;
    s.shadow_rays += counts.shadow_rays;
    s.gather_points += counts.gather_points;
    s.capped_points += counts.capped_points;
    s.bands.add(counts.bands);
    s.direct_clusters += counts.direct_clusters;
    s.indirect_clusters += counts.indirect_clusters;
    const double clamped = s.clamped_energy * s.luminance + counts.clamped;
    s.luminance += counts.gathered + counts.clamped;
    s.clamped_energy = s.luminance > 0 ? clamped / s.luminance : 0.0;
}

void add(const CausticCounts& counts, Statistics& s) {
    s.caustic_rays += counts.followed.rays + counts.splats.doubtful;
    s.caustic_photons += counts.followed.photons;
    s.caustic_landings += counts.landings;
    s.caustic_pairs += counts.splats.pairs;
    s.caustic_doubts += counts.splats.doubtful;
}

void add(const SeeCounts& counts, Statistics& s) {
    s.primary_rays += counts.primary_rays;
    s.specular_rays += counts.specular_rays;
    s.sky_seconds += counts.sky_seconds;
}

void add_error_scale(double value, Statistics& s) {
    std::uint64_t& frames = s.frames_calibrated;
    s.least_error_scale = frames == 0 ? value : std::min(s.least_error_scale, value);
    s.largest_error_scale = std::max(s.largest_error_scale, value);
    ++frames;
    s.mean_error_scale += (value - s.mean_error_scale) / static_cast<double>(frames);
}

}  // namespace render2mpeg::renderer
