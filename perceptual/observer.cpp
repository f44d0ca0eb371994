#include "perceptual/observer.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/isa_clones.h"
#include "core/sampling.h"
#include "perceptual/carry.h"
#include "perceptual/masking.h"

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
    float share, weight;
};

/// One pixel in so many, each at a random place of its stretch: no pattern of a picture, and no width, is met in step.
std::vector<Vote> votes(const core::Plane<float>& tolerances, const PixelLight& light, std::size_t stride) {
    // Shares of next to nothing say nothing of what is brighter. chosen: 16 code values above black, where the least
    // distance, half a code value, is 3 % of the light; next to black it is all of it.
    constexpr float black = 16.0f, dark = 16.0f;
    // chosen: half, which bounds what is told, too; the quarter is 0.34 at most at quantiser 24 in daylight.
    constexpr float largest_share = 0.5f;
    std::vector<Vote> votes;
    for (std::size_t first = 0; first + stride <= tolerances.size(); first += stride) {
        const std::size_t i = first + static_cast<std::size_t>(core::uniform(0, first) * static_cast<float>(stride));
        const float luminance = light.luminance.values()[i], above = light.luma.values()[i] - black;
        if (!(above >= dark && luminance > 0.0f)) continue;
        // Those that have more to lose count more.
        const float share = tolerances.values()[i] / luminance;
        if (share < largest_share) votes.push_back({share, above});
    }
    return votes;
}

/// The share of its luminance that a quarter of the remembered pixels, by their luma, stay below; 0 where too few say.
float low_share(const core::Plane<float>& tolerances, const PixelLight& light) {
    constexpr float quantile = 0.25f;    // chosen: docs/model/tolerance.md, against the median and 2 %
    constexpr std::size_t asked = 4096;  // chosen: a rank right to 0.7 % of the pixels; 1.4 % by 1024
    constexpr std::size_t few = 64;      // chosen: of 64 asked, one must know: a few lamps in the dark speak for none
    const std::size_t stride = std::max<std::size_t>(1, tolerances.size() / asked);
    std::vector<Vote> known = votes(tolerances, light, stride);
    if (known.size() * few < tolerances.size() / stride) return 0.0f;
    std::sort(known.begin(), known.end(), [](const Vote& a, const Vote& b) { return a.share < b.share; });
    double whole = 0, sum = 0;
    for (const Vote& vote : known) whole += static_cast<double>(vote.weight);
    for (const Vote& vote : known) {
        sum += static_cast<double>(vote.weight);
        if (sum >= static_cast<double>(quantile) * whole) return vote.share;
    }
    return 0.0f;
}

