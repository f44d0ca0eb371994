#include "app/options/effort.h"

#include <fmt/format.h>

#include <algorithm>

#include "app/options/option_text.h"
#include "app/options/output_kind.h"
#include "app/options/usage_error.h"
#include "perceptual/tolerance.h"

namespace render2mpeg::app {
namespace {

[[noreturn]] void refuse_preview(const std::string& option, const std::string& why) {
    throw UsageError(option + ": with --preview " + why);
}

}  // namespace

const Effort& effort_from(const std::string& name) {
    const auto found =
        std::find_if(efforts.begin(), efforts.end(), [&](const Effort& effort) { return name == effort.name; });
    if (found == efforts.end()) throw UsageError("--effort " + name + ": expected draft, low, default or high");
    return *found;
}

RenderOptions with_effort(const RenderOptions& options) {
    if (!options.effort || *options.effort == "default") return options;
    RenderOptions changed = options;
    if (*options.effort == "draft") {
        changed.preview = true;
        return changed;
    }
    const Effort& effort = effort_from(*options.effort);
    const bool coded = options.output.empty() || kind_of(options.output) == OutputKind::film;
    if (!options.tolerance)
        changed.tolerance = coded
                                ? fmt::format("coupled={:g}", effort.fraction * perceptual::default_tolerance_fraction)
                                : fmt::format("fixed={:g}%", 100 * effort.fixed);
    if (options.is_given("--samples") || options.edge_samples) return changed;
    changed.samples = effort.samples;
    changed.edge_samples = effort.edge_samples;
    return changed;
}

RenderOptions preview_options(const RenderOptions& options) {
    RenderOptions draft = options;
    if (options.tolerance) {
        const ToleranceRequest tolerance = tolerance_from(*options.tolerance);
        if (tolerance.coupled || tolerance.reference)
            refuse_preview("--tolerance " + *options.tolerance,
                           "light is rough; choose fixed=P%, or leave --preview out");
    }
    if (options.audit > 0) refuse_preview("--audit", "no tolerance is kept that could be audited");
    if (options.layers) refuse_preview("--aov", "there are no layers");
    if (options.cache == "on") refuse_preview("--cache on", "light is carried by pixels, not kept on surfaces");
    for (const auto& [subject, file] : options.heatmaps)
        if (subject != "quantiser") refuse_preview("--heatmap " + subject, "only `quantiser` is known");

    // fit: docs/measurements.md#drafts, by PSNR for CPU time.
    if (!options.tolerance) draft.tolerance = "fixed=30%";
    if (!options.is_given("--samples")) draft.samples = 1;
    if (!options.is_given("--edge-samples")) draft.edge_samples = options.is_given("--samples") ? options.samples : 4;
    if (!options.is_given("--vpls")) draft.vpls = 2048;
    draft.indirect = "lightcuts";
    draft.cache = "off";

    // A draft only must be there soon.
    if (!options.is_given("--encoder")) draft.coding.encoder = "fast";
    if (!options.coding.b_pictures) draft.coding.b_pictures = 0;
    const bool has_rate =
        options.coding.quantiser || options.coding.crf || options.coding.quality || options.coding.bitrate;
    if (!has_rate) draft.coding.quantiser = 6;
    if (options.coding.bitrate && !options.coding.passes) draft.coding.passes = 1;
    return draft;
}

}  // namespace render2mpeg::app
