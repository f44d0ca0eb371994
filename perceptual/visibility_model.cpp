#include "perceptual/visibility_model.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/isa_clones.h"
#include "core/sampling.h"

namespace render2mpeg::perceptual {
namespace {

constexpr int macroblock = 16;

int macroblocks(int size) {
    return (size + macroblock - 1) / macroblock;
}

/// How far a map may be brought from one quantiser to another by the ratio of their errors. chosen: no two quantisers
/// are further apart in code values (31 : 1, 63 equal signs against none: 1000); it only keeps nonsense out.
constexpr float largest_ratio = 1024.0f;

/// values *= after / before, all > 0.
RENDER2MPEG_CLONES
void scale_by_ratio(const float* __restrict after, const float* __restrict before, float* __restrict values,
                    std::size_t count) {
    for (std::size_t i = 0; i < count; ++i)
        values[i] *= core::inlined::min(core::inlined::max(after[i] / before[i], 1.0f / largest_ratio), largest_ratio);
}

/// A pixel's tolerance as a share of its luminance, and how much it counts.
struct Vote {
    float fraction, weight;
};

/// One pixel in so many, each at a random place of its stretch: no pattern of a picture, and no width, is met in step.
std::vector<Vote> votes(const core::Plane<float>& tolerances, const PixelLight& light, std::size_t stride) {
    // Shares of next to nothing say nothing of what is brighter. chosen: 16 code values above black, where the least
    // distance, half a code value, is 3 % of the light; next to black it is all of it.
    constexpr float black = 16.0f, dark = 16.0f;
    // chosen: half bounds what is told; the quarter is 0.34 at most at quantiser 24 in daylight. Pixels that may lose
    // more count as half: without them a dark picture's quarter would fall as the quantiser rises.
    constexpr float largest_fraction = 0.5f;
    std::vector<Vote> votes;
    for (std::size_t first = 0; first + stride <= tolerances.size(); first += stride) {
        const std::size_t i = first + static_cast<std::size_t>(core::uniform(0, first) * static_cast<float>(stride));
        const float luminance = light.luminance.values()[i], above = light.luma.values()[i] - black;
        if (!(above >= dark && luminance > 0.0f)) continue;
        // Those that have more to lose count more.
        votes.push_back({std::min(tolerances.values()[i] / luminance, largest_fraction), above});
    }
    return votes;
}

/// The share of its luminance that a quarter of the remembered pixels, by their luma, stay below; 0 where too few say.
float low_fraction(const core::Plane<float>& tolerances, const PixelLight& light) {
    constexpr float quantile = 0.25f;    // chosen: docs/model/tolerance.md, against the median and 2 %
    constexpr std::size_t asked = 4096;  // chosen: a rank right to 0.7 % of the pixels; 1.4 % by 1024
    constexpr std::size_t few = 64;      // chosen: of 64 asked, one must know: a few lamps in the dark speak for none
    const std::size_t stride = std::max<std::size_t>(1, tolerances.size() / asked);
    std::vector<Vote> known = votes(tolerances, light, stride);
    if (known.size() * few < tolerances.size() / stride) return 0.0f;
    std::sort(known.begin(), known.end(), [](const Vote& a, const Vote& b) { return a.fraction < b.fraction; });
    double whole = 0, sum = 0;
    for (const Vote& vote : known) whole += static_cast<double>(vote.weight);
    for (const Vote& vote : known) {
        sum += static_cast<double>(vote.weight);
        if (sum >= static_cast<double>(quantile) * whole) return vote.fraction;
    }
    return 0.0f;
}

/// Tolerances warped to pixels, reduced where a pixel received far less light than its tolerance was computed for.
core::Plane<float> for_light(const MaskedErrors& warped, const core::Plane<float>& luminance) {
    // chosen: half. Light errs by its tolerance: a bound without play would shrink what is remembered from picture to
    // picture, by 6 % in two hundred of them (Feedback.DoesNotDriftInTwoHundredFrames).
    constexpr float far_less = 0.5f;
    core::Plane<float> tolerances(warped.width(), warped.height());
    for (std::size_t i = 0; i < tolerances.size(); ++i) {
        const glm::vec2 masked = warped.values()[i];
        const core::Tolerance t{masked.x, 0.0f, far_less * masked.y};
        tolerances.values()[i] = masked.x > 0.0f ? t.allows(luminance.values()[i]) : no_partner;
    }
    return tolerances;
}

core::Picture difference(const core::Plane<float>& luma, const core::Plane<std::uint8_t>& prediction) {
    core::Picture picture;
    picture.y = core::Plane<std::uint8_t>(luma.width(), luma.height());
    picture.luma = luma;
    for (std::size_t i = 0; i < luma.size(); ++i)
        picture.luma.values()[i] -= static_cast<float>(prediction.values()[i]);
    return picture;
}

}  // namespace

bool CodingPlan::operator==(const CodingPlan& other) const {
    return intra == other.intra && scale == other.scale && quantisation == other.quantisation;
}

VisibilityModel::VisibilityModel(const Display& display, Strategy strategy) : light_(display), strategy_(strategy) {}

Observation VisibilityModel::observe(const core::Picture& picture, const core::Radiance& radiance,
                                     std::shared_ptr<const core::Visible> visible, const MaskedErrors& warped) const {
    EXPECTS(visible != nullptr && visible->width() == picture.width() && visible->height() == picture.height());
    EXPECTS(warped.empty() || (warped.width() == picture.width() && warped.height() == picture.height()));
    Observation observation;
    observation.number = picture.number;
    observation.visible = std::move(visible);
    observation.coefficients = transform(picture);
    observation.thresholds = mask(observation.coefficients, picture.number);
    observation.light = light_.light_of(picture, radiance);
    observation.warped = for_light(warped, observation.light.luminance);
    return observation;
}

TemporalState VisibilityModel::judge(Observation observation, const CodedFacts& coded) const {
    EXPECTS(coded.number == observation.number);
    const int width = observation.light.width(), height = observation.light.height();
    EXPECTS(coded.scale.width() == macroblocks(width) && coded.scale.height() == macroblocks(height));
    EXPECTS(coded.intra.size() == coded.scale.size() && coded.plan.scale > 0.0f);

    TemporalState state;
    state.number = observation.number;
    state.plan = coded.plan;
    state.intra = coded.intra;
    // The residual, quantised in inter macroblocks.
    if (!coded.plan.intra && !coded.prediction.empty()) {
        EXPECTS(coded.prediction.width() == width && coded.prediction.height() == height);
        state.residual = transform(difference(observation.light.luma, coded.prediction));
    }
    // The masking signal: the decoded picture.
    if (strategy_ == Strategy::quantised) {
        EXPECTS(coded.reconstruction.width() == width && coded.reconstruction.height() == height);
        core::Picture decoded;
        decoded.y = coded.reconstruction;
        observation.coefficients = transform(decoded);
        observation.thresholds = mask(observation.coefficients, observation.number);
    }
    state.visible = std::move(observation.visible);
    state.coefficients = std::move(observation.coefficients);
    state.thresholds = std::move(observation.thresholds);
    state.light = std::move(observation.light);
    state.emphasis = coded.scale;
    for (float& scale : state.emphasis.values()) scale /= coded.plan.scale;
    state.errors = errors(state, coded.plan);
    state.tolerances = state.errors;
    // The warped errors are in the units of the planned coding.
    if (!observation.warped.empty())
        requantise(observation.warped, state, coded.lit_for.value_or(coded.plan), coded.plan);
    blend(state.tolerances, observation.warped);
    return state;
}

TemporalState VisibilityModel::assume_coded(Observation observation, const CodingPlan& plan) const {
    TemporalState state;
    state.number = observation.number;
    state.plan = plan;
    state.intra = core::Plane<std::uint8_t>(macroblocks(observation.light.width()),
                                            macroblocks(observation.light.height()), plan.intra ? 1 : 0);
    state.emphasis = core::Plane<float>(state.intra.width(), state.intra.height(), 1.0f);
    state.visible = std::move(observation.visible);
    state.coefficients = std::move(observation.coefficients);
    state.thresholds = std::move(observation.thresholds);
    state.light = std::move(observation.light);
    state.tolerances = state.errors = errors(state, plan);
    return state;
}

core::Plane<float> VisibilityModel::errors(const TemporalState& state, const CodingPlan& plan) const {
    const BlockErrors of_block = [&](int column, int row) {
        BlockCoding coding;
        coding.scale = plan.scale * state.emphasis.at(column / 2, row / 2);
        // In predicted pictures what was intra is expected to be intra again: nothing there was seen before.
        const bool stays_intra = !state.plan.intra && state.intra.at(column / 2, row / 2) != 0;
        coding.intra = plan.intra || stays_intra;
        if (!coding.intra && !state.residual.empty()) coding.residual = &state.residual.at(column, row);
        return worst_errors(state.coefficients.at(column, row), state.thresholds.blocks.at(column, row),
                            plan.quantisation, coding);
    };
    core::Plane<float> plane = distances(state.light.width(), state.light.height(), of_block);
    to_tolerances(plane, state.light, light_);
    return plane;
}

void VisibilityModel::requantise(core::Plane<float>& values, const TemporalState& state, const CodingPlan& from,
                                 const CodingPlan& to) const {
    if (from == to) return;
    const core::Plane<float> told = from == state.plan ? core::Plane<float>() : errors(state, from),
                             wanted = to == state.plan ? core::Plane<float>() : errors(state, to);
    scale_by_ratio((wanted.empty() ? state.errors : wanted).values().data(),
                   (told.empty() ? state.errors : told).values().data(), values.values().data(), values.size());
}

Requantised VisibilityModel::requantise(const TemporalState& state, const CodingPlan& plan) const {
    Requantised requantised;
    requantised.plan = plan;
    core::Plane<float> tolerances = state.tolerances;
    requantise(tolerances, state, state.plan, plan);
    requantised.low_fraction = low_fraction(tolerances, state.light);
    requantised.masked = MaskedErrors(tolerances.width(), tolerances.height());
    for (std::size_t i = 0; i < tolerances.size(); ++i)
        requantised.masked.values()[i] = {tolerances.values()[i], state.light.luminance.values()[i]};
    return requantised;
}

Tolerated VisibilityModel::tolerate(const core::Visible& visible, const CodingPlan& plan, const TemporalState& state,
                                    const core::MotionField* motion, float fraction) const {
    return tolerate(visible, requantise(state, plan), state, motion, fraction);
}

Tolerated VisibilityModel::tolerate(const core::Visible& visible, const Requantised& requantised,
                                    const TemporalState& state, const core::MotionField* motion, float fraction) const {
    EXPECTS(fraction > 0.0f);
    EXPECTS(motion == nullptr || motion->reference == state.number);
    Tolerated tolerated;
    tolerated.warped =
        strategy_ == Strategy::warped ? warp(requantised.masked, *state.visible, visible, motion) : requantised.masked;
    tolerated.map.pixels = core::Plane<core::Tolerance>(visible.width(), visible.height());
    const float darkest = light_.darkest_step();
    // Newly visible pixels hide errors like the rest: with a tolerance of 2 % they would stand out as bands.
    const float unseen = std::max(least_relative, fraction * requantised.low_fraction);
    tolerated.map.typical = unseen;
    const CodingPlan& plan = requantised.plan;
    tolerated.map.means = share_of_mean(plan.quantisation, {plan.scale, plan.intra});
    for (std::size_t i = 0; i < tolerated.warped.size(); ++i) {
        const glm::vec2 masked = tolerated.warped.values()[i];
        core::Tolerance& t = tolerated.map.pixels.values()[i];
        t = {darkest, unseen};
        if (!(masked.x > 0.0f)) continue;
        const float absolute = std::max(fraction * masked.x, darkest);
        // The bound may leave half a code value, if no light: the least that any picture shows.
        t = {absolute, least_relative, std::min(masked.y, absolute * absolute / darkest)};
    }
    return tolerated;
}

}  // namespace render2mpeg::perceptual
