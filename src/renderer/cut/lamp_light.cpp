#include "renderer/cut/lamp_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/numeric.h"
#include "core/standard_error.h"
#include "renderer/base/allocation.h"
#include "renderer/cut/lamp_lobe.h"
#include "renderer/cut/lamp_samples.h"
#include "renderer/cut/shadow_rays.h"

namespace render2mpeg::renderer {
namespace {

/// Samples of a lane, step by step; the last are all that there are.
constexpr std::array<int, 11> steps{1, 2, 4, 8, 16, 32, 64, 128, 256, 512, most_lamp_samples};

/// The first of them where tolerances are bounds: four samples, by which sixteen lanes probe sixty-four places.
constexpr std::size_t first_of_bounds = 2;

/// Samples of a lane that tell whether it sees all of the lamp, or nothing.
constexpr int least_told = 4;

/// Of its tolerance, the standard error that a lane's light may have since its lamp is sampled. chosen: 1/4 of 1/8 and
/// 1/4 (docs/model/lights.md).
constexpr float part_of_tolerance = 0.25f;

/// Likewise of lobes, without rays: quarters of the samples tell it, which err more than a quarter of them does.
constexpr float part_of_lobes = 0.25f;

/// Visible share of a lane, by the weight of its samples.
struct alignas(64) SeenShare {
    Lanes weight{}, seen{};
    Lanes squares{};  ///< of weights: few of them may count for most

    void add(int i, float sample, bool visible) {
        weight[i] += sample;
        squares[i] += sample * sample;
        seen[i] += visible ? sample : 0.0f;
    }
    void share_samples() {
        for (Lanes* sum : {&weight, &seen, &squares}) share_among_lanes(*sum);
    }
    float share(int i) const { return std::min(core::divide_or(seen[i], weight[i], 0.0f), 1.0f); }
    /// So many samples of one weight would tell as much.
    float count(int i) const { return core::divide_or(weight[i] * weight[i], squares[i], 0.0f); }
};

/// Traced samples, lane by lane.
struct alignas(64) TracedSamples {
    SeenShare lamp;     ///< of irradiance
    SeenShare lobe;     ///< of light of the lobe
    Lanes passed[3]{};  ///< of visible irradiance, times transmittance of layers
};

/// One lamp, gathered for one group of points.
class LampGatherer {
  public:
    LampGatherer(const AreaLamp& lamp, const GatherLanes& lanes, bool translucent, const LampAccuracy& accuracy,
                 ShadowTester& shadows)
        : lamp_(lamp), lanes_(lanes), translucent_(translucent), accuracy_(accuracy), shadows_(shadows) {}

    void gather(LampLight& out);

  private:
    void measure();
    void take_known();
    void trace_all();
    void trace_as_needed();
    void tell_shadows() const;
    void trace(std::uint32_t asked, int first, int end);
    /// Which of the samples, of the lamp or of a lobe.
    struct Which {
        int sample;
        bool along_lobe;
    };
    void trace_sample(const LampSamples& samples, const LampResponse& response, std::uint32_t asked, Which which,
                      const Vec3Lanes& from);
    std::uint32_t too_rough(std::uint32_t reached, int count);
    bool is_too_rough(int lane, float light) const;
    void add_errors(const SeenShare& seen, const Lanes& luminance, std::uint32_t reached, float least_count);
    void refine_lobes();
    float lobe_share(int lane) const;
    float allowed(int lane, float light) const;
    float allowed(int lane, float light, float more) const;
    void store(LampLight& out) const;

