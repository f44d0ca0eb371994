#pragma once
// The clusters of a cut, and the light of their representatives.
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "renderer/base/isa_clones.h"
#include "renderer/cut/shadow_tester.h"
#include "renderer/tree/light_trees.h"

namespace render2mpeg::renderer {

/// One cluster of a cut: light of its representative, and the lanes it reaches. Three cache lines: a cut of a thousand
/// of them stays near.
struct alignas(64) Cluster {
    Cluster() {}    // leaves lanes as they are
    Lanes diffuse;  ///< irradiance by unit intensity, visibility included
    Lanes bound;    ///< of its luminance if all of it were visible; 0 for a single light
    glm::vec3 intensity;
    LightRef ref;
    std::uint32_t representative = 0;  ///< a light of its tree
    /// Bit i: lane i is lit, or not known to be in shadow: as its ray found, where none was needed as its parent's.
    std::uint16_t lit = 0;
    std::uint16_t unknown = 0;  ///< bit i: nobody knows; counts as half lit
    std::uint8_t tree = 0;
    bool is_open = false;      ///< may be split, and some lane could notice
    bool any_clamped = false;  ///< of the light of the representative
};

/// Share of the representative's light that reaches lane i: 0, 1, or 1/2 where nobody knows.
RENDER2MPEG_ALWAYS_INLINED float visible_share(const Cluster& cluster, int i) {
    const float lit = (cluster.unknown >> i & 1) != 0 ? 0.5f : 1.0f;
    return (cluster.lit >> i & 1) != 0 ? lit : 0.0f;
}

/// The clusters of one group's cut, with lobes and tints beside them where a group needs them.
class Clusters {
  public:
    /// None, for these lanes.
    void start(const GatherLanes& lanes, const LightTrees& light_trees);

    RENDER2MPEG_ALWAYS_INLINED std::size_t size() const { return clusters_.size(); }
    RENDER2MPEG_ALWAYS_INLINED Cluster& operator[](std::size_t index) { return clusters_.data()[index]; }
    RENDER2MPEG_ALWAYS_INLINED const Cluster& operator[](std::size_t index) const { return clusters_.data()[index]; }

    /// Adds the cluster of a tree's node; returns its index.
    std::uint32_t add(int tree, LightRef ref);

    /// Known light of a cluster's children before they are traced.
    LightContribution inherited(std::uint32_t index) const;

    /// Keeps the light of its representative.
    void set(std::uint32_t index, const LightContribution& contribution);

    /// Contribution of a cluster per unit intensity.
    RENDER2MPEG_ALWAYS_INLINED UnitLight unit(std::size_t index) const {
        const bool glossy = !lobes_.empty();
        return {clusters_.data()[index].diffuse, glossy ? &lobes_.data()[index].f0 : nullptr,
                glossy ? &lobes_.data()[index].schlick : nullptr,
                tints_.empty() ? nullptr : tints_.data()[index].passes};
    }

  private:
    /// A cluster's GGX lobes, by unit intensity; only for glossy lanes.
    struct alignas(64) Lobe {
        Lobe() {}
        Lanes f0, schlick;
    };

    bool glossy_ = false, translucent_ = false;
    std::vector<Cluster> clusters_;
    std::vector<Lobe> lobes_;
    std::vector<LayerTint> tints_;
};

}  // namespace render2mpeg::renderer
