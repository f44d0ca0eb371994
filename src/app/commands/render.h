#pragma once
// `render2mpeg render`: from options to a finished film with its statistics and reports.
#include <string>

#include "app/loop/run_statistics.h"
#include "app/options/options.h"

namespace render2mpeg::app {

/// `render2mpeg render`. Returns the exit status: 0, or 130 after an interruption. Throws core::Error. `rendered` is
/// filled where it is not null.
int render(const RenderOptions& options, const std::string& command, Rendered* rendered = nullptr);

/// `render2mpeg plan`.
int plan(const PlanOptions& options);

}  // namespace render2mpeg::app
