#include "renderer/paths/path_numbers.h"

#include "core/sampling.h"

namespace render2mpeg::renderer {
namespace {

/// Keeps shifts apart from numbers that are drawn.
constexpr std::uint64_t shift_key = ~std::uint64_t{0};

static_assert(static_cast<int>(FirstNumber::count) <= core::halton_dimensions);

}  // namespace

float PathNumbers::first(FirstNumber which) const {
    const int dimension = static_cast<int>(which);
    const float sum =
        core::halton(dimension, index_) + core::uniform(batch_, shift_key, static_cast<std::uint64_t>(dimension));
    return sum < 1.0f ? sum : sum - 1.0f;
}

float PathNumbers::next() {
    return core::uniform(batch_, index_, ++drawn_);
}

}  // namespace render2mpeg::renderer
