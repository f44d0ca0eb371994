#pragma once
// What bodies of glass are to rays that go straight.
#include <cstdint>

namespace render2mpeg::renderer {

/// What bodies of glass that bend light are to rays that go straight: glass like any other, or as good as opaque, since
/// their light comes by other ways (caustics.h).
enum class Bodies : std::uint8_t { pass, block };

}  // namespace render2mpeg::renderer
