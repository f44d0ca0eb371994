#pragma once
// Tells options that change nothing in this run.
#include <string>
#include <vector>

#include "app/options/film.h"
#include "app/options/keyframes.h"
#include "app/options/options.h"
#include "app/options/output_kind.h"

namespace render2mpeg::app {

/// One line for every reason why options that were given change nothing in this run; none where all count.
std::vector<std::string> unused_options(const RenderOptions& options, OutputKind kind,
                                        const ToleranceRequest& tolerance);
std::vector<std::string> unused_options(const EncodeOptions& options);

/// A line about keyframes that are no frames of the film; empty where all are.
std::string unused_keyframes(const Keyframes& keyframes, const FrameRange& frames);

/// A line about keyframes of a DVD's film at which no chapter can begin, since a unit of its stream begins less than
/// 0.4 s before; empty where there is none. Cuts, which are found while frames are made, are not looked at.
std::string keyframes_without_chapter(const Film& film);

}  // namespace render2mpeg::app
