#pragma once
// Follows rays from the eye through mirrors and glass, with ray differentials.
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "core/visible.h"
#include "renderer/base/sampled_clock.h"
#include "renderer/surface/frame.h"
#include "renderer/surface/light_ray.h"
#include "renderer/view/see.h"

namespace render2mpeg::renderer {

/// A ray and how it differs from the rays one sample to the right and one below. [Igehy1999]
struct EyeRay : LightRay {
    SurfaceFootprint origin_change;     ///< differences of origins
    SurfaceFootprint direction_change;  ///< differences of unit directions
    /// Of the sample, and from bit 16 of the pixel among 4 x 4: rough glass bends each otherwise.
    std::uint32_t number = 0;

    /// Footprint of the ray and its neighbours on the plane at `distance` with this normal.
    SurfaceFootprint footprint_at(float distance, glm::vec3 normal) const;
};

/// The camera's ray through a picture position, whose samples are `spacing` pixels apart; `far` is where it ends.
/// `lens`: where it leaves the aperture (Camera::ray_through).
EyeRay eye_ray(const scene::Camera& camera, glm::vec2 position, float spacing, float& far, glm::vec2 lens = {0, 0});

/// One surface that a sample shows.
struct Fragment {
    SurfacePoint point;
    glm::vec3 weight{0};              ///< share of the sample's light that comes by this surface, per channel
    float extent = 0;                 ///< how far apart neighbouring samples are across the ray there, scene units
    std::uint8_t path = direct_path;  ///< mirrors and glass before
    SurfaceFootprint turn{};          ///< by how much normals differ at neighbouring samples; of narrow lobes alone
};

/// Main surface of a sample, straight ahead through layers and glass.
struct MainSurface {
    float share = -1;  ///< luminance of its share; -1: nothing yet
    core::PixelClass kind = core::PixelClass::none;
    SurfacePoint point;  ///< for kinds `surface` and `reflected`
    core::SurfaceAddress
        imaged;  ///< surface shown there by a flat mirror; no surface: it is no flat mirror, or shows none
};

/// Everything that one sample sees.
struct EyeSample {
    std::vector<Fragment> fragments;  ///< surfaces with something to gather
    glm::vec3 emitted{0};             ///< emission, sky, unlit surfaces
    glm::vec3 emitted_specular{0};    ///< the part of it seen in mirrors or through glass
    std::vector<AirSpan> air;         ///< air seen straight from the eye; `pixel` is left alone
    std::vector<AirPath> air_beyond;  ///< air beyond mirrors and bending surfaces
    std::vector<core::Matte> mattes;  ///< its matte coverage; empty: nobody asks
    MainSurface main;
    int lesser_paths = 0;  ///< lesser ones that left boundaries of solid glass
    int dim_paths = 0;     ///< the same of those followed for emission alone
};

/// Follows rays of the eye through layers and glass, and by mirrors.
class EyePaths {
  public:
    EyePaths(const PosedScene& posed_scene, const SeeSettings& settings, const Plan& plan);

    /// Follows a ray of the eye whose nearest surface before `far` is `first`; replaces `sample`.
    void look(const EyeRay& ray, float far, const Hit& first, EyeSample& sample, SeeCounts& counts) const;

    /// CPU seconds that the sky took to look at, about (sampled_clock.h).
    double sky_seconds() const { return sky_clock_.seconds(); }

  private:
    struct PathState;
    void follow(PathState path, Hit hit, EyeSample& sample, SeeCounts& counts) const;
    void see_sky(const PathState& path, EyeSample& sample) const;
    void see_discs(const PathState& path, float length, EyeSample& sample) const;
    static void emit(const PathState& path, glm::vec3 light, EyeSample& sample);
    void cover(const PathState& path, const SurfacePoint& point, float share, EyeSample& sample) const;
    void end_in_black(const PathState& path, const SurfacePoint& point, EyeSample& sample) const;
    bool is_hole(const PathState& path, const SurfacePoint& point) const;
    glm::vec3 show(PathState& path, Fragment& fragment, const SurfaceFootprint& footprint, EyeSample& sample,
                   SeeCounts& counts) const;
    void mirror(const PathState& path, const Fragment& fragment, const SurfaceFootprint& footprint, EyeSample& sample,
                SeeCounts& counts) const;
    bool split_colors(const PathState& path, const Hit& hit, EyeSample& sample, SeeCounts& counts) const;
    void spread(Fragment& fragment, EyeSample& sample) const;
    void pass_air(PathState& path, float distance, EyeSample& sample) const;
    bool is_turned(const SurfacePoint& point) const;
    glm::vec3 facet(const PathState& path, const SurfacePoint& point) const;
    SurfaceFootprint normal_change(const SurfacePoint& point, const SurfaceFootprint& footprint, float time) const;
    bool may_go_on(const PathState& path, bool lesser, EyeSample& sample) const;
    bool bend(PathState& path, const Fragment& fragment, const SurfaceFootprint& footprint, glm::vec3 weight,
              EyeSample& sample) const;

    const PosedScene& posed_scene_;
    bool sky_, mirrors_, bodies_, discs_, edits_, mattes_, transparent_;
    int specular_depth_;
    const Air* air_;
    mutable SampledClock sky_clock_;
};

}  // namespace render2mpeg::renderer
