#pragma once
// A lamp that is lit by as a whole: the interface of its kinds.
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>

#include "renderer/base/lanes.h"
#include "renderer/base/light_point.h"

namespace render2mpeg::renderer {

/// A direction for each lane.
struct alignas(64) LampSamples {
    Vec3Lanes direction;    ///< unit
    Lanes inverse_density;  ///< 1 over the density of choosing it evenly over the lamp, in steradians; 0: misses it
};

/// Two numbers for each lane.
struct alignas(64) SampleNumbers {
    Lanes x, y;
};

/// A lamp as the places of sixteen lanes see it; its kind knows which of these it has.
struct LampView {
    explicit LampView(const Vec3Lanes& at) : places(at) {}

    const Vec3Lanes& places;
    FrameLanes cone;     ///< about the axis of the cone that it spans
    Lanes lowered;       ///< 1 - cosine of half that angle
    Lanes distance;      ///< of its middle, or over its plane
    Vec3Lanes edges[8];  ///< normals of the planes through the place and an edge, inwards
};

/// A lamp whose unoccluded irradiance has a closed form, so that only the share of it that is visible must be sampled
/// (docs/model/lights.md): a flat or round surface that shines evenly, or a sun with a size.
class AreaLamp {
  public:
    virtual ~AreaLamp() = default;

    /// Irradiance at a place with this unit normal at radiance 1, nothing in the way.
    virtual float irradiance(glm::vec3 place, glm::vec3 normal) const = 0;
    /// As a light point that shines alike from its disc, for air; none of flat lamps and suns.
    virtual std::optional<LightPoint> ball() const { return std::nullopt; }
    /// Whether it is sampled evenly by solid angle, from numbers in the unit disc; else by area, from the unit square.
    virtual bool is_round() const { return true; }

    /// Prepares what the other three need, as they stand for round lamps: the cone, `lowered`.
    virtual void look(LampView& view) const = 0;
    virtual void choose(const LampView& view, const SampleNumbers& numbers, LampSamples& samples) const;
    /// The density of `choose` in directions that are given.
    virtual void meet(const LampView& view, LampSamples& samples) const;
    /// Where shadow rays of directions that meet the lamp end; of suns the directions.
    virtual void aim(const LampView&, const Vec3Lanes& direction, Vec3Lanes& targets) const { targets = direction; }

    glm::vec3 radiance{0};
    std::uint32_t object = core::no_id;    ///< whose surface it is; suns: none
    LightType type = LightType::oriented;  ///< as what its samples count
    bool sharp = false;                    ///< its shadows are too sharp to be interpolated between places

  protected:
    /// Of a lane: the cone about `axis` (unit); `sine`: of half its angle.
    static void span(LampView& view, int lane, glm::vec3 axis, float sine);
};

/// Irradiance of a disc or sphere of radiance 1 that spans a cone, of which the squared sine of half the angle is
/// given (0..1), about a direction whose cosine to the normal is given: pi sin^2 cos above the horizon, and a closed
/// form across it [Snyder1996].
double cone_irradiance(double cosine, double sine_squared);

}  // namespace render2mpeg::renderer
