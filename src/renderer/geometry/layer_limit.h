#pragma once
// The limit of an animation on layers that a ray passes, as Cycles has it for transparent bounces.
#include <cstdint>
#include <vector>

#include "scene/model/animation.h"

namespace render2mpeg::renderer {

/// Counts a ray's layers: surfaces of part coverage, where they are holes, too. The surface behind more of them than
/// the limit ends the ray: it is black, but may shine. The sky there is seen.
class LayerLimit {
  public:
    /// Without a limit.
    LayerLimit() = default;
    /// Of an animation, which may have none.
    explicit LayerLimit(const scene::Animation& animation);

    /// Whether an object's surface is one of them.
    bool counts(std::uint32_t object) const { return most_ >= 0 && limited_[object]; }
    /// Whether surfaces behind so many are black.
    bool ends(int passed) const { return most_ >= 0 && passed > most_; }

  private:
    int most_ = -1;  ///< below 0: no limit
    std::vector<bool> limited_;
};

}  // namespace render2mpeg::renderer
