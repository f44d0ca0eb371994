#pragma once
// Chooses one of many sources by about what each gives at a place, in logarithmic time.
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "renderer/lights/light.h"

namespace render2mpeg::renderer {

/// A tree over lights. Groups of up to 32 are chosen by power over squared distance, as [Estevez2018] has it, and
/// within a group by the lights' own weights; a quarter of all choices is even.
class SourceTree {
  public:
    SourceTree() = default;
    explicit SourceTree(Lights lights);

    const Lights& lights() const { return lights_; }
    bool empty() const { return lights_.empty(); }

    struct Choice {
        std::size_t source = 0;
        double chance = 0;  ///< 0: none was chosen
        double left = 0;    ///< of the number, again in [0, 1)
    };
    /// Lights of weight 0 are not chosen, and need not be. `number` in [0, 1).
    Choice choose(const LightQuery& query, double number) const;
    /// Chance of `choose` to take the light.
    double chance_of(const LightQuery& query, std::size_t source) const;

    /// A direction to the light that the number chooses, with what is left of it to a part of that.
    LightSample sample(const LightQuery& query, float number, glm::vec2 u) const;
    /// Density of `sample` in a direction in which this light is met.
    float density(std::size_t source, const LightQuery& query, glm::vec3 direction,
                  const core::SurfaceAddress& address) const;

  private:
    static constexpr double below_one = 1.0 - 0x1p-53;
    /// Share of choices that knows no weights: what shines most may be hidden. chosen: a quarter, so that no variance
    /// grows by more than a third.
    static constexpr double evenly = 0.25;

    double mixed(double by_weight) const {
        const auto count = static_cast<double>(sources_.size());
        return count > 1 && by_weight > 0.0 ? evenly / count + (1.0 - evenly) * by_weight : by_weight;
    }

    struct Node {
        std::uint32_t first = 0, end = 0;  ///< of `order_`
        std::uint32_t parent = 0;          ///< the root is its own
        std::uint32_t left = 0;            ///< child, followed by the right one; 0: a group
        glm::vec3 centre{0};
        float radius = 0;  ///< around all that are near
        double near_power = 0, far_power = 0;
    };

    void split(std::uint32_t node);
    void measure(Node& node) const;
    static double weight_of(const LightQuery& query, const Node& node);
    const Node& group_for(const LightQuery& query, double& number, double& chance) const;
    double chance_of_group(const LightQuery& query, const Node& group) const;

    Lights lights_;
    std::vector<SourceExtent> sources_;
    std::vector<std::uint32_t> order_, group_of_;
    std::vector<Node> nodes_;
};

}  // namespace render2mpeg::renderer
