#pragma once
// The options of quality, rates and buffer.
#include <cstdint>
#include <string>

#include "app/options/options.h"
#include "encoder/types.h"

namespace CLI {
class App;
}

namespace render2mpeg::app {

/// Adds the options of quality, rates and buffer: docs/coding.md, "Rate and quality".
void add_rate_options(CLI::App& command, CodingOptions& options);

/// What options ask of rates. Throws core::Error where they contradict each other.
encoder::RateControl rate_control(const CodingOptions& options);

/// Whether a first pass over the film finds the quantisers.
bool two_passes(const CodingOptions& options);

/// Bits, or bits per second: 6000000, 6000k, 6M, 1.5M. `what` names them in errors.
std::int64_t bits_from(const std::string& text, const std::string& what);

}  // namespace render2mpeg::app
