#pragma once
// Where photons should start: most where light that is seen came from.
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace render2mpeg::renderer {

/// What one path of photons brought.
struct GuidedPath {
    glm::vec3 numbers;  ///< that chose its start, evenly, in [0, 1)
    float value;        ///< what it left that matters, >= 0
};

/// A density over the three numbers in [0, 1) that choose how a photon starts (see PhotonSource::emit), constant in
/// each leaf of a k-d tree. Numbers are warped along the tree [Clarberg2005], so that points that lie evenly stay so.
/// The density is the square root of the mean square of what paths of a leaf leave, which makes the variance of their
/// sum least; a part of it is even: no path weighs more than 1 / even_share of what it would without.
class EmissionGuide {
  public:
    /// An even density.
    EmissionGuide() = default;
    /// Learnt from paths that left something, of `all` that were followed. Even where none did.
    EmissionGuide(std::vector<GuidedPath> paths, std::uint64_t all);

    struct Start {
        glm::vec3 numbers;
        float density;
    };
    /// From three even numbers in [0, 1).
    Start start(glm::vec3 numbers) const;

    /// chosen: a fifth.
    static constexpr double even_share = 0.2;

  private:
    struct Node {
        float left_share = 0.5f;  ///< chance of the half that holds lower numbers
        std::int8_t axis = -1;    ///< -1: a leaf
        std::uint32_t left = 0;   ///< of the two children, which lie together
    };
    double grow(std::uint32_t node, std::span<GuidedPath> paths, double volume, double all, glm::vec3 low,
                glm::vec3 size, int depth);
    void spread(std::uint32_t node, double mass, double volume);

    std::vector<Node> nodes_;
    std::vector<double> mass_;  ///< of each node, while it grows
};

}  // namespace render2mpeg::renderer
