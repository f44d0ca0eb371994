#pragma once
// How important a place is for light that cameras see.
#include <span>
#include <vector>

#include "renderer/base/light_point.h"
#include "renderer/surface/posed_scene.h"
#include "scene/pose/snapshot.h"

namespace render2mpeg::renderer {

/// Picture format of the cameras that importance is judged by: few rays serve.
inline constexpr scene::PictureFormat importance_format{24, 14, 1.0f};

/// A place that a camera sees, off its surface.
struct SeenPoint {
    glm::vec3 position, normal;
};

/// Points seen by the camera of the posed instant, which is made for `importance_format`: one for each of its pixels
/// that shows a surface.
std::vector<SeenPoint> seen_points(const PosedScene& posed_scene);

/// The film at one of `count` instants spread over it, its lights at their average strength, its camera one of its
/// shots'.
scene::Snapshot importance_instant(const scene::Animation& film, int i, int count);

/// How much of the light that leaves places reaches what cameras see.
class EyeImportance {
  public:
    /// Of each place, for the camera of the posed instant, which is made for `importance_format`: over the mean of the
    /// first places that were asked about, at least a quarter; all 1 where the camera sees no surface.
    std::vector<float> of(const PosedScene& posed_scene, std::span<const LightPoint> places);

    /// Importance that every place has whatever the camera sees: light bounces on, mirrors show what is behind, and the
    /// film has more instants than are looked at. chosen: a quarter.
    static constexpr float least = 0.25f;

  private:
    double near2_ = 0, mean_ = 0;  ///< of the first places; 0: none yet
};

}  // namespace render2mpeg::renderer