/// What was carried to pixels, less where they turned out to get far less light than it was told for.
core::Plane<float> for_light(const Hidden& carried, const core::Plane<float>& luminance) {
    // chosen: half. Light errs by its tolerance: a bound without play would shrink what is remembered from picture to
    // picture, by 6 % in two hundred of them (Feedback.DoesNotDriftInTwoHundredFrames).
    constexpr float far_less = 0.5f;
    core::Plane<float> tolerances(carried.width(), carried.height());
    for (std::size_t i = 0; i < tolerances.size(); ++i) {
        const glm::vec2 hidden = carried.values()[i];
        const core::Tolerance t{hidden.x, 0.0f, far_less * hidden.y};
        tolerances.values()[i] = hidden.x > 0.0f ? t.allows(luminance.values()[i]) : no_partner;
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
    return intra == other.intra && scale == other.scale && quantisation.intra == other.quantisation.intra &&
           quantisation.inter == other.quantisation.inter && quantisation.dc_step == other.quantisation.dc_step;
}

Observer::Observer(const Display& display, const ObserverSettings& settings) : light_(display), settings_(settings) {}

Observation Observer::observe(const core::Picture& picture, const core::Radiance& radiance,
                              std::shared_ptr<const core::Visible> visible, const Hidden& carried) const {
    EXPECTS(visible != nullptr && visible->width() == picture.width() && visible->height() == picture.height());
    EXPECTS(carried.empty() || (carried.width() == picture.width() && carried.height() == picture.height()));
    Observation observation;
    observation.number = picture.number;
    observation.visible = std::move(visible);
    observation.coefficients = transform(picture);
    observation.thresholds = mask(observation.coefficients, picture.number);
    observation.light = light_.light_of(picture, radiance);
    observation.carried = for_light(carried, observation.light.luminance);
    return observation;
}

Memory Observer::judge(Observation observation, const CodedFacts& coded) const {
    EXPECTS(coded.number == observation.number);
    const int width = observation.light.width(), height = observation.light.height();
    EXPECTS(coded.scale.width() == macroblocks(width) && coded.scale.height() == macroblocks(height));
    EXPECTS(coded.intra.size() == coded.scale.size() && coded.plan.scale > 0.0f);

    Memory memory;
    memory.number = observation.number;
    memory.plan = coded.plan;
    memory.intra = coded.intra;
    // What inter macroblocks quantise.
    if (!coded.plan.intra && !coded.prediction.empty()) {
        EXPECTS(coded.prediction.width() == width && coded.prediction.height() == height);
        memory.residual = transform(difference(observation.light.luma, coded.prediction));
    }
    // What masks.
    if (settings_.strategy == Strategy::quantised) {
        EXPECTS(coded.reconstruction.width() == width && coded.reconstruction.height() == height);
        core::Picture decoded;
        decoded.y = coded.reconstruction;
        observation.coefficients = transform(decoded);
        observation.thresholds = mask(observation.coefficients, observation.number);
    }
    memory.visible = std::move(observation.visible);
    if (settings_.strategy == Strategy::carried) memory.quads = quads_of(*memory.visible);
    memory.coefficients = std::move(observation.coefficients);
    memory.thresholds = std::move(observation.thresholds);
    memory.light = std::move(observation.light);
    memory.emphasis = coded.scale;
    for (float& scale : memory.emphasis.values()) scale /= coded.plan.scale;
    memory.errors = errors(memory, coded.plan);
    memory.tolerances = memory.errors;
    // What was carried here is in the measure of what was planned.
    if (!observation.carried.empty())
        restate(observation.carried, memory, coded.lit_for.value_or(coded.plan), coded.plan);
    blend(memory.tolerances, observation.carried);
    return memory;
}

Memory Observer::presume(Observation observation, const CodingPlan& plan) const {
    Memory memory;
    memory.number = observation.number;
    memory.plan = plan;
    memory.intra = core::Plane<std::uint8_t>(macroblocks(observation.light.width()),
                                             macroblocks(observation.light.height()), plan.intra ? 1 : 0);
    memory.emphasis = core::Plane<float>(memory.intra.width(), memory.intra.height(), 1.0f);
    memory.visible = std::move(observation.visible);
    if (settings_.strategy == Strategy::carried) memory.quads = quads_of(*memory.visible);
    memory.coefficients = std::move(observation.coefficients);
    memory.thresholds = std::move(observation.thresholds);
    memory.light = std::move(observation.light);
    memory.tolerances = memory.errors = errors(memory, plan);
    return memory;
}

core::Plane<float> Observer::errors(const Memory& memory, const CodingPlan& plan) const {
    const BlockErrors of_block = [&](int column, int row) {
        BlockCoding coding;
        coding.scale = plan.scale * memory.emphasis.at(column / 2, row / 2);
        // In predicted pictures what was intra is expected to be intra again: nothing there was seen before.
        const bool stays_intra = !memory.plan.intra && memory.intra.at(column / 2, row / 2) != 0;
        coding.intra = plan.intra || stays_intra;
        if (!coding.intra && !memory.residual.empty()) coding.residual = &memory.residual.at(column, row);
        return worst_errors(memory.coefficients.at(column, row), memory.thresholds.blocks.at(column, row),
                            plan.quantisation, coding);
    };
    core::Plane<float> plane = distances(memory.light.width(), memory.light.height(), settings_.spread, of_block);
    to_tolerances(plane, memory.light, light_);
    return plane;
}

void Observer::restate(core::Plane<float>& values, const Memory& memory, const CodingPlan& from,
                       const CodingPlan& to) const {
    if (from == to) return;
    const core::Plane<float> told = from == memory.plan ? core::Plane<float>() : errors(memory, from),
                             wanted = to == memory.plan ? core::Plane<float>() : errors(memory, to);
    scale_by_ratio((wanted.empty() ? memory.errors : wanted).values().data(),
                   (told.empty() ? memory.errors : told).values().data(), values.values().data(), values.size());
}

Restated Observer::restate(const Memory& memory, const CodingPlan& plan) const {
    Restated restated;
    restated.plan = plan;
    core::Plane<float> tolerances = memory.tolerances;
    restate(tolerances, memory, memory.plan, plan);
    restated.low_share = low_share(tolerances, memory.light);
    restated.hidden = Hidden(tolerances.width(), tolerances.height());
    for (std::size_t i = 0; i < tolerances.size(); ++i)
        restated.hidden.values()[i] = {tolerances.values()[i], memory.light.luminance.values()[i]};
    return restated;
}

Tolerated Observer::tolerate(const core::Visible& visible, const CodingPlan& plan, const Memory& memory,
                             const core::MotionField* motion, float share) const {
    return tolerate(visible, restate(memory, plan), memory, motion, share);
}

Tolerated Observer::tolerate(const core::Visible& visible, const Restated& restated, const Memory& memory,
                             const core::MotionField* motion, float share) const {
    EXPECTS(share > 0.0f);
    EXPECTS(motion == nullptr || motion->reference == memory.number);
    Tolerated tolerated;
    tolerated.carried = settings_.strategy == Strategy::carried
                            ? carry(restated.hidden, *memory.visible, memory.quads, visible, motion)
                            : restated.hidden;
    tolerated.map.pixels = core::Plane<core::Tolerance>(visible.width(), visible.height());
    const float darkest = light_.darkest_step();
    // What nobody saw before is as likely to hide errors as the rest: held to 2 % it would stand out as bands.
    const float unseen = std::max(least_relative, share * restated.low_share);
    for (std::size_t i = 0; i < tolerated.carried.size(); ++i) {
        const glm::vec2 hidden = tolerated.carried.values()[i];
        core::Tolerance& t = tolerated.map.pixels.values()[i];
        t = {darkest, unseen};
        if (!(hidden.x > 0.0f)) continue;
        const float absolute = std::max(share * hidden.x, darkest);
        // The bound may leave half a code value, if no light: the least that any picture shows.
        t = {absolute, least_relative, std::min(hidden.y, absolute * absolute / darkest)};
    }
    return tolerated;
}

}  // namespace render2mpeg::perceptual
