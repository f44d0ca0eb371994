#pragma once
// Lights the fibres that a frame shows, and what shines from below surfaces.
#include <span>
#include <vector>

#include "core/tolerance_map.h"
#include "renderer/base/plan.h"
#include "renderer/base/stream.h"
#include "renderer/gather/gather_ray.h"
#include "renderer/gather/surface_cache.h"
#include "renderer/hair/hair_counts.h"
#include "renderer/surface/frame.h"
#include "renderer/surface/posed_scene.h"
#include "renderer/surface/ungathered_light.h"

namespace render2mpeg::renderer {

/// Light of fibres and below surfaces, at places where walks end. Every sample of the eye asks lamps by next events,
/// and sends a ray by its fibre's scattering, whose end a cache on surfaces and among strands knows (surface_cache.h);
/// again and again, until the standard error of its pixel is below its tolerance or that of the eye samples, as far as
/// the tile's pixels together tell it. A function of the posed instant, of what is seen and of what the cache was
/// asked, for any number of threads.
class HairLight {
  public:
    /// `cache`: of the posed instant.
    HairLight(const PosedScene& posed_scene, const Plan& plan, SurfaceCache& cache);

    /// Luminance of its pixels' fibres, and the standard error that it would have by one sample, by what samples differ
    /// by, those of 3x3 pixels together; 0 where a pixel shows none. `samples`: of pixels, where the frame does not
    /// tell.
    Strands look_at_strands(const Frame& seen, int samples, HairCounts& counts);

    /// Adds the light of all fibres that a frame shows. `tolerance`: null for a rough look.
    void add(const Frame& seen, const core::ToleranceMap* tolerance, UngatheredLight& light, HairCounts& counts);

  private:
    struct Pixel;
    struct Traced;
    void trace(const FibreSample& sample, const Stream& numbers, Traced& out) const;
    void take_rounds(std::span<const FibreTile> tiles, std::span<Pixel> pixels, HairCounts& counts);
    void trace_all(std::span<const FibreTile> tiles, std::span<const std::span<Pixel>> tasks, HairCounts& counts);
    static void add_round(std::span<const FibreTile> tiles, std::span<const glm::vec3> lights, Pixel& pixel);
    static void want_rounds(std::span<Pixel> tile, const core::ToleranceMap& tolerance,
                            const core::Plane<glm::vec3>& known, double rays, HairCounts& counts);
    std::vector<Pixel> light(std::span<const FibreTile> tiles, int across, const core::ToleranceMap* tolerance,
                             const core::Plane<glm::vec3>& known, HairCounts& counts);

    const PosedScene& posed_scene_;
    GatherRays gather_rays_;
    SurfaceCache& cache_;
};

}  // namespace render2mpeg::renderer
