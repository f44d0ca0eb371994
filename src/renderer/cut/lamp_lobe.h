#pragma once
// Unoccluded light of area lamps in glossy lobes.
#include <cstdint>

#include "renderer/base/area_lamp.h"
#include "renderer/cut/lamp_samples.h"
#include "renderer/tree/light_kernels.h"

namespace render2mpeg::renderer {

/// Contribution of a sample of unit radiance to each lane, over the density of choosing it. In lanes that take
/// directions along their lobes as well, both kinds count by the balance heuristic [Veach1995].
struct alignas(64) LampResponse {
    Lanes plain;     ///< irradiance, over the density of the lamp's samples alone
    Lanes geometry;  ///< irradiance
    Lanes diffuse;   ///< part of it that passes the lobe
    Lanes f0, schlick;
};

/// `peaks`: not 0 in lanes that take directions along their lobes. Without glossy lanes only `plain` is set.
void respond(const GatherLanes& lanes, const LampSamples& samples, const Lanes& peaks, LampResponse& out);

/// Sets all lanes to their mean.
void share_among_lanes(Lanes& values);

/// The lobes' integral over an unoccluded lamp: the irradiance that passes the lobe, and the lobe's two parts. By 16
/// samples at first, of the lamp, and of the lobe where it is narrower than the lamp; then by four times as many.
class LobeIntegral {
  public:
    /// `whole`: irradiance of the lamp at unit radiance, in closed form; estimates of irradiance are scaled to
    /// it. All of them outlive this.
    LobeIntegral(const AreaLamp& lamp, const GatherLanes& lanes, const LampSampler& sampler, const Lanes& whole);

    /// Takes four times as many samples; false where there are no more.
    bool refine();

    /// Of each lane, of each kind.
    int samples() const { return count_; }

    /// All lanes are one point, and share their samples.
    void share_samples();

    /// At unit radiance of the lamp.
    const LightLanes& unit() const { return unit_; }

    /// Standard errors of the luminance that `unit` sends, as the samples' four quarters differ.
    const Lanes& error() const { return error_; }

    /// Not 0 in lanes that take directions along their lobes.
    const Lanes& peaks() const { return peaks_; }

  private:
    static constexpr int first_samples = 16;
    void choose_lobes();
    void take(int quarter, int first, int end);
    void add(const LampResponse& response, int quarter);
    void estimate();
    void unit_of(const LampResponse& sum, float samples, LightLanes& out) const;

    const AreaLamp& lamp_;
    const GatherLanes& lanes_;
    const LampSampler& sampler_;
    const Lanes& whole_;
    bool along_lobes_ = false;
    int count_ = 0;
    alignas(64) Lanes peaks_, error_;
    LampResponse quarters_[4];
    LightLanes unit_;
};

}  // namespace render2mpeg::renderer
