#pragma once
// What each thing that is seen in a film has cost.
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/loop/render_job.h"
#include "app/loop/run_statistics.h"

namespace render2mpeg::app {

/// What one thing that is seen in a film has cost.
struct Effect {
    std::string name;                       ///< "bounced light"
    std::optional<double> seconds;          ///< CPU; none: it is part of another's
    std::optional<std::uint64_t> rays;      ///< of its own kind; shadow rays are direct and bounced light's together
    std::optional<std::uint64_t> clusters;  ///< of lights that were gathered
    std::string note;                       ///< what it consists of, or where its time is; may be empty
};

/// What the film's light and pictures consist of, and what each took, in the order of their making; what the film does
/// not have is left out.
std::vector<Effect> effects_of(const RenderJob& film, const RunStatistics& statistics);

}  // namespace render2mpeg::app
