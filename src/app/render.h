#pragma once

#include <string>
#include <vector>

#include "app/options.h"
#include "app/production.h"
#include "app/publish.h"

namespace render2mpeg::app {

/// The files that a film is made from, as far as they are known.
std::vector<Files> inputs_of(const Production& film, const RenderOptions& options);

/// `render2mpeg render`. Returns the exit status: 0, or 130 after an interruption. Throws core::Error.
int render(const RenderOptions& options, const std::string& command);

/// `render2mpeg plan`.
int plan(const PlanOptions& options);

}  // namespace render2mpeg::app
