#include "app/options/effort.h"

#include <fmt/format.h>

#include <algorithm>

#include "app/options/output_kind.h"
#include "app/options/usage_error.h"
#include "perceptual/tolerance_fraction.h"

namespace render2mpeg::app {

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
    const auto is_given = [&](const char* name) {
        return std::find(options.given.begin(), options.given.end(), name) != options.given.end();
    };
    const bool coded = options.output.empty() || kind_of(options.output) == OutputKind::film;
    if (!options.tolerance)
        changed.tolerance = coded
                                ? fmt::format("coupled={:g}", effort.fraction * perceptual::default_tolerance_fraction)
                                : fmt::format("fixed={:g}%", 100 * effort.fixed);
    if (is_given("--samples") || options.edge_samples) return changed;
    changed.samples = effort.samples;
    changed.edge_samples = effort.edge_samples;
    return changed;
}

}  // namespace render2mpeg::app
