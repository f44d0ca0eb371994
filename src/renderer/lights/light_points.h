#pragma once
// Turns lamps, shining surfaces and the sky into light points.
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "image/sky_map.h"
#include "renderer/base/light_point.h"
#include "renderer/base/plan.h"
#include "renderer/surface/posed_scene.h"

namespace render2mpeg::renderer {

/// Where one light point sits on an emissive surface: chosen once for a chunk, so that what is still keeps its points.
struct EmitterPoint {
    std::uint32_t object = 0, primitive = 0;
    float u = 0, v = 0;     ///< barycentrics
    bool front = true;      ///< which side of the triangle it shines from
    float share = 0;        ///< of the triangle's area that it stands for
    glm::vec3 radiance{0};  ///< mean over that area, at emission factor 1
};

/// Turns every light into light points (docs/model/lights.md): each punctual light into one, emissive surfaces
/// in proportion to their power, the sky by importance. Ids are stable over a chunk.
class LightPoints {
  public:
    /// `count` is the number of points for emissive surfaces and sky together, about; surfaces and sky share it half
    /// and half where both are there.
    LightPoints(const PosedScene& posed_scene, const Plan& plan, int count, std::uint64_t seed);

    /// Divides the sky by where light comes from that cameras see. A function of the animation, whose instants get
    /// posed. Returns the rays that it took.
    std::uint64_t look_at_sky(PosedScene& posed_scene);

    /// Chooses the places on emissive surfaces. A function of the animation and this snapshot, which gets posed.
    void place(PosedScene& posed_scene, const scene::Snapshot& first);

    /// Every light point that will ever shine, at its time-averaged strength (average_light.h) and as things lay when
    /// places were chosen.
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
    LightPoint emitter_point(const PosedScene& posed_scene, std::size_t index) const;

    const scene::Animation& animation_;
    bool punctual_, emissive_;
    int emissive_count_ = 0, sky_count_ = 0;
    std::uint64_t seed_;
    std::vector<EmitterPoint> emitters_;
    std::vector<LightPoint> sky_;  ///< never changes
    image::SkyImportance sky_importance_;
    bool looked_at_sky_ = false;
    float sky_part_ = std::numeric_limits<float>::infinity();
    std::vector<LightPoint> average_;
};

/// The light points less what gather rays see of the sky: parts of it keep what is brighter than that.
std::vector<LightPoint> beyond_rays(std::vector<LightPoint> points, float brightest);

/// First ids of the three kinds of direct light points.
inline constexpr std::uint32_t first_sky_id = 1u << 26;
inline constexpr std::uint32_t first_punctual_id = 1u << 27;

}  // namespace render2mpeg::renderer
