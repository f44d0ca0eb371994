#pragma once
// Chooses directions towards lamps, shining surfaces and the sky, and knows how likely it does.
#include <vector>

#include "renderer/base/plan.h"
#include "renderer/paths/source_tree.h"

namespace render2mpeg::renderer {

/// All that shines at the posed instant: punctual lights, suns, surfaces, the sky (docs/model/truth.md). Three choices
/// of a direction: to a lamp, to a surface, to the sky; each brings all light of its kind in the mean.
class LightSources {
  public:
    LightSources(const PosedScene& posed_scene, const Plan& plan);

    /// Punctual lights and suns.
    const SourceTree& lamps() const { return lamps_; }
    /// Shining surfaces, by their textures and their coverage.
    const SourceTree& surfaces() const { return surfaces_; }
    /// The sky, where that is an image; one of one colour is met as often as it should.
    const SourceTree& skies() const { return skies_; }

    /// Radiance of suns with a size that are in this direction, each times what `weight` makes of its density.
    template <class Weight>
    glm::vec3 suns(const LightQuery& query, glm::vec3 direction, Weight&& weight) const {
        glm::vec3 sum(0);
        for (const std::size_t i : suns_)
            if (const glm::vec3 radiance = lamps_.lights()[i]->radiance(direction); radiance != glm::vec3(0))
                sum += radiance * weight(lamps_.density(i, query, direction, {}));
        return sum;
    }

    /// Density of choosing the direction of a place on a surface that it may choose; 0 on others.
    float surface_density(const LightQuery& query, const core::SurfaceAddress& address) const;
    /// Likewise of the sky.
    float sky_density(glm::vec3 direction) const {
        return skies_.empty() ? 0.0f : skies_.density(0, {}, direction, {});
    }

  private:
    SourceTree lamps_, surfaces_, skies_;
    std::vector<std::size_t> suns_;  ///< lamps that are far
    std::vector<int> surface_of_;    ///< by object; -1: shines not
};

}  // namespace render2mpeg::renderer
