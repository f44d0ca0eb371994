#pragma once
// `render2mpeg part`: makes one part of a film that is planned.
#include <string>
#include <vector>

#include "app/options/options.h"

namespace render2mpeg::app {

/// Makes the part that the options name. Returns the exit status: 0, or 128 and a signal's number after an
/// interruption. Throws Refusal where it cannot be made here, else core::Error.
int make_part(const PartOptions& options);

/// Returns the exit status. Throws core::Error, naming the parts that are not whole.
int join(const PartOptions& options);

/// `render2mpeg farm`. `words` are its command line. Returns the exit status. Throws core::Error.
int farm(const FarmOptions& options, const std::vector<std::string>& words);

/// Returns the exit status. Throws core::Error.
int farm_status(const PartOptions& options);

}  // namespace render2mpeg::app
