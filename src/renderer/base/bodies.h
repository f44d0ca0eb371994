#pragma once
// Treatment of bodies of glass by straight rays.
#include <cstdint>

namespace render2mpeg::renderer {

/// Treatment of light-bending bodies of glass by straight rays: like any other glass, or as good as opaque, since their
/// light comes by other ways (caustics.h).
enum class Bodies : std::uint8_t { pass, block };

}  // namespace render2mpeg::renderer
