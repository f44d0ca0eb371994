#pragma once
// Common parts of the pages and files of `cost`, `tune` and `compare`.
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "app/experiments/trial.h"

namespace render2mpeg::app {

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
