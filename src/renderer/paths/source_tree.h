#pragma once
// Chooses one of many sources by about what each gives at a place, in logarithmic time.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace render2mpeg::renderer {

/// Where a path asks for light.
struct LightQuery {
    glm::vec3 position{0};  ///< of the surface
    glm::vec3 origin{0};    ///< where rays leave it
    glm::vec3 normal{0};    ///< light from behind it is none; 0: light comes from all sides

    /// Whether light may come from a place at `to` with so large a radius about it.
    bool may_see(glm::vec3 to, float radius = 0.0f) const {
        return normal == glm::vec3(0) || glm::dot(to, normal) > -radius;
    }
};

/// Extent and power of a source.
struct SourceExtent {
    glm::vec3 centre{0};
    float radius = 0;
    double power = 0;      ///< > 0, irradiance x distance^2; of distant ones irradiance
    bool distant = false;  ///< like a sun: it has no place
};

/// A tree over sources. Groups of up to 32 are chosen by power over squared distance, as [Estevez2018] has it, and
/// within a group by weights that the caller knows; a quarter of all choices is even.
class SourceTree {
  public:
    SourceTree() = default;
    explicit SourceTree(std::vector<SourceExtent> sources);

    bool empty() const { return sources_.empty(); }

    struct Choice {
        std::size_t source = 0;
        double chance = 0;  ///< 0: none was chosen
        double left = 0;    ///< of the number, again in [0, 1)
    };

    /// `weight(source)`: >= 0; sources of weight 0 are not chosen, and need not be. `number` in [0, 1).
    template <class Weight>
    Choice choose(const LightQuery& query, double number, Weight&& weight) const {
        if (empty()) return {};
        if (sources_.size() > 1 && number < evenly) {
            const double place = number / evenly * static_cast<double>(sources_.size());
            const auto source = static_cast<std::size_t>(place);
            return {source, chance_of(query, source, weight), place - static_cast<double>(source)};
        }
        if (sources_.size() > 1) number = std::min((number - evenly) / (1.0 - evenly), below_one);
        double chance = 1;
        const Node& group = group_for(query, number, chance);
        double sum = 0;
        for (std::uint32_t i = group.first; i < group.end; ++i) sum += weight(order_[i]);
        Choice choice;
        double left = number * sum;
        for (std::uint32_t i = group.first; i < group.end; ++i) {
            const double own = weight(order_[i]);
            if (!(own > 0.0)) continue;
            choice = {order_[i], chance * own / sum, left / own};
            if (left < own) break;
            left -= own;
        }
        if (!(choice.left < 1.0)) choice.left = below_one;
        choice.chance = mixed(choice.chance);
        return choice;
    }

    /// Chance of `choose` to take the source.
    template <class Weight>
    double chance_of(const LightQuery& query, std::size_t source, Weight&& weight) const {
        const Node& group = nodes_[group_of_[source]];
        const double own = weight(source);
        if (!(own > 0.0)) return 0.0;
        double sum = 0;
        for (std::uint32_t i = group.first; i < group.end; ++i) sum += weight(order_[i]);
        return mixed(chance_of_group(query, group) * own / sum);
    }

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

    std::vector<SourceExtent> sources_;
    std::vector<std::uint32_t> order_, group_of_;
    std::vector<Node> nodes_;
};

}  // namespace render2mpeg::renderer
