#pragma once
// Exact confidence bounds of shares that were counted.
#include <cstdint>

namespace render2mpeg::core {

/// Largest share that a count is compatible with [Clopper1934]: were more of all things marked, at most `marked` of
/// `drawn` independent ones would be found with a chance under 1 - `confidence`. One-sided; 1 where none were drawn or
/// all are marked.
double most_share(std::uint64_t marked, std::uint64_t drawn, double confidence);

}  // namespace render2mpeg::core
