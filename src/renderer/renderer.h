#pragma once
// The renderer's façade: see, shade, audit.
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/isa.h"
#include "core/motion_field.h"
#include "core/radiance.h"
#include "core/tolerance_map.h"
#include "renderer/base/plan.h"
#include "renderer/base/tolerance_bands.h"
#include "renderer/cache/cache_counts.h"
#include "renderer/calibration/audited_pixel.h"
#include "renderer/geometry/ray_tracer.h"
#include "renderer/hair/hair_counts.h"
#include "renderer/surface/gather_point.h"
#include "renderer/truth/error_split.h"
#include "scene/pose/snapshot.h"

namespace render2mpeg::renderer {

/// Whether near VPLs are clamped (docs/model/clamping.md).
enum class Clamp { bounded, none };

/// Where gathered light is kept for other pixels and frames (irradiance_cache.h).
enum class CacheUse {
    off,
    static_light,  ///< where light stays what it is all through a film, or rays gather it
    on             ///< everywhere; a change of light forgets what was kept
};

/// How light that surfaces and skies send is gathered.
enum class Indirect {
    rays,      ///< by rays that ask a cache on surfaces (final_gather.h)
    lightcuts  ///< by cuts through trees of light points
};

struct Settings {
    Indirect indirect = Indirect::rays;
    scene::PictureFormat format;
    int samples = 4;           ///< eye samples per pixel, >= 1
    int edge_samples = 0;      ///< of pixels with edges; 0: as many
    int most_samples = 0;      ///< of pixels whose edges could show all the same (look_closer.h), 64 or 256; 0: no more
    int direct_points = 1024;  ///< light points for emissive surfaces; twice as many for a sky, or for both
    int vpls = 4096;           ///< anchor lights, about: light points of indirect light; 0: none
    int bounces = 0;           ///< longest photon path; 0: any
    std::uint64_t caustic_photons = 0;  ///< of a frame; 0: as many as its tolerance needs (caustics.h)
    int min_cut = 8;                    ///< clusters per gather point, both trees together
    int max_cut = 1000;
    int specular_depth = 6;    ///< mirrors and glass after one another
    bool mattes = false;       ///< Seen has what covers pixels (mattes.h)
    bool transparent = false;  ///< the world is seen in mirrors and through glass alone
    Clamp clamp = Clamp::bounded;
    std::uint64_t photons = 0;  ///< that each instant's anchors are lit by; 0: as many as `vpls` asks for
    bool calibrate = true;      ///< let the film's own light decide the error scale of its cuts (calibration.h)
    CacheUse cache = CacheUse::off;
    core::Isa isa = core::Isa::sse2;
    std::uint64_t seed = 1;  ///< of representatives and light samples; photons use a fixed Halton sequence
    std::uint64_t draw = 0;  ///< other representatives for the same light: cuts err anew, the truth stays
};

/// What was done and found, summed since construction. Counts of rays are rays, not packets.
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
    std::uint64_t non_finite = 0;                        ///< pixel values replaced by 0
    std::string first_non_finite;                        ///< where: "frame 3, pixel (10, 20)"
    std::vector<std::string> image_notes;                ///< a line for each image with values that are not finite
    ToleranceBands bands;                                ///< of gather points
    double clamped_energy = 0;                           ///< share of gathered luminance that clamping removed, 0..1
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

/// See and shade. State that lives over frames is a function of the animation, the settings and the chunk's first
/// frame.
class Renderer {
  public:
    /// Decodes textures and builds what never changes. Throws core::Error for images that cannot be read.
    Renderer(const scene::Animation& animation, const Settings& settings, const Plan& plan);
    ~Renderer();

    /// Forgets everything that was carried over from earlier frames.
    void start_chunk(const scene::Snapshot& first);

    /// Primary visibility with antialiasing; no light. May run ahead by some frames.
    Seen see(const scene::Snapshot& snapshot);

    /// The frame but for gathered light: finer edges where they could show (look_closer.h), what the open shutter and
    /// the lens show (expose.h), caustics and light of the air, found as well as `tolerance` asks for; null: for a
    /// rough look, without finer edges. `seen`: of the same instant.
    Seen complete(const scene::Snapshot& snapshot, Seen seen, const core::ToleranceMap* tolerance,
                  const ExposureSamples* samples = nullptr);

    /// Gathers light for all gather points of a frame until every pixel's error bound is below its tolerance.
    core::Radiance shade(const scene::Snapshot& snapshot, const Seen& seen, const core::ToleranceMap& tolerance);

    /// `shade` by paths alone (true_frame.h), which know nothing of light points, trees and records. Of frames that
    /// shutter or lens blur, the middle.
    core::Radiance trace(const scene::Snapshot& snapshot, const Seen& seen, const TruthSettings& finely);

    /// `shade` for a first, rough look that is no frame of the film: counts in the statistics as time and as an update
    /// of light only, teaches nothing, and takes the law of the stopping rule as it is.
    core::Radiance sketch(const scene::Snapshot& snapshot, const Seen& seen, const core::ToleranceMap& tolerance);

    /// `shade` for a draft of a film (draft_light.h): a lattice of points is lit within the tolerance, and what the
    /// frame before knew is carried along. `motion`: to that frame; null: there is none in the chunk, or no motion.
    core::Radiance draft(const scene::Snapshot& snapshot, const Seen& seen, const core::ToleranceMap& tolerance,
                         const core::MotionField* motion);

    /// Gathers `count` pixels of the frame shaded last again, from every light point, where they were lit: how well its
    /// tolerances were kept (audit.h). Counts nowhere in the statistics.
    std::vector<AuditedPixel> audit(const scene::Snapshot& snapshot, const Seen& seen,
                                    const core::ToleranceMap& tolerance, const core::Radiance& radiance, int count);

    /// Holds audited pixels of the frame shaded last against the truth, by paths (pixel_truth.h). Counts nowhere in the
    /// statistics. `finely`: how well the truth is found.
    std::vector<JudgedPixel> judge(const scene::Snapshot& snapshot, const Seen& seen,
                                   const core::ToleranceMap& tolerance, const core::Radiance& radiance,
                                   std::span<const AuditedPixel> audited, const TruthSettings& finely = {});

    const Statistics& statistics() const;
    /// What is posed as of the last frame, for measurements.
    const RayTracer& tracer() const;
    /// CPU seconds by pass since construction, for the plan's table.
    double seconds(Pass pass) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace render2mpeg::renderer
