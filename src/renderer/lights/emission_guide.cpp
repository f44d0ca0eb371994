#include "renderer/lights/emission_guide.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/numeric.h"

namespace render2mpeg::renderer {
namespace {

/// A leaf with fewer paths than this is not halved. chosen: 32; what they leave scatters widely.
constexpr std::size_t least_paths = 32;

/// Halvings from the whole cube down to a leaf at most: 2^-24 of it.
constexpr int most_depth = 24;

constexpr float largest_below_one = 0x1.fffffep-1f;

/// Integral over part of the cube of the square of what paths leave, from those that began there.
double squares(std::span<const GuidedPath> paths, double all) {
    double sum = 0;
    for (const GuidedPath& p : paths) sum += static_cast<double>(p.value) * p.value;
    return sum / all;
}

/// The best mass of part of the cube: its volume times the root of the mean square of what paths leave there.
double mass_of(std::span<const GuidedPath> paths, double volume, double all) {
    return std::sqrt(volume * squares(paths, all));
}

}  // namespace

EmissionGuide::EmissionGuide(std::vector<GuidedPath> paths, std::uint64_t all) {
    if (paths.empty()) return;
    nodes_.emplace_back();
    mass_.push_back(0);
    const double total = grow(0, paths, 1.0, static_cast<double>(all), glm::vec3(0), glm::vec3(1), 0);
    if (total > 0 && std::isfinite(total))
        spread(0, total, 1.0);
    else
        nodes_.clear();
    mass_ = {};
}

/// Halves a part along the axis that tells most apart; returns its mass.
double EmissionGuide::grow(std::uint32_t node, std::span<GuidedPath> paths, double volume, double all, glm::vec3 low,
                           glm::vec3 size, int depth) {
    const double whole = mass_of(paths, volume, all);
    mass_[node] = whole;
    if (paths.size() < 2 * least_paths || depth == most_depth) return whole;
    // The half whose parts have the smallest sum of masses is told apart best (the mass is the root of the variance
    // that is left).
    int best = -1;
    double least = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const float middle = low[axis] + 0.5f * size[axis];
        std::array<double, 2> sums{};
        for (const GuidedPath& p : paths)
            sums[p.numbers[axis] < middle ? 0 : 1] += static_cast<double>(p.value) * p.value;
        const double halves = std::sqrt(0.5 * volume * sums[0] / all) + std::sqrt(0.5 * volume * sums[1] / all);
        // Alike: the longest side.
        const bool longer = best >= 0 && halves < 1.001 * least && size[axis] > size[best];
        if (best < 0 || halves < 0.999 * least || longer) {
            best = axis;
            least = halves;
        }
    }
    const float middle = low[best] + 0.5f * size[best];
    const auto at =
        std::partition(paths.begin(), paths.end(), [&](const GuidedPath& p) { return p.numbers[best] < middle; });
    const auto count = static_cast<std::size_t>(at - paths.begin());
    const auto left = static_cast<std::uint32_t>(nodes_.size());
    nodes_[node].axis = static_cast<std::int8_t>(best);
    nodes_[node].left = left;
    nodes_.resize(left + 2);
    mass_.resize(left + 2);
    glm::vec3 half = size, upper = low;
    half[best] *= 0.5f;
    upper[best] = middle;
    const double lower_mass = grow(left, paths.first(count), 0.5 * volume, all, low, half, depth + 1);
    const double upper_mass = grow(left + 1, paths.subspan(count), 0.5 * volume, all, upper, half, depth + 1);
    mass_[node] = lower_mass + upper_mass;
    return mass_[node];
}

/// Makes shares of masses; `mass` and `volume` are the whole cube's mass and the node's volume.
void EmissionGuide::spread(std::uint32_t node, double mass, double volume) {
    if (nodes_[node].axis < 0) return;
    const std::uint32_t left = nodes_[node].left;
    const auto share = [&](std::uint32_t n) {
        return (1.0 - even_share) * mass_[n] / mass + even_share * 0.5 * volume;
    };
    nodes_[node].left_share = static_cast<float>(share(left) / (share(left) + share(left + 1)));
    spread(left, mass, 0.5 * volume);
    spread(left + 1, mass, 0.5 * volume);
}

EmissionGuide::Start EmissionGuide::start(glm::vec3 numbers) const {
    if (nodes_.empty()) return {numbers, 1.0f};
    glm::vec3 low(0), size(1);
    float density = 1;
    for (std::uint32_t node = 0; nodes_[node].axis >= 0;) {
        const int axis = nodes_[node].axis;
        const float share = nodes_[node].left_share;
        float& u = numbers[axis];
        size[axis] *= 0.5f;
        const bool lower = u < share;
        u = lower ? u / share : (u - share) / (1.0f - share);
        if (!lower) low[axis] += size[axis];
        density *= 2.0f * (lower ? share : 1.0f - share);
        node = nodes_[node].left + (lower ? 0 : 1);
    }
    return {glm::min(low + numbers * size, glm::vec3(largest_below_one)), density};
}

}  // namespace render2mpeg::renderer
