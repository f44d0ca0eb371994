#pragma once
// Splits light into what stays still and what moving objects change.
#include <span>
#include <vector>

#include "renderer/base/light_point.h"
#include "renderer/base/plan.h"
#include "renderer/surface/posed_scene.h"
#include "renderer/tree/light_trees.h"

namespace render2mpeg::renderer {

/// The light of an instant, split into its static part, which stays while objects move, and dynamic ones, which they
/// change. On surfaces that never move, light is `static_light` + `gained` - `lost` - `occluded` + `moving`, and
/// records hold the first alone (docs/model/dynamic-light.md).
class LightSplit {
  public:
    /// Whether a film's light may be worth splitting, before its anchors are known: lights stay what they are, things
    /// move, but few, and nothing lets light through.
    static bool may_suit(const scene::Animation& film, const Plan& plan);
    /// Whether it is: what moves holds few of the anchors, too.
    static bool suit(const PosedScene& posed_scene, const Plan& plan, std::size_t still_anchors,
                     std::size_t moving_anchors);

    /// A chunk begins.
    void forget() {
        then_.clear();
        taken_ = false;
        static_light = {};
    }

    /// Takes the light trees of an instant, and the still anchors that are in it. Whether `static_light` is another
    /// now: anchors have come to shine otherwise than they did when it was taken.
    bool update(const LightTrees& now, std::span<const LightPoint> still_anchors, const PersistentLightTrees& lasting);

    LightTrees static_light;  ///< past what is still: of lights, and of anchors as they shone then
    LightTrees gained, lost;  ///< likewise: of anchors, by what they shine more and less than they did then
    LightTrees occluded;      ///< of lights and still anchors of now: what moving objects hide of it
    LightTrees moving;        ///< past everything: of anchors on what moves; and lights that are not clustered

  private:
    bool taken_ = false;            ///< `static_light` is that of a frame of this chunk
    std::vector<LightPoint> then_;  ///< by id
};

}  // namespace render2mpeg::renderer
