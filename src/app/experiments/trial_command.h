#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/experiments/trial.h"
#include "app/options/options.h"
#include "app/system/progress.h"

/// What commands that try films have in common.
namespace render2mpeg::app {

/// Refuses to replace a film or make a folder without a word (require_consent).
void require_trial_consent(const TrialOptions& options);

/// The command that renders the film which `words` try, with these options in place of theirs; without one, `-o` names
/// the film after the scene.
std::string render_command(const std::vector<std::string>& words, const std::filesystem::path& input,
                           encoder::Codec codec, std::vector<std::pair<std::string, std::string>> with);

/// Refuses outputs that would take the place of other files, and such as cannot be written.
void check_trial_outputs(const RenderJob& film, const TrialOptions& options);

/// Reads and settles everything, the exposure included; prints the scene's notes. Not all of it where an interrupt was
/// requested meanwhile.
RenderJob prepare_trials(const RenderOptions& options);

/// What to say of so many bytes of memory before any work: nothing where any machine has them. Throws core::Error where
/// they are more than `machine` has.
std::string memory_note(double bytes, double machine);
/// Prints it, of this machine.
void print_memory_note(double bytes, bool quiet);

/// Lights the references and prints how far that is. Returns whether nobody interrupted.
bool light_references(Trials& trials, bool quiet);

/// Lights and codes the windows, and prints how far that is on a terminal: a log has the rows themselves. None where
/// somebody interrupted.
std::optional<Trial> run_trial(Trials& trials, const ToleranceRequest& tolerance, const Coarseness& coarseness,
                               const std::string& name, bool quiet, LitWindows* keep = nullptr);

/// Calls `work`, which has no parts, and shows on a terminal how long it takes.
template <class Work>
auto told(const std::string& name, bool quiet, Work&& work) {
    const Progress progress(1, quiet || !shows_steps(), name, Counted::parts_of_step);
    return work();
}

/// Prints a text as wide as the terminal, after an empty line; nothing where there is none.
void print_sentence(const std::string& text);

}  // namespace render2mpeg::app
