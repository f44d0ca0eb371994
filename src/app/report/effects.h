#pragma once
// Cost of each visible effect of a film.
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/loop/render_job.h"
#include "app/loop/run_statistics.h"

namespace render2mpeg::app {

/// Cost of one visible effect of a film.
struct Effect {
    std::string name;                       ///< "bounced light"
    std::optional<double> seconds;          ///< CPU; none: it is part of another's
    std::optional<std::uint64_t> rays;      ///< of its own kind; shadow rays are direct and bounced light's together
    std::optional<std::uint64_t> clusters;  ///< of lights that were gathered
    std::string note;                       ///< its components, or where its time is counted; may be empty
};

/// Components of the film's light and pictures with their costs, in the order of their making. Effects absent from the
/// film are left out.
std::vector<Effect> effects_of(const RenderJob& film, const RunStatistics& statistics);

}  // namespace render2mpeg::app
