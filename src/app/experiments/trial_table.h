#pragma once
// Figures of trials as text and JSON.
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "app/experiments/trial.h"

namespace render2mpeg::app {

struct TrialColumn {
    const char* key;   ///< in JSON
    const char* head;  ///< in tables; empty: in JSON alone
    int width;         ///< in text
    std::string (*text)(double);
    double (*value)(const Trial&);
};
using TrialColumns = std::vector<const TrialColumn*>;

namespace columns {
extern const TrialColumn light, code, rays, cut, median, p95, over, twice, psnr_y, ssim_y, psnr_hvs_m, bytes, kilobits;
}  // namespace columns

/// Lines of text, each with its end; the name is left-aligned in `width` columns.
std::string heads_text(const TrialColumns& columns, const std::string& name, int width);
std::string row_text(const TrialColumns& columns, const std::string& name, int width, const Trial& trial);

/// All figures of a trial by their keys, whatever a table shows; null for non-finite values.
nlohmann::json figures_json(const Trial& trial);

}  // namespace render2mpeg::app
