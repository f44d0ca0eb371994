#pragma once
// Directions towards area lamps: evenly over the lamp, and along glossy lobes.
#include <glm/glm.hpp>
#include <span>

#include "renderer/base/area_lamp.h"
#include "renderer/tree/gather_lanes.h"

namespace render2mpeg::renderer {

/// All samples of a lamp; the first 4, 8, 16, ... of a lane are stratified as well.
inline constexpr int most_lamp_samples = 1024;

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

    /// AreaLamp::aim
    void aim(const LampSamples& samples, Vec3Lanes& targets) const { lamp_.aim(view_, samples.direction, targets); }

  private:
    void start_lobes();
    SampleNumbers numbers(std::span<const glm::vec2> all, int k) const;
    void take_facets(const SampleNumbers& u, LampSamples& samples) const;

    const AreaLamp& lamp_;
    const GatherLanes& lanes_;
    LampView view_;
    FrameLanes facets_;     ///< lobes: stretched outgoing direction and two across it, local
    Vec3Lanes outgoing_;    ///< lobes: local, z along the normal
    Lanes hidden_, alpha_;  ///< lobes: how far the disc of facets is cut; GGX width
};

}  // namespace render2mpeg::renderer
