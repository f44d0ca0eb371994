#pragma once
#include <functional>
#include <string>
#include <vector>

#include "app/loop/run_statistics.h"
#include "app/options/options.h"

namespace render2mpeg::app {

/// `compare`: this program against rendering first and encoding with ffmpeg (docs/choosing.md). Exit status: 0, or 130
/// after an interruption with a part of the table. Throws core::Error, also without ffmpeg.
int compare(const TrialOptions& options, const std::vector<std::string>& words);

/// `cost`: lights and codes a sample of a film with several tolerances (docs/choosing.md). Exit status likewise.
int cost(const TrialOptions& options, const std::vector<std::string>& words);

/// Makes a film as `render` does, and fills in the result. Returns the exit status.
using RenderFilm = std::function<int(const RenderOptions& options, const std::string& command, Rendered* rendered)>;

/// `tune`: finds the setting that reaches a quality, rate, size or time on a sample, then makes the film with
/// `render_film` (docs/choosing.md). Exit status: 0; 1 where the target is missed; 130 after an interruption.
int tune(const TrialOptions& options, const std::vector<std::string>& words, const RenderFilm& render_film);

}  // namespace render2mpeg::app
