#pragma once
// What the left eye's points tell those of the right one, which see the same places at the same instant.
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include "core/packed_normal.h"
#include "renderer/cut/point_light.h"
#include "renderer/surface/frame.h"
#include "scene/model/camera.h"

namespace render2mpeg::renderer {

/// Light at a place that is the same for both eyes.
struct SharedLight {
    /// Bit l: the l-th sharp light (Gatherer::gather_exact) shines on all of it, or on nothing of it. Neither: nobody
    /// knows. Lights beyond the last bit are known nowhere.
    std::uint32_t lit = 0, dark = 0;
    /// All other light, as in PointLight, its errors by unit of the point's weight. An error of 0: not known.
    glm::vec3 direct{0}, indirect{0}, glossy{0};
    float error = 0, error_of_block = 0;

    static constexpr std::size_t most_lights = 32;
};

/// What the other eye tells of a point.
struct ToldLight {
    SharedLight light;
    float spread = 0;   ///< largest difference of what four pixels tell, luminance of the point's pixel
    glm::vec3 turn{0};  ///< from the direction to the other eye to the one to this
};

/// The left eye's lit points, which are found by the places that they show.
class OtherEye {
  public:
    void forget() { tiles_.clear(); }
    /// Takes a frame's points; `light` and `shared` go by tile and point, errors are those of `light`.
    void take(const Frame& seen, const scene::Camera& camera, std::span<const std::vector<PointLight>> light,
              std::span<const std::vector<SharedLight>> shared);

    /// What those of the four pixels about a point's place tell that show its surface, as far as they agree; nothing
    /// where hardly any do, or that surface is seen from aslant. `extent`: world size of the point's pixel.
    ToldLight at(const GatherPoint& p, float extent) const;
    bool is_empty() const { return tiles_.empty(); }

  private:
    struct Point {
        std::uint16_t pixel = 0;
        bool back_side = false;
        std::uint32_t object = 0;
        glm::vec3 position{0};
        core::PackedNormal geometric_normal, shading_normal;
        SharedLight shared;
    };
    const Point* point_at(glm::ivec2 pixel, const GatherPoint& p, float extent) const;

    scene::Camera camera_;
    int tiles_across_ = 0;
    std::vector<std::vector<Point>> tiles_;
};

}  // namespace render2mpeg::renderer
