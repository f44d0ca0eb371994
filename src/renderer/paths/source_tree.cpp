#include "renderer/paths/source_tree.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "core/box.h"
#include "core/numeric.h"

namespace render2mpeg::renderer {
namespace {

/// Sources of a group. chosen: 32, since scenes with as many keep the exact choice; not tuned.
constexpr std::uint32_t largest_group = 32;

}  // namespace

SourceTree::SourceTree(Lights lights) : lights_(std::move(lights)) {
    for (const auto& light : lights_) sources_.push_back(light->extent());
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
    core::Box box;
    for (std::uint32_t i = node.first; i < node.end; ++i) {
        const SourceExtent& s = sources_[order_[i]];
        (s.distant ? node.far_power : node.near_power) += s.power;
        if (s.distant) continue;
        box.hold(s.centre - s.radius);
        box.hold(s.centre + s.radius);
    }
    if (!(node.near_power > 0.0)) return;
    node.centre = box.middle();
    node.radius = 0.5f * glm::length(box.size());
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
    core::Box box;
    for (auto i = begin; i != end; ++i)
        if (!sources_[*i].distant) box.hold(sources_[*i].centre);
    const int axis = box.longest_axis();
    const auto key = [&](std::uint32_t i) {
        const SourceExtent& s = sources_[i];
        return std::pair(s.distant ? -std::numeric_limits<float>::max() : s.centre[axis], i);
    };
    const std::uint32_t middle = (node.first + node.end) / 2;
    std::nth_element(begin, order_.begin() + middle, end,
                     [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
    node.left = static_cast<std::uint32_t>(nodes_.size());
    nodes_[index] = node;
    nodes_.push_back({node.first, middle, index});
    nodes_.push_back({middle, node.end, index});
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

SourceTree::Choice SourceTree::choose(const LightQuery& query, double number) const {
    if (empty()) return {};
    if (sources_.size() > 1 && number < evenly) {
        const double place = number / evenly * static_cast<double>(sources_.size());
        const auto source = static_cast<std::size_t>(place);
        return {source, chance_of(query, source), place - static_cast<double>(source)};
    }
    if (sources_.size() > 1) number = std::min((number - evenly) / (1.0 - evenly), below_one);
    double chance = 1;
    const Node& group = group_for(query, number, chance);
    double sum = 0;
    for (std::uint32_t i = group.first; i < group.end; ++i) sum += lights_[order_[i]]->weight(query);
    Choice choice;
    double left = number * sum;
    for (std::uint32_t i = group.first; i < group.end; ++i) {
        const double own = lights_[order_[i]]->weight(query);
        if (!(own > 0.0)) continue;
        choice = {order_[i], chance * own / sum, left / own};
        if (left < own) break;
        left -= own;
    }
    if (!(choice.left < 1.0)) choice.left = below_one;
    choice.chance = mixed(choice.chance);
    return choice;
}

double SourceTree::chance_of(const LightQuery& query, std::size_t source) const {
    const Node& group = nodes_[group_of_[source]];
    const double own = lights_[source]->weight(query);
    if (!(own > 0.0)) return 0.0;
    double sum = 0;
    for (std::uint32_t i = group.first; i < group.end; ++i) sum += lights_[order_[i]]->weight(query);
    return mixed(chance_of_group(query, group) * own / sum);
}

LightSample SourceTree::sample(const LightQuery& query, float number, glm::vec2 u) const {
    const Choice choice = choose(query, number);
    if (!(choice.chance > 0.0)) return {};
    LightSample sample = lights_[choice.source]->sample(query, choice.left, u);
    sample.light /= static_cast<float>(choice.chance);
    sample.density *= static_cast<float>(choice.chance);
    return sample;
}

float SourceTree::density(std::size_t source, const LightQuery& query, glm::vec3 direction,
                          const core::SurfaceAddress& address) const {
    const float own = lights_[source]->density(query, direction, address);
    return own > 0.0f ? own * static_cast<float>(chance_of(query, source)) : 0.0f;
}

}  // namespace render2mpeg::renderer
