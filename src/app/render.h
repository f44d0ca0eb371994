#pragma once

#include "app/options.h"

namespace render2mpeg::app {

/// `render2mpeg render`. Returns the exit status: 0, or 130 after an interruption. Throws core::Error.
int render(const RenderOptions& options, const std::string& command);

/// `render2mpeg plan`.
int plan(const PlanOptions& options);

}  // namespace render2mpeg::app
