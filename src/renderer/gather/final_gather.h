#pragma once
// Light of points by rays over their hemispheres, as many as their tolerances ask for.
#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "renderer/base/allocation.h"
#include "renderer/base/plan.h"
#include "renderer/base/stream.h"
#include "renderer/cut/point_light.h"
#include "renderer/gather/gather_ray.h"
#include "renderer/gather/near_light.h"
#include "renderer/gather/surface_cache.h"
#include "renderer/surface/gather_point.h"
#include "scene/model/camera.h"

namespace render2mpeg::renderer {

/// Rays of a request without a tolerance, and of one with it at most.
inline constexpr std::uint32_t most_gather_rays = 4096;

struct PointSums;
class RayGuide;

/// Which rays leave a point.
enum class RaysOf {
    all,   ///< over its hemisphere and along its lobe
    lobes  ///< along its narrow lobe alone (Bsdf::has_narrow_lobe)
};

/// A point whose indirect light and sky are wanted.
struct GatherRequest {
    const GatherPoint* point = nullptr;
    PointTolerance tolerance;  ///< `base` holds the luminance that its pixel has already
    Stream numbers;            ///< of its rays: the same place of the picture, the same rays
    float extent = 0;          ///< of a pixel there, world: rays shorter than this are followed as paths
    RaysOf which = RaysOf::all;
    std::uint32_t pool = 0;  ///< requests of one pool lie next to each other, on about one surface
    std::uint32_t rays = 0;  ///< so many, a multiple of 8; 0: by the tolerance
    std::uint32_t from = 0;  ///< number of the first: it has so many already
};

/// Light found by rays for one point.
struct RayLight {
    /// Irradiance over pi, under a lobe what passes it; the lobe's radiance is f0 x the second + f90 x the third.
    std::array<glm::vec3, 3> light{};
    core::StandardError error{};  ///< in the pixel
    float batch_variance = 0;     ///< of means of 8 rays, luminance of the pixel squared
    std::uint32_t rays = 0;
    /// Mean of what is met along the lobe, of one over its distance; 0 of the sky.
    float nearness = 0;
    /// Luminance of the pixel by the first 8 less that by the next 8: how they vary by chance, with sign.
    float difference = 0;
};

/// The request of a point that lies in this pixel of the picture.
GatherRequest request_of(const GatherPoint& point, const PointTolerance& tolerance, glm::ivec2 pixel,
                         const scene::Camera& camera);

/// Adds what rays found to a point's light.
void add(const RayLight& rays, const GatherPoint& point, PointLight& light);

/// Light of the sky, of shining surfaces and of places near lamps as rays see it; the light trees have the rest.
struct SkyOfRays {
    float brightest = 0;                ///< luminance over hemispheres, at most
    float lobe_brightest = 0;           ///< along lobes: luminance times `importance`, at most
    image::SkyImportance importance{};  ///< LightPoints::sky_importance
    NearField near_field{};             ///< of whose light rays over hemispheres miss a part
    std::vector<float> shining{};       ///< RayRules::shining
};

/// Counts of final gathering, summed since construction.
struct FinalGatherCounts {
    std::uint64_t points = 0;
    std::uint64_t rays = 0;       ///< of points
    std::uint64_t cell_rays = 0;  ///< to light cells, shadow rays among them
    double seconds = 0;           ///< CPU
};

/// Final gathering [Ward1988, Christensen1999]: the mean of what cosine-distributed rays see, their hits looked up in a
/// surface cache. Where a request's tolerance decides how many, the first rays of all points of a pool, less the
/// point's own, tell how much rays differ there (docs/model/gathering.md): no point's number depends on what its own
/// rays found, which would bias it. Where light comes from few directions, rays of the pool guide the rest. A function
/// of the posed instant and of the requests since `forget`, for any number of threads.
class FinalGather {
  public:
    FinalGather(const PosedScene& posed_scene, const Plan& plan);

    const PosedScene& posed_scene() const { return posed_scene_; }
    const NearField& near_field() const { return sky_.near_field; }

    /// Forgets all: light or things are others now.
    void forget(const SkyOfRays& sky);

    /// Light of all requests, in their order.
    std::vector<RayLight> gather(std::span<const GatherRequest> requests, Allocation allocation);

    /// Radiance that rays see where they end, which the air on their first segment has not dimmed, and how far that is.
    struct Seen {
        glm::vec3 light{0};
        float distance = 0;
    };
    /// The same for all rays, in their order; `numbers`: ray k's are those at k; `bounces`: surfaces send what they
    /// bounce. Rays are unit.
    std::vector<Seen> seen_by(std::span<const RayQuery> rays, const Stream& numbers, bool bounces);

    /// Light of surfaces at the posed instant, for whoever asks.
    SurfaceCache& cache() { return cache_; }
    const FinalGatherCounts& counts() const { return counts_; }

  private:
    struct Bundle;
    struct Pool;
    struct Traced;
    struct Directions;

    // The estimate.
    Directions directions(const GatherRequest& request, const Bundle& bundle) const;
    void trace(const GatherRequest& request, const Bundle& bundle, Traced& out) const;
    static std::vector<std::size_t> runs_of(std::span<const Bundle> bundles, std::size_t rays);
    void trace_all(std::span<const GatherRequest> requests, std::span<const Bundle> bundles,
                   std::vector<PointSums>& sums, std::vector<Pool>& pools);
    void add_bundle(const GatherRequest& request, Traced& traced, PointSums& s, RayGuide* guide) const;
    void trace_wanted(std::span<const GatherRequest> requests, std::span<const std::uint32_t> wanted,
                      std::vector<PointSums>& sums, std::vector<Pool>& pools);
    // How many rays.
    void want_rays(std::span<const GatherRequest> requests, std::span<const PointSums> sums, const Pool& pool,
                   bool pilot, Allocation allocation, std::vector<std::uint32_t>& wanted) const;
    // Where to.
    static std::vector<Pool> pools_of(std::span<const GatherRequest> requests, std::vector<PointSums>& sums);
    void guide(std::span<const GatherRequest> requests, Allocation allocation, Pool& pool, std::vector<PointSums>& sums,
               std::vector<std::uint32_t>& wanted) const;

    const PosedScene& posed_scene_;
    GatherRays gather_rays_;
    SurfaceCache cache_;
    bool bodies_block_;
    SkyOfRays sky_;
    FinalGatherCounts counts_;
};

}  // namespace render2mpeg::renderer
