#pragma once
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/experiments/trial.h"
#include "app/options/options.h"
#include "app/system/progress.h"

namespace render2mpeg::app {

void require_trial_consent(const TrialOptions& options);

/// The `render` command of the tried film with these options; without -o, the film is named after the scene.
std::string render_command(const std::vector<std::string>& words, const std::filesystem::path& input,
                           encoder::Codec codec, std::vector<std::pair<std::string, std::string>> with);

/// Refuses outputs that would replace other files, or cannot be written.
void check_trial_outputs(const RenderJob& film, const TrialOptions& options);

/// Loads and settles the film, its exposure included, and prints its notes; a part of it after an interrupt.
RenderJob prepare_trials(const RenderOptions& options);

/// Note about so many bytes of memory; empty for few. Throws core::Error where they exceed `machine`.
std::string memory_note(double bytes, double machine);
void print_memory_note(double bytes, bool quiet);

/// Lights the references with a progress line. Returns whether nobody interrupted.
bool light_references(Trials& trials, bool quiet);

/// Lights and codes the windows with a progress line. None after an interruption.
std::optional<Trial> run_trial(Trials& trials, const ToleranceRequest& tolerance, const Coarseness& coarseness,
                               const std::string& name, bool quiet, LitWindows* keep = nullptr);

/// Calls `work` with its elapsed time on a terminal.
template <class Work>
auto told(const std::string& name, bool quiet, Work&& work) {
    const Progress progress(1, quiet || !shows_steps(), name, Counted::parts_of_step);
    return work();
}

void print_sentence(const std::string& text);

/// Keys of a file's head: command, film, sample and references.
nlohmann::json trial_json(const RenderJob& film, const std::string& command, const std::vector<Chunk>& windows,
                          int references, double reference_seconds);
nlohmann::json light_json(const RenderJob& film);
nlohmann::json quality_json(double psnr_y, double ssim_y);

/// A trial's last reference frame: decoded beside the truth, tolerances and errors. Empty without a truth.
std::string sample_frame_figures(const std::string& name, const Trial& trial, const RenderJob& film);

/// The decoded reference frames of two trials side by side. Empty where either has none.
std::string decoded_pair(const std::string& title, const std::string& name, const Trial& trial,
                         const std::string& other_name, const Trial& other, const RenderJob& film);

/// Writes a page and its figures. `title` follows the film's name; `guide` is the document about both.
void write_trial_page(const std::filesystem::path& html, const RenderJob& film, const std::string& title,
                      const std::string& lead, const std::string& body, const std::string& command,
                      const std::string& guide, const nlohmann::json& figures);

}  // namespace render2mpeg::app
