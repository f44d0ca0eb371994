#pragma once
// Blur of a snapshot by shutter and lens, in pixels.
#include <vector>

#include "renderer/surface/frame.h"
#include "renderer/surface/posed_scene.h"

namespace render2mpeg::renderer {

/// Less is not blurred. chosen: a quarter of a pixel, which widens the pixel's own box by 3 % of its variance; not
/// tuned.
inline constexpr float least_blur = 0.25f;

/// How far things are blurred on the picture, in pixels: their motion while the shutter is open, or the disc that the
/// lens makes of a point, whichever is longer.
class Blur {
  public:
    /// `snapshot` outlives it.
    explicit Blur(const scene::Snapshot& snapshot);

    /// Whether there is any.
    bool any() const { return moves_ || snapshot_.camera.has_aperture(); }

    bool has_lens() const { return snapshot_.camera.has_aperture(); }

    /// Of a point of a surface.
    float of(const core::SurfaceAddress& address) const;
    /// Of a place in the world that stands still.
    float of_place(glm::vec3 world) const;
    float of_sky(glm::vec2 position) const;
    /// Of surfaces seen in a mirror or through glass, at this distance along the ray.
    float of_distance(float distance) const;

    /// Of one pixel's middle.
    float of_pixel(const core::Visible& visible, int x, int y) const;

    /// From where a pixel's middle is when the shutter opens to where it is when that closes; 0: it is not known.
    glm::vec2 motion_of_pixel(const core::Visible& visible, int x, int y) const;
    /// Of all of them.
    core::Plane<glm::vec2> motions(const core::Visible& visible) const;

  private:
    float of_lens(float depth) const;
    glm::vec2 way(const scene::ScreenPoint& from, const scene::ScreenPoint& to) const;

    const scene::Snapshot& snapshot_;
    bool moves_;
    scene::Camera opening_, closing_;
    float diagonal_;  ///< of the picture, pixels: things that leave the view may go that far
};

/// Tiles that may be blurred, by how far: what `see` found in them, what a few more samples find, and what moves
/// across; each reaches as far as it is blurred. 0: not at all.
std::vector<float> blur_of_tiles(const Blur& blur, const scene::Snapshot& snapshot, const Frame& seen,
                                 const std::vector<float>& found);

/// Has shadows of moving objects blurred on others: their own would fall on themselves. None where a lamp moves.
void blur_shadows(const scene::Snapshot& snapshot, Frame& seen);

}  // namespace render2mpeg::renderer
