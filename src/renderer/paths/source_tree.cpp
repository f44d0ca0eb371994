#include "renderer/paths/source_tree.h"

#include <limits>
#include <numeric>
#include <utility>

#include "core/numeric.h"

namespace render2mpeg::renderer {
namespace {

/// Sources of a group. chosen: 32, since scenes with as many keep the exact choice; not tuned.
constexpr std::uint32_t largest_group = 32;

}  // namespace

SourceTree::SourceTree(std::vector<SourceExtent> sources) : sources_(std::move(sources)) {
    const auto count = static_cast<std::uint32_t>(sources_.size());
    if (count == 0) return;
    order_.resize(count);
    group_of_.resize(count);
    std::iota(order_.begin(), order_.end(), 0u);
    nodes_.emplace_back();
    nodes_[0].end = count;
    for (std::uint32_t node = 0; node < nodes_.size(); ++node) split(node);
}

void SourceTree::measure(Node& node) const {
    glm::vec3 low(std::numeric_limits<float>::max()), high(-std::numeric_limits<float>::max());
    for (std::uint32_t i = node.first; i < node.end; ++i) {
        const SourceExtent& s = sources_[order_[i]];
        (s.distant ? node.far_power : node.near_power) += s.power;
        if (s.distant) continue;
        low = glm::min(low, s.centre - s.radius);
        high = glm::max(high, s.centre + s.radius);
    }
    if (!(node.near_power > 0.0)) return;
    node.centre = 0.5f * (low + high);
    node.radius = 0.5f * glm::length(high - low);
}

/// Halves a node at the middle of its longest side; what is distant comes to the front.
void SourceTree::split(std::uint32_t index) {
    Node node = nodes_[index];
    measure(node);
    const auto begin = order_.begin() + node.first, end = order_.begin() + node.end;
    if (node.end - node.first <= largest_group) {
        for (auto i = begin; i != end; ++i) group_of_[*i] = index;
        // A group keeps the order of its sources.
        std::sort(begin, end);
        nodes_[index] = node;
        return;
    }
    glm::vec3 low(std::numeric_limits<float>::max()), high(-std::numeric_limits<float>::max());
    for (auto i = begin; i != end; ++i) {
        if (sources_[*i].distant) continue;
        low = glm::min(low, sources_[*i].centre);
        high = glm::max(high, sources_[*i].centre);
    }
    const glm::vec3 side = high - low;
    const int axis = side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
    const auto key = [&](std::uint32_t i) {
        const SourceExtent& s = sources_[i];
        return std::pair(s.distant ? -std::numeric_limits<float>::max() : s.centre[axis], i);
    };
    const std::uint32_t middle = (node.first + node.end) / 2;
    std::nth_element(begin, order_.begin() + middle, end,
                     [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
    node.left = static_cast<std::uint32_t>(nodes_.size());
    nodes_[index] = node;
    Node child;
    child.parent = index;
    child.first = node.first;
    child.end = middle;
    nodes_.push_back(child);
    child.first = middle;
    child.end = node.end;
    nodes_.push_back(child);
}

/// About the irradiance of a node, if it faced the surface and was seen; 0 only where it is wholly behind.
double SourceTree::weight_of(const LightQuery& query, const Node& node) {
    const glm::vec3 d = node.centre - query.position;
    if (!(node.near_power > 0.0) || !query.may_see(d, 1.001f * node.radius)) return node.far_power;
    const double radius = static_cast<double>(node.radius);
    return node.far_power +
           core::divide_or(node.near_power, std::max(static_cast<double>(glm::dot(d, d)), radius * radius), 0.0);
}

/// Where the number leads; it is then what is left of it.
const SourceTree::Node& SourceTree::group_for(const LightQuery& query, double& number, double& chance) const {
    const Node* node = &nodes_[0];
    while (node->left != 0) {
        const double left = weight_of(query, nodes_[node->left]), right = weight_of(query, nodes_[node->left + 1]);
        const double share = core::divide_or(left, left + right, 0.5);
        const bool to_left = number < share;
        chance *= to_left ? share : 1.0 - share;
        number = std::min(to_left ? number / share : (number - share) / (1.0 - share), below_one);
        node = &nodes_[to_left ? node->left : node->left + 1];
    }
    return *node;
}

double SourceTree::chance_of_group(const LightQuery& query, const Node& group) const {
    double chance = 1;
    for (const Node* node = &group; node != &nodes_[0]; node = &nodes_[node->parent]) {
        const std::uint32_t left_child = nodes_[node->parent].left;
        const double left = weight_of(query, nodes_[left_child]), right = weight_of(query, nodes_[left_child + 1]);
        const double share = core::divide_or(left, left + right, 0.5);
        chance *= node == &nodes_[left_child] ? share : 1.0 - share;
    }
    return chance;
}

}  // namespace render2mpeg::renderer
