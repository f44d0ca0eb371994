#pragma once
// Steps that `cost`, `tune` and `compare` share.
#include <array>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "app/experiments/trial.h"
#include "app/options/options.h"
#include "app/report/figures.h"
#include "app/system/progress.h"

namespace render2mpeg::app {

/// Options of `render` with their values.
using Choices = std::vector<std::pair<std::string, std::string>>;

/// A way to make the film.
struct Setting {
    std::string name;  ///< "effort low", "fixed=16%"
    Choices choices;   ///< beside what was asked for
    RenderJob film;
};
struct Tried {
    std::string name;  ///< of its setting, as its choices
    Choices choices;
    Trial trial;
};

/// A figure of a trial.
struct TrialColumn {
    std::string_view key;  ///< in JSON
    double (*value)(const Trial&);
    const char* head = "";  ///< in tables; empty: in JSON alone
    int width = 0;          ///< in text
    std::string (*text)(double) = short_figure;
};
/// Keys of those that a table has.
using TrialColumns = std::vector<const char*>;

/// Options of trials that say nothing of the film they are about.
inline constexpr std::array options_of_trials{"--sample",         "--within",   "--tolerances",  "--quantisers",
                                              "--json",           "--report",   "--references",  "--beside",
                                              "--blender",        "--of",       "--target-psnr", "--target-ssim",
                                              "--target-bitrate", "--max-size", "--max-time"};

/// Lines of text, each with its end; the name is left-aligned in `width` columns.
std::string heads_text(const TrialColumns& columns, const std::string& name, int width);
std::string row_text(const TrialColumns& columns, const std::string& name, int width, const Trial& trial);

/// Table of what other programs tell of trials, which of them are missing in a line; empty where they were not asked.
using NamedTrial = std::pair<std::string, const Trial*>;
std::string installed_table(const Trials& trials, int width, const std::vector<NamedTrial>& rows);

/// All figures of a trial by their keys, whatever a table shows; null for non-finite values.
nlohmann::json figures_json(const Trial& trial);

/// Words of the `render` command of the tried film with these options; without -o, it is named after the scene.
std::vector<std::string> render_command(const std::vector<std::string>& words, const std::filesystem::path& input,
                                        encoder::Codec codec, Choices with);

/// Loads and settles the film, its exposure included, prints its notes and refuses outputs that would replace other
/// files; a part of it after an interrupt.
RenderJob prepare_trials(const RenderOptions& render, const TrialOptions& options);

/// Throws core::Error where this number of bytes exceeds `machine`'s.
void check_memory(double bytes, double machine);
void check_memory(double bytes);

/// Says that nothing was found out. Returns the exit status.
int interrupted_before_rows(bool quiet);

/// Lights the references with a progress line. Returns false after an interruption.
bool light_references(Trials& trials, bool quiet);

/// Finds the truth of some of their pixels, with one as well.
void find_truth(Trials& trials, bool quiet);
/// How PSNR-Y is held against it; empty where it is not known.
std::string truth_text(const std::optional<PathTruth>& truth);

/// Lights and codes the windows with a progress line. None after an interruption.
std::optional<Tried> run_trial(Trials& trials, const Setting& setting, bool quiet, LitWindows* keep = nullptr);

/// Calls `work` with its elapsed time on a terminal.
template <class Work>
auto told(const std::string& name, bool quiet, Work&& work) {
    const Progress progress(1, quiet || !shows_steps(), name, Counted::parts_of_step);
    return work();
}

RenderJob with_tolerance(RenderJob film, const ToleranceRequest& tolerance);

/// "film: 3 frames of 320x180 in 1 window; 1 by ... as reference, 2 s of CPU each"
std::string trial_heading(const Trials& trials);

void print_sentence(const std::string& text);

/// A page about results. `title` follows the film's name.
struct TrialPage {
    std::string kind, title, lead;
    nlohmann::json more;  ///< what it shows beside the figures
};
/// Writes what the command of these `words` has `found`, and what all commands know, where that is asked for.
void write_results(const TrialOptions& options, const Trials& trials, const std::vector<std::string>& words,
                   const nlohmann::json& found, const std::function<TrialPage()>& page);

/// A trial's last reference frame: decoded beside the reference, tolerances and errors. Empty without references.
nlohmann::json sample_frame_figures(const std::string& name, const Trial& trial, const RenderJob& film);

}  // namespace render2mpeg::app
