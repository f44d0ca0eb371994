#pragma once
// How many light points a film needs, so that their error stays within what it may lose.
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "app/loop/render_job.h"

namespace render2mpeg::app {

/// Whether the film's light points are chosen by what it may lose: `loss` is set, nobody says how many, light bounces,
/// and the film is so long that measuring takes little of its time.
bool has_budget(const RenderJob& film);

/// Measures three small frames of the film, whose exposure is known. Takes seconds, and shows how far it is. A function
/// of the film alone; none where it was interrupted.
std::optional<LightBudget> measure_light(const RenderJob& film, bool quiet);

/// The most light points that it may find.
int most_light_points(const RenderJob& film);

/// For statistics, and for runs that go on; none for what is no budget.
nlohmann::json json_of(const LightBudget& budget);
std::optional<LightBudget> budget_from(const nlohmann::json& written);

/// What was found, for the plan's table.
std::string text_of(const LightBudget& budget);

/// Sets the film's light points.
void spend(RenderJob& film, const LightBudget& budget);

}  // namespace render2mpeg::app
