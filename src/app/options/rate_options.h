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

void add_rate_options(CLI::App& command, CodingOptions& options);

/// Throws core::Error for contradictions.
encoder::RateControl rate_control(const CodingOptions& options);

bool two_passes(const CodingOptions& options);

/// Bits, or bits per second: 6000000, 6000k, 6M, 1.5M. Errors name `what`.
std::int64_t bits_from(const std::string& text, const std::string& what);

}  // namespace render2mpeg::app
