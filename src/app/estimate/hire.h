#pragma once
// Time and money of a film on machines that may be had.
#include <optional>
#include <string>
#include <vector>

#include "app/estimate/forecast.h"
#include "app/job/render_job.h"
#include "app/options/options.h"

namespace render2mpeg::app {

/// Threads for each chunk. chosen: 4 of 4 and 16: a frame of 320x180 is lit 3.3 to 3.8 times as fast by 4 threads, by
/// 16 7.5 to 12 times (docs/measurements.md#many-cores), and a further chunk takes little memory.
inline constexpr int threads_of_chunk = 4;

/// "12.3 core-hours, 0.49": without an amount where no price is known, as that of a core-hour or a machine of so many
/// cores.
std::string cost_text(const std::optional<Price>& price, int cores, double core_hours);

/// How many times as fast one chunk is made by so many threads.
double speed_up(int threads);

/// Seconds from the first part to the last, where each goes to the first machine that is free, longest first.
double farm_seconds(std::vector<double> parts, int machines);

/// Lines that tell hours, cost and the longest part, for one machine and for all; empty where nothing was asked.
std::string hire_text(const RenderJob& film, const Forecast& forecast, const Hire& hire, bool quiet);

}  // namespace render2mpeg::app
