#pragma once
// A place that scatters light, a surface or a fibre, as paths weigh and choose directions there.
#include <glm/glm.hpp>
#include <optional>

#include "renderer/paths/path_directions.h"
#include "renderer/paths/source_tree.h"
#include "renderer/surface/posed_scene.h"

namespace render2mpeg::renderer {

class Scatterer {
  public:
    Scatterer() = default;
    Scatterer(const PosedScene& posed_scene, const SurfacePoint& point) : point_(point) {
        if (point.fibre) {
            hair_ = posed_scene.hair_at(point);
            query_ = {hair_->axis(), hair_->axis(), glm::vec3(0)};
            return;
        }
        query_ = {point.position, shadow_origin(point), point.geometric_normal + point.smooth.tilt};
        chance_ = lobe_chance(point);
    }

    const SurfacePoint& point() const { return point_; }
    bool is_fibre() const { return hair_.has_value(); }

    /// Where lights are asked from. `leave_from` moves where a surface's rays start.
    const LightQuery& query() const { return query_; }
    void leave_from(glm::vec3 origin) {
        if (!hair_) query_.origin = origin;
    }
    /// Where a ray of this direction starts: outside of a fibre, by so many lengths of the direction.
    float skipped(glm::vec3 direction) const { return hair_ ? hair_->way_out(direction) : 0.0f; }
    glm::vec3 origin_of(glm::vec3 direction) const { return query_.origin + skipped(direction) * direction; }

    /// Without a density where nobody asks for it.
    Scattered scattered(glm::vec3 to_light, bool with_density) const {
        if (hair_) return hair_->scattered(to_light);
        return {evaluate(point_.bsdf, point_.shading_normal, point_.outgoing, to_light) *
                    glm::dot(point_.shading_normal, to_light),
                with_density ? direction_density(point_, chance_, to_light) : 0.0f};
    }
    /// Albedo under even light.
    glm::vec3 albedo() const { return hair_ ? hair_->albedo() : whole_albedo(point_); }

    /// A direction, `number` and `u` in [0, 1), and its density; 0: none. `weight` becomes its share over its density.
    float sample(float number, glm::vec2 u, glm::vec3& direction, glm::vec3& weight) const {
        direction = hair_ ? hair_->sample(number, u) : chosen_direction(point_, number < chance_, u);
        const Scattered to = hair_ ? hair_->scattered(direction) : Scattered{};
        const float density = hair_ ? to.density : direction_density(point_, chance_, direction);
        if (!(density > 0.0f)) return 0.0f;
        weight = hair_ ? to.share / density
                       : evaluate(point_.bsdf, point_.shading_normal, point_.outgoing, direction) *
                             (glm::dot(point_.shading_normal, direction) / density);
        return density;
    }

  private:
    SurfacePoint point_;
    std::optional<HairScattering> hair_;
    LightQuery query_;
    float chance_ = 0;  ///< lobe_chance
};

}  // namespace render2mpeg::renderer
