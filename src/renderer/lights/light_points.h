#pragma once
// Turns lamps, shining surfaces and the sky into light points.
#include <limits>
#include <vector>

#include "image/sky_map.h"
#include "renderer/base/plan.h"
#include "renderer/lights/light.h"

namespace render2mpeg::renderer {

/// Where one light point sits on an emissive surface: chosen once for a chunk, so that what is still keeps its points.
struct EmitterPoint {
    std::uint32_t object = 0, primitive = 0;
    float u = 0, v = 0;     ///< barycentrics
    bool front = true;      ///< which side of the triangle it shines from
    float share = 0;        ///< of the triangle's area that it stands for
    glm::vec3 radiance{0};  ///< mean over that area, at emission factor 1
};

/// Chooses about `count` places on the emissive surfaces of the posed instant, in proportion to power (area x mean
/// luminance, texture included), stratified along the surfaces; at least one for every object that emits at all. `seed`
/// shifts the strata.
std::vector<EmitterPoint> place_emitters(const PosedScene& posed_scene, const scene::Snapshot& snapshot, int count,
                                         std::uint64_t seed);

/// The light point of a place that shines, at the posed instant.
LightPoint point_at(const PosedScene& posed_scene, const EmitterPoint& place, std::uint32_t id);

/// About `count` parts of a sky as light points, finer where the importance says so.
std::vector<LightPoint> sky_points(const image::SkyMap& sky, int count, const image::SkyImportance& importance);

/// The light points less what gather rays see of the sky: parts of it keep what is brighter than that.
std::vector<LightPoint> beyond_rays(std::vector<LightPoint> points, float brightest);

/// The snapshot with every lamp and emissive surface at its average strength over the film, but at least a
/// tenth of its largest, so that what shines for a moment, or later, is reckoned with. For plans of light
/// alone.
scene::Snapshot with_average_light(const scene::Snapshot& snapshot);

/// The light of a direction over the sphere's mean: how many surfaces that cameras see over the film look there, by
/// their cosines, directly or by one bounce; at least a fifth. Empty where they see none of the sky, or much of it:
/// even parts serve as well then, and lie more evenly. A function of the animation alone, whose instants get posed.
/// `rays` counts those it takes.
image::SkyImportance sky_importance(PosedScene& posed_scene, std::uint64_t& rays);

/// Turns every light into light points (docs/model/lights.md): each punctual light into one, emissive surfaces
/// in proportion to their power, the sky by importance. Ids are stable over a chunk.
class LightPoints {
  public:
    /// `count` is the number of points for emissive surfaces, about, and for a sky.
    LightPoints(const PosedScene& posed_scene, const Plan& plan, int count, std::uint64_t seed);

    /// Divides the sky by where light comes from that cameras see. A function of the animation, whose instants get
    /// posed. Returns the rays that it took.
    std::uint64_t look_at_sky(PosedScene& posed_scene);

    /// Chooses the places on emissive surfaces. A function of the animation and this snapshot, which gets posed.
    void place(PosedScene& posed_scene, const scene::Snapshot& first);

    /// Every light point that will ever shine, at its time-averaged strength (with_average_light) and as things lay
    /// when places were chosen.
    const std::vector<LightPoint>& average() const { return average_; }

    /// All light points of the posed instant; lights that are off or black are left out. Positions lie off their
    /// surface by its rounding error, so that a ray that ends there does not meet it.
    std::vector<LightPoint> at(const PosedScene& posed_scene) const;

    /// Luminance of the irradiance of a usual point of the sky, of half of them more, times `sky_importance` of its
    /// direction; infinite without any.
    float sky_part() const { return sky_part_; }
    /// Importance by which the sky was divided; empty: evenly.
    const image::SkyImportance& sky_importance() const { return sky_importance_; }

  private:
    void divide_sky(const PosedScene& posed_scene);

    const scene::Animation& animation_;
    bool lamps_, emissive_;
    int emissive_count_ = 0, sky_count_ = 0;
    std::uint64_t seed_;
    std::vector<EmitterPoint> emitters_;
    std::vector<LightPoint> sky_;  ///< never changes
    image::SkyImportance sky_importance_;
    bool looked_at_sky_ = false;
    float sky_part_ = std::numeric_limits<float>::infinity();
    std::vector<LightPoint> average_;
};

}  // namespace render2mpeg::renderer
