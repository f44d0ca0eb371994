#pragma once
// Differences of light between two instants.
#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "core/packed_normal.h"
#include "scene/pose/snapshot.h"

namespace render2mpeg::renderer {

/// Causes of changed light between two instants: rays that meet none of its boxes find the same as before on surfaces
/// and lamps other than its own.
struct LightChange {
    /// World; of both instants.
    struct Box {
        glm::vec3 low{0}, high{0};
    };
    static constexpr std::size_t most_boxes = 32;
    bool all = false;           ///< nothing holds
    std::vector<Box> boxes;     ///< about things that moved, came, went, or changed their colour; 32 at most
    std::vector<bool> objects;  ///< by object: whether it is such a thing
    std::vector<bool> lamps;    ///< by Animation::lights: whether it shines from elsewhere or otherwise than before
    bool strengths = false;     ///< some source is brighter or darker

    static LightChange everything() {
        LightChange change;
        change.all = true;
        return change;
    }
    bool moves(std::uint32_t object) const { return object < objects.size() && objects[object]; }
    /// Whether light is the same: everything but the camera.
    bool none() const;
    /// Whether some source shines from elsewhere.
    bool moves_sources(const scene::Animation& film) const;
    /// The same, or otherwise than before.
    bool changes_sources(const scene::Animation& film) const { return all || strengths || moves_sources(film); }
    /// Whether a place lies in a box.
    bool holds(glm::vec3 place) const;
};

/// A change as it is seen from a place.
class SeenChange {
  public:
    SeenChange(const LightChange& change, glm::vec3 origin);
    /// Whether a ray may meet a box within `far`.
    bool meets(const core::PackedNormal& direction, float far) const;

  private:
    /// About the ball of a box.
    struct Cone {
        glm::vec3 axis{0};
        float cosine = -1, nearest = 0;
    };
    const LightChange& change_;
    glm::vec3 origin_;
    std::array<Cone, LightChange::most_boxes> cones_;
};

/// Strengths of all sources of an instant. Light of one source is in proportion to its own.
struct SourceStrengths {
    std::vector<glm::vec3> lamps;  ///< by Animation::lights: LightState::intensity; 0: dark
    std::vector<float> objects;    ///< by object: Snapshot::emission_factor
};
SourceStrengths strengths_of(const scene::Snapshot& snapshot);

/// From one instant of a film to another. A source that was dark and shines changes all: nobody asked it before.
LightChange change_between(const scene::Snapshot& before, const scene::Snapshot& now);

}  // namespace render2mpeg::renderer
