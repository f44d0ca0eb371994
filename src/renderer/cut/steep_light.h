#pragma once
// Lights several places of a pixel's surface where light is steep.
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "core/radiance.h"
#include "core/tolerance_map.h"
#include "renderer/cut/lighting_context.h"
#include "renderer/cut/shade.h"

namespace render2mpeg::renderer {

/// A gather point that is split into its places.
struct SplitPoint {
    std::uint32_t index = 0;              ///< in its tile, before any point was split
    std::uint32_t count = 0;              ///< of parts
    glm::vec3 position{0}, elsewhere{0};  ///< its own, and its second place
    float allowed = 0;                    ///< what its pixel was allowed to be off by; luminance
    PointLight light;                     ///< its own
    std::vector<PointLight> parts;        ///< theirs
};

/// A pixel's surface is lit at one place. At the edge of a shadow, or where things touch, that is not what the pixel
/// shows on average. There its gather point is split into 4 or 16, at other places of the surface in the pixel
/// (docs/model/visibility.md, "Light within a pixel").
class SteepLight {
  public:
    void forget() { *this = {}; }

    /// Splits those points of a frame whose diffuse light (`light`, by point of `frame.seen`) bends by more than their
    /// pixel's tolerance, lights their parts, and sums up the pixels anew: `seen` (that of `frame`) and `radiance` then
    /// hold the parts. `lit_frame`: of the trees; parts that the same trees lit are kept. `non_finite`: how many pixels
    /// were before. Adds what was gathered to `counts`. Not for frames that shutter or lens blur. The same bytes for
    /// any number of threads.
    void light(const LightingContext& frame, const ShadeSettings& settings, std::int64_t lit_frame, FrameLight light,
               std::uint64_t non_finite, Seen& seen, core::Radiance& radiance, ShadeCounts& counts);

    /// Moved points of a frame by their numbers since its points were split, if it was the last; without those that
    /// were.
    MovedPoints renumbered(MovedPoints moved, std::int64_t frame) const;

  private:
    std::vector<GatherTile> find(const LightingContext& frame, const FrameLight& light, std::int64_t lit_frame,
                                 const core::Radiance& radiance);
    void put_in(GatherTile& fresh, const std::vector<PointLight>& of_fresh, std::size_t tile, GatherTile& points,
                std::vector<PointLight>& light);

    std::vector<std::vector<SplitPoint>> tiles_;  ///< of the last frame, by index; empty: none
    std::int64_t lit_frame_ = 0;                  ///< of the trees that lit their parts
    std::optional<std::int64_t> frame_;           ///< whose points they are
};

}  // namespace render2mpeg::renderer
