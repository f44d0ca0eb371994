#include "renderer/cut/lamp_lobe.h"

#include <algorithm>
#include <cmath>

#include "core/numeric.h"
#include "renderer/base/isa_clones.h"
#include "renderer/base/lobe.h"
#include "renderer/tree/lane_sums.h"

namespace render2mpeg::renderer {
namespace {

/// Density of a direction along the lobe over D of its half vector: G1 / (4 n.v).
RENDER2MPEG_ALWAYS_INLINED float density_over_d(float nv, float a2) {
    return 0.5f / (nv + inlined::sqrt(a2 + (1.0f - a2) * nv * nv));
}

RENDER2MPEG_ALWAYS_INLINED float stretched_at(const GatherLanes& lanes, const LampSamples& samples, int i,
                                              float half2) {
    const lobe::StretchedCosines light{dot(lanes.along, samples.direction, i), dot(lanes.across, samples.direction, i),
                                       dot(lanes.normal.axis, samples.direction, i)};
    return lobe::stretched_value(light, {lanes.view_along[i], lanes.view_across[i], lanes.cos_outgoing[i]}, half2,
                                 lanes.along2[i], lanes.across2[i]);
}

RENDER2MPEG_ALWAYS_INLINED float shape_at(const GatherLanes& lanes, int i, float nl, float lv) {
    return lobe::shaped(lanes.retro[i], lanes.loss[i], lanes.flat[i], lanes.rough[i], nl, lanes.cos_outgoing[i], lv);
}

}  // namespace

RENDER2MPEG_CLONES
void respond(const GatherLanes& __restrict lanes, const LampSamples& __restrict samples, const Lanes& peaks,
             LampResponse& __restrict out) {
    if (!lanes.glossy) {
        for (int i = 0; i < lane_count; ++i)
            out.plain[i] =
                inlined::max(dot(lanes.normal.axis, samples.direction, i), 0.0f) * samples.inverse_density[i];
        return;
    }
    for (int i = 0; i < lane_count; ++i) {
        const float nl = inlined::max(dot(lanes.normal.axis, samples.direction, i), 0.0f);
        const float nv = lanes.cos_outgoing[i], a2 = lanes.lobe_width[i];
        const float lv = dot(lanes.outgoing.axis, samples.direction, i);
        const float half2 = inlined::max(2.0f + 2.0f * lv, 1e-7f);
        const float nh2 = inlined::min((nl + nv) * (nl + nv) / half2, 1.0f);
        const float s = lobe::schlick(inlined::sqrt(inlined::max(0.5f * (1.0f + lv), 0.0f)));
        const float d = lobe::distribution(nh2, a2), inverse = samples.inverse_density[i];
        const float along = nl > 0.0f ? d * density_over_d(nv, a2) * inverse : 0.0f;
        const float share = 1.0f / (1.0f + (peaks[i] > 0.0f ? along : 0.0f)), weight = nl * inverse * share;
        const float f =
            (lanes.stretched ? stretched_at(lanes, samples, i, half2) : d * lobe::masking(nl, nv, a2)) * weight;
        out.plain[i] = nl * inverse;
        out.geometry[i] = weight;
        out.diffuse[i] = weight * (1.0f - lanes.coat[i] * s) * (lanes.stretched ? shape_at(lanes, i, nl, lv) : 1.0f);
        out.f0[i] = f * (1.0f - s);
        out.schlick[i] = f * s;
    }
}

void share_among_lanes(Lanes& values) {
    alignas(64) Lanes all;
    std::copy(std::begin(values), std::end(values), std::begin(all));
    std::fill(std::begin(values), std::end(values), sum_of(all) / lane_count);
}

LobeIntegral::LobeIntegral(const AreaLamp& lamp, const GatherLanes& lanes, const LampSampler& sampler,
                           const Lanes& whole)
    : lamp_(lamp), lanes_(lanes), sampler_(sampler), whole_(whole) {
    choose_lobes();
    constexpr int quarter = first_samples / 4;
    for (int q = 0; q < 4; ++q) take(q, q * quarter, (q + 1) * quarter);
    count_ = first_samples;
    estimate();
}

/// Lobes whose peak is denser than the sparsest of a few samples of the lamp are narrower than it.
void LobeIntegral::choose_lobes() {
    constexpr int looked_at = 4;
    std::fill(std::begin(peaks_), std::end(peaks_), 0.0f);
    alignas(64) Lanes sparsest{};
    LampSamples samples;
    for (int k = 0; k < looked_at; ++k) {
        sampler_.take(k, samples);
        for (int i = 0; i < lane_count; ++i) sparsest[i] = std::max(sparsest[i], samples.inverse_density[i]);
    }
    for (int i = 0; i < lanes_.count; ++i) {
        if (lanes_.lobed[i] == 0.0f) continue;
        const float a2 = lanes_.lobe_width[i];
        const float peak = lobe::distribution(1.0f, a2) * density_over_d(lanes_.cos_outgoing[i], a2);
        if (!(peak * sparsest[i] > 1.0f)) continue;
        peaks_[i] = peak;
        along_lobes_ = true;
    }
}

void LobeIntegral::add(const LampResponse& response, int quarter) {
    LampResponse& sum = quarters_[quarter];
    for (int i = 0; i < lane_count; ++i) {
        sum.geometry[i] += response.geometry[i];
        sum.diffuse[i] += response.diffuse[i];
        sum.f0[i] += response.f0[i];
        sum.schlick[i] += response.schlick[i];
    }
}

/// Sets a quarter to these samples.
void LobeIntegral::take(int quarter, int first, int end) {
    quarters_[quarter] = {};
    LampSamples samples;
    LampResponse response;
    for (int k = first; k < end; ++k) {
        sampler_.take(k, samples);
        respond(lanes_, samples, peaks_, response);
        add(response, quarter);
        if (!along_lobes_) continue;
        sampler_.take_lobe(k, samples);
        for (int i = 0; i < lane_count; ++i)
            if (!(peaks_[i] > 0.0f)) samples.inverse_density[i] = 0;
        respond(lanes_, samples, peaks_, response);
        add(response, quarter);
    }
}

bool LobeIntegral::refine() {
    if (count_ >= most_lamp_samples) return false;
    const LampResponse known[3] = {quarters_[1], quarters_[2], quarters_[3]};
    for (const LampResponse& k : known) add(k, 0);
    for (int q = 1; q < 4; ++q) take(q, q * count_, (q + 1) * count_);
    count_ *= 4;
    estimate();
    return true;
}

void LobeIntegral::share_samples() {
    for (LampResponse& q : quarters_)
        for (Lanes* sum : {&q.geometry, &q.diffuse, &q.f0, &q.schlick}) share_among_lanes(*sum);
    estimate();
}

/// Scaled to the irradiance, which is known in closed form, where the samples are the lamp's alone: both err alike.
void LobeIntegral::unit_of(const LampResponse& sum, float samples, LightLanes& out) const {
    for (int i = 0; i < lane_count; ++i) {
        const float by_form = core::divide_or(whole_[i], sum.geometry[i], 0.0f);
        const float scale = peaks_[i] > 0.0f ? 1.0f / samples : by_form;
        out.diffuse[i] = by_form * sum.diffuse[i];
        out.f0[i] = scale * sum.f0[i];
        out.schlick[i] = scale * sum.schlick[i];
    }
}

void LobeIntegral::estimate() {
    LampResponse all = quarters_[0];
    alignas(64) Lanes luminance[4] = {};
    for (int q = 0; q < 4; ++q) {
        LightLanes of_quarter;
        unit_of(quarters_[q], 0.25f * static_cast<float>(count_), of_quarter);
        add_luminance(lanes_, unit_light(lanes_, of_quarter), lamp_.radiance, luminance[q]);
        for (int i = 0; q > 0 && i < lane_count; ++i) {
            all.geometry[i] += quarters_[q].geometry[i];
            all.diffuse[i] += quarters_[q].diffuse[i];
            all.f0[i] += quarters_[q].f0[i];
            all.schlick[i] += quarters_[q].schlick[i];
        }
    }
    unit_of(all, static_cast<float>(count_), unit_);
    unit_.any_clamped = false;
    for (int i = 0; i < lane_count; ++i) {
        float mean = 0, squares = 0;
        for (const Lanes& l : luminance) mean += 0.25f * l[i];
        for (const Lanes& l : luminance) squares += (l[i] - mean) * (l[i] - mean);
        error_[i] = std::sqrt(squares / 12);  // of a mean of four
    }
}

}  // namespace render2mpeg::renderer
