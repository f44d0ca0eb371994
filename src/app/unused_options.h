#pragma once

#include <string>
#include <vector>

#include "app/keyframes.h"
#include "app/options.h"
#include "app/output_kind.h"

namespace render2mpeg::app {

/// One line for every reason why options that were given change nothing in this run; none where all count.
std::vector<std::string> unused_options(const RenderOptions& options, OutputKind kind,
                                        const ToleranceRequest& tolerance);
std::vector<std::string> unused_options(const EncodeOptions& options);

/// A line about keyframes that are no frames of the film; empty where all are.
std::string unused_keyframes(const Keyframes& keyframes, const FrameRange& frames);

}  // namespace render2mpeg::app
