#pragma once
// Directions towards area lamps: evenly over the lamp, and along glossy lobes.
#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "renderer/base/area_lamp.h"
#include "renderer/tree/gather_lanes.h"

namespace render2mpeg::renderer {

/// All samples of a lamp; the first 4, 8, 16, ... of a lane are stratified as well.
inline constexpr int most_lamp_samples = 1024;

/// At most so many corners a polygon has that is lit by as a whole.
inline constexpr int most_lamp_corners = 8;

/// A direction for each lane.
struct alignas(64) LampSamples {
    Vec3Lanes direction;    ///< unit
    Lanes inverse_density;  ///< 1 over the density of choosing it evenly over the lamp, in steradians; 0: misses it
};

/// Chooses samples of one lamp for the lanes of a group. Both outlive it.
class LampSampler {
  public:
    LampSampler(const AreaLamp& lamp, const GatherLanes& lanes);

    /// Each lane's k-th sample of the lamp: of a polygon evenly by area, of round lamps by solid angle.
    void take(int k, LampSamples& samples) const;

    /// Each lane's k-th direction along its lobe, in proportion to the facets that are seen [Heitz2018]; for glossy
    /// lanes. Misses the lamp or not.
    void take_lobe(int k, LampSamples& samples) const;

    /// Where the shadow rays of each lane's k-th samples start: at its places in turn, so that the samples of each
    /// place are spread over the lamp as all are.
    void start_at(int k, Vec3Lanes& origin) const;

    /// Where shadow rays of directions that meet the lamp end; of suns the directions.
    void aim(const LampSamples& samples, Vec3Lanes& targets) const;

  private:
    struct alignas(64) Numbers {
        Lanes x, y;
    };
    void start_polygon();
    void start_cone();
    void start_lobes();
    Numbers numbers(std::span<const glm::vec2> all, int k) const;
    void take_polygon(const Numbers& u, LampSamples& samples) const;
    void take_cone(const Numbers& disc, LampSamples& samples) const;
    void meet_polygon(LampSamples& samples) const;
    void meet_cone(LampSamples& samples) const;
    void aim_at_polygon(const Vec3Lanes& direction, Vec3Lanes& targets) const;
    void aim_at_sphere(const Vec3Lanes& direction, Vec3Lanes& targets) const;

    const AreaLamp& lamp_;
    const GatherLanes& lanes_;
    Vec3Lanes axis_, tangent_, bitangent_;  ///< round lamps: about the direction of their middle
    Lanes distance_;                        ///< spheres: of their middle
    Lanes lowered_;                         ///< round lamps: 1 - cosine of half the angle they span
    Vec3Lanes edges_[most_lamp_corners];    ///< polygons: normals of the planes through the lane and an edge, inwards
    bool even_ = false;                     ///< polygons: parallelograms
    Lanes height_;                          ///< polygons: of the lane over their plane
    FrameLanes facets_;                     ///< lobes: stretched outgoing direction and two across it, local
    Vec3Lanes outgoing_;                    ///< lobes: local, z along the normal
    Lanes hidden_, alpha_;                  ///< lobes: how far the disc of facets is cut; GGX width
};

}  // namespace render2mpeg::renderer