    const AreaLamp& lamp_;
    const GatherLanes& lanes_;
    bool translucent_;
    LampAccuracy accuracy_;
    ShadowTester& shadows_;
    std::optional<LampSampler> sampler_;
    std::optional<LobeIntegral> lobes_;     ///< where some lane is glossy
    std::uint32_t reached_ = 0;             ///< lanes that the lamp is above the horizon of
    std::uint32_t asked_ = 0;               ///< those of them whose shadow is not known
    std::uint32_t tells_ = 0;               ///< those of them with samples enough to tell the other eye their shadow
    std::uint32_t along_lobes_ = 0;         ///< lanes that trace rays along their lobes
    std::uint32_t by_lobe_ = 0;             ///< lanes whose samples tell which share of their lobe is seen
    alignas(64) Lanes whole_{};             ///< irradiance without occlusion
    alignas(64) Lanes diffuse_{}, lobe_{};  ///< luminance without occlusion, of radiance as it is
    alignas(64) Lanes errors_{};            ///< standard errors, luminance
    alignas(64) Lanes counts_{};            ///< of samples that tell a lane's visible share
    TracedSamples traced_;
};

void LampGatherer::gather(LampLight& out) {
    for (Lanes* part : {&out.unit.diffuse, &out.unit.f0, &out.unit.schlick}) std::fill(*part, *part + lane_count, 0.0f);
    out.unit.any_clamped = false;
    std::fill(&out.tint.passes[0][0], &out.tint.passes[0][0] + lane_count * 3, 1.0f);
    // Unoccluded irradiance,
    for (int i = 0; i < lanes_.count; ++i) {
        whole_[i] = lamp_.irradiance(lanes_.position.at(i), lanes_.normal.axis.at(i));
        reached_ |= whole_[i] > 0.0f ? 1u << i : 0u;
    }
    if (reached_ == 0) return;
    take_known();
    sampler_.emplace(lamp_, lanes_);
    if (lanes_.glossy) lobes_.emplace(lamp_, lanes_, *sampler_, whole_);
    measure();
    // and the share of it that is seen, by more samples where a shadow's edge is.
    if (accuracy_.tolerance == nullptr) {
        trace_all();
    } else {
        trace_as_needed();
        refine_lobes();
    }
    tell_shadows();
    store(out);
}

/// Lanes that see all of the lamp, or nothing, as if one sample had told so.
void LampGatherer::take_known() {
    asked_ = reached_;
    if (accuracy_.shadows == nullptr) return;
    asked_ &= ~accuracy_.shadows->known();
    for (int i = 0; i < lane_count; ++i) {
        if (((reached_ & ~asked_) >> i & 1u) == 0) continue;
        const bool lit = (accuracy_.shadows->lit >> i & 1u) != 0;
        traced_.lamp.add(i, 1.0f, lit);
        for (Lanes& passed : traced_.passed) passed[i] = lit ? 1.0f : 0.0f;
    }
}

void LampGatherer::tell_shadows() const {
    for (int i = 0; accuracy_.shadows != nullptr && i < lane_count; ++i) {
        if ((tells_ >> i & 1u) == 0) continue;
        const float share = traced_.lamp.share(i);
        bool is_plain = traced_.lamp.weight[i] > 0.0f && (share == 0.0f || share == 1.0f) &&
                        (lobes_ == std::nullopt || lobe_share(i) == share);
        for (const Lanes& passed : traced_.passed) is_plain = is_plain && passed[i] == traced_.lamp.seen[i];
        if (is_plain) accuracy_.shadows->set(i, share > 0.0f);
    }
}

float LampGatherer::allowed(int lane, float light) const {
    const float root = accuracy_.tolerance->root[lane];
    return allowed(lane, light, root > 0.0f ? 1.0f / root : 1.0f);
}

float LampGatherer::allowed(int lane, float light, float more) const {
    const GroupTolerance& t = *accuracy_.tolerance;
    return core::Tolerance{t.absolute[lane], t.relative[lane], t.background[lane]}.allows(
        t.base[lane] + (*accuracy_.luminance)[lane] + light, more);
}

/// Luminance without occlusion, and which lobes are worth rays: those whose light matters.
void LampGatherer::measure() {
    LightLanes part{};
    std::copy(std::begin(whole_), std::end(whole_), std::begin(part.diffuse));
    if (lobes_)
        std::copy(std::begin(lobes_->unit().diffuse), std::end(lobes_->unit().diffuse), std::begin(part.diffuse));
    add_luminance(lanes_, unit_light(lanes_, part), lamp_.radiance, diffuse_);
    if (!lobes_) return;
    part = lobes_->unit();
    std::fill(std::begin(part.diffuse), std::end(part.diffuse), 0.0f);
    add_luminance(lanes_, unit_light(lanes_, part), lamp_.radiance, lobe_);
    for (int i = 0; i < lane_count; ++i) {
        if ((asked_ >> i & 1u) == 0 || lanes_.lobed[i] == 0.0f) continue;
        if (!(lobes_->peaks()[i] > 0.0f)) {
            by_lobe_ |= 1u << i;
            continue;
        }
        const bool matters =
            accuracy_.tolerance == nullptr || 0.5f * lobe_[i] > part_of_tolerance * allowed(i, diffuse_[i] + lobe_[i]);
        along_lobes_ |= matters ? 1u << i : 0u;
    }
    by_lobe_ |= along_lobes_;
}

/// The sixty-fours of all lanes are all samples.
void LampGatherer::trace_all() {
    const int samples = accuracy_.one_point ? most_lamp_samples / lane_count : most_lamp_samples;
    while (lobes_ && lobes_->samples() < samples) lobes_->refine();
    trace(reached_, 0, samples);
    tells_ = asked_;
    if (!accuracy_.one_point) return;
    if (lobes_) lobes_->share_samples();
    traced_.lamp.share_samples();
    traced_.lobe.share_samples();
    for (Lanes& passed : traced_.passed) share_among_lanes(passed);
}

/// Looks at these samples of the lanes in `asked`.
void LampGatherer::trace(std::uint32_t asked, int first, int end) {
    LampSamples samples;
    LampResponse response;
    Vec3Lanes from;
    alignas(64) const Lanes none{};
    for (int k = first; asked != 0 && k < end; ++k) {
        sampler_->start_at(k, from);
        sampler_->take(k, samples);
        respond(lanes_, samples, lobes_ ? lobes_->peaks() : none, response);
        trace_sample(samples, response, asked, {k, false}, from);
        if ((asked & along_lobes_) == 0) continue;
        sampler_->take_lobe(k, samples);
        respond(lanes_, samples, lobes_->peaks(), response);
        trace_sample(samples, response, asked & along_lobes_, {k, true}, from);
    }
}

/// Traces a sample. Places behind the surface itself are not seen, and need no ray.
void LampGatherer::trace_sample(const LampSamples& samples, const LampResponse& response, std::uint32_t asked,
                                Which which, const Vec3Lanes& from) {
    const bool along_lobe = which.along_lobe;
    ShadowPacket packet;
    ShadowTimes times;
    if (lanes_.timed) {
        for (int i = 0; i < lane_count; ++i)
            times.at[i] = ShadowTimes::kth(lanes_, i, static_cast<std::size_t>(which.sample));
        packet.times = times.at;
    }
    Vec3Lanes targets;
    sampler_->aim(samples, targets);
    aim<Aimed::at_each>(from, lamp_.type, targets.x, targets.y, targets.z, packet);
    packet.bodies = shadows_.bodies();
    packet.active = 0;
    for (int i = 0; i < lane_count; ++i) {
        const bool in_front = glm::dot(lanes_.geometric.at(i), samples.direction.at(i)) > 0.0f;
        packet.active |= (asked >> i & 1u) != 0 && in_front && response.plain[i] > 0.0f ? 1u << i : 0u;
    }
    glm::vec3 passes[lane_count];
    std::fill(std::begin(passes), std::end(passes), glm::vec3(1));
    const std::uint32_t hidden = packet.active == 0 ? 0 : shadows_.blocked(packet, translucent_ ? passes : nullptr);
    const std::uint32_t visible = packet.active & ~hidden;
    for (int i = 0; i < lane_count; ++i) {
        if ((asked >> i & 1u) == 0) continue;
        const bool seen = (visible >> i & 1u) != 0;
        if (!along_lobe) {
            traced_.lamp.add(i, response.plain[i], seen);
            for (int c = 0; seen && c < 3; ++c) traced_.passed[c][i] += response.plain[i] * passes[i][c];
        }
        if (lanes_.glossy) traced_.lobe.add(i, response.f0[i] + response.schlick[i], seen);
    }
}

/// Adds the error of the visible share v, 0.6 sqrt(v (1 - v)) of the error of strata. Samples of all lanes count
/// together where all see the whole lamp, or none of it; a share of one sample may have been missed.
void LampGatherer::add_errors(const SeenShare& seen, const Lanes& luminance, std::uint32_t reached, float least_count) {
    bool lit = false, dark = false;
    float together = 0;
    for (int i = 0; i < lane_count; ++i) {
        if ((reached >> i & 1u) == 0 || !(seen.weight[i] > 0.0f)) continue;
        lit = lit || seen.share(i) > 0;
        dark = dark || seen.share(i) < 1;
        together += std::max(seen.count(i), least_count);
    }
    const bool agree = !lit || !dark;
    for (int i = 0; i < lane_count; ++i) {
        if ((reached >> i & 1u) == 0) continue;
        const float n = counts_[i] = std::max(agree ? together : std::max(seen.count(i), least_count), 2.0f);
        const float inside = std::clamp(seen.share(i), 1 / n, 1 - 1 / n);
        errors_[i] += luminance[i] * 0.6f * strata_error(n) * std::sqrt(inside * (1 - inside));
    }
}

/// Of these lanes, which took `count` samples each: those whose light may still be off by too much.
std::uint32_t LampGatherer::too_rough(std::uint32_t reached, int count) {
    for (int i = 0; i < lane_count; ++i)
        if ((reached >> i & 1u) != 0) errors_[i] = 0;
    if (by_lobe_ != 0) add_errors(traced_.lobe, lobe_, reached & by_lobe_, 1);
    add_errors(traced_.lamp, diffuse_, reached, static_cast<float>(count));
    std::uint32_t lanes = 0;
    for (int i = 0; i < lane_count; ++i) {
        if ((reached >> i & 1u) == 0) continue;
        const float light = traced_.lamp.share(i) * diffuse_[i] + lobe_share(i) * lobe_[i];
        lanes |= is_too_rough(i, light) ? 1u << i : 0u;
    }
    return lanes;
}

/// Whether a lane's light may be off by more than a part of its tolerance; or, where that is a price, has fewer samples
/// than it is worth.
bool LampGatherer::is_too_rough(int lane, float light) const {
    const GroupTolerance& t = *accuracy_.tolerance;
    if (!(t.allocation.typical > 0.0f)) return errors_[lane] > part_of_tolerance * allowed(lane, light);
    const float tolerance = allowed(lane, light, t.noise[lane]) / core::errors_of_noise;
    return counts_[lane] < t.allocation.worth(samples_for(tolerance * tolerance, counts_[lane],
                                                          errors_[lane] * errors_[lane], strata_power));
}

/// Traces as many samples of the lanes as their tolerances ask for.
void LampGatherer::trace_as_needed() {
    std::uint32_t asked = asked_;
    const std::size_t first = accuracy_.tolerance->allocation.typical > 0.0f ? 0 : first_of_bounds;
    for (std::size_t s = first; s < steps.size() && asked != 0; ++s) {
        trace(asked, s == first ? 0 : steps[s - 1], steps[s]);
        if (steps[s] >= least_told) tells_ |= asked;
        asked = too_rough(asked, steps[s]);
    }
}

/// Samples lobes more finely, without rays, until their visible light is known well enough.
void LampGatherer::refine_lobes() {
    if (!lobes_) return;
    alignas(64) Lanes of_lobe{};
    for (bool more = true; more;) {
        more = false;
        for (int i = 0; i < lane_count; ++i) {
            if ((reached_ >> i & 1u) == 0) continue;
            const float share = lobe_share(i), light = traced_.lamp.share(i) * diffuse_[i] + share * lobe_[i];
            of_lobe[i] = share * lobes_->error()[i];
            more = more || of_lobe[i] > part_of_lobes * allowed(i, light);
        }
        more = more && lobes_->refine();
    }
    for (int i = 0; i < lane_count; ++i) errors_[i] = std::hypot(errors_[i], of_lobe[i]);
}

/// Visible share of a lobe; that of irradiance, where the lobe's own is not known.
float LampGatherer::lobe_share(int lane) const {
    const bool known = (by_lobe_ >> lane & 1u) != 0 && traced_.lobe.weight[lane] > 0.0f;
    return known ? traced_.lobe.share(lane) : traced_.lamp.share(lane);
}

void LampGatherer::store(LampLight& out) const {
    std::copy(std::begin(errors_), std::end(errors_), std::begin(out.error));
    for (int i = 0; i < lane_count; ++i) {
        if ((reached_ >> i & 1u) == 0) continue;
        const float share = traced_.lamp.share(i);
        out.unit.diffuse[i] = share * (lobes_ ? lobes_->unit().diffuse[i] : whole_[i]);
        for (int c = 0; translucent_ && c < 3; ++c)
            out.tint.passes[i][c] = core::divide_or(traced_.passed[c][i], traced_.lamp.seen[i], 1.0f);
        if (!lobes_) continue;
        out.unit.f0[i] = lobe_share(i) * lobes_->unit().f0[i];
        out.unit.schlick[i] = lobe_share(i) * lobes_->unit().schlick[i];
    }
}

}  // namespace

void gather_lamp(const AreaLamp& lamp, const GatherLanes& lanes, bool translucent, const LampAccuracy& accuracy,
                 ShadowTester& shadows, LampLight& out) {
    LampGatherer(lamp, lanes, translucent, accuracy, shadows).gather(out);
}

}  // namespace render2mpeg::renderer
