// Lightcuts [Walter2005, 4; Render2MPEG, algorithm 3] for groups of up to sixteen points. Changed: the points of a
// group share one cut, and with it one packet of shadow rays per refined cluster, but each keeps its own bounds,
// luminance and tolerance; the cut is refined until every point accepts it. All trees share one queue, so that direct
// and indirect light are held against the pixel's total.
#include "renderer/cut/cut.h"

#include <algorithm>

#include "renderer/base/isa_clones.h"

namespace render2mpeg::renderer {
namespace {

/// Squares of bounds larger than this (in units of a point's tolerance) leave no digits of the others in a running
/// sum. chosen: 1e8, which leaves half of a double's; clusters that hold the point itself reach 1e30.
constexpr float drowning_priority = 1e8f;

constexpr std::uint16_t all_lanes = 0xffff;

RENDER2MPEG_ALWAYS_INLINED float finite(float bound) {
    return bound < std::numeric_limits<float>::max() ? bound : std::numeric_limits<float>::max();
}

}  // namespace

void Cut::start(const GatherLanes& lanes, const GroupTolerance& tolerance, const CutLimits& limits,
                const Lanes& exact_luminance, ShadowTester& shadows) {
    lanes_ = &lanes;
    shadows_ = &shadows;
    rule_.start(limits.error_scale, tolerance);
    std::copy(std::begin(exact_luminance), std::end(exact_luminance), std::begin(exact_luminance_));
    most_ = static_cast<std::size_t>(std::max(limits.most, 1));
    next_look_ = static_cast<std::size_t>(std::max(limits.least, 0));
    summed_ = accepted_ = false;
    limiting_ = no_cluster;
    clusters_.start(lanes, light_trees_);
    queue_.clear();
    for (int t = 0; t < LightTrees::tree_count; ++t) {
        const LightTree& tree = light_trees_.trees[t];
        if (tree.empty()) continue;
        const std::uint32_t index = clusters_.add(t, tree.root);
        clusters_[index].representative = tree.representative(tree.root, lanes.set);
        LightContribution contribution = LightContribution::unknown_in(all_lanes);
        trace(index, contribution);
    }
    sum_luminance();
    for (std::uint32_t i = 0; i < clusters_.size(); ++i) bound_and_queue(i);
}

/// Evaluates the cluster's representative, visibility included.
void Cut::trace(std::uint32_t index, LightContribution& contribution) {
    Cluster& cluster = clusters_[index];
    const LightTree& tree = light_trees_.trees[cluster.tree];
    cluster.intensity = tree.intensity(cluster.ref);
    shadows_->trace(tree.type, tree.lights[cluster.representative], tree.spot(cluster.representative),
                    light_trees_.clamp(cluster.tree), light_trees_.bodies_before(cluster.tree), contribution,
                    cluster.tree == LightTrees::dynamic_tree);
    clusters_.set(index, contribution);
}

/// Bounds a cluster's luminance in every lane; queues it for refinement if some lane could notice.
RENDER2MPEG_CLONES
void Cut::bound_and_queue(std::uint32_t index) {
    Cluster& cluster = clusters_[index];
    cluster.is_open = false;
    std::fill(std::begin(cluster.bound), std::end(cluster.bound), 0.0f);
    if (cluster.ref.is_leaf()) return;
    const LightTree& tree = light_trees_.trees[cluster.tree];
    bound_node(*lanes_, tree, cluster.ref.index(), light_trees_.clamp(cluster.tree), cluster.bound);
    const float priority = rule_.priority(cluster.bound);
    if (!(priority > 0.0f)) return;
    cluster.is_open = true;
    queue_.push(priority, index);
}

RENDER2MPEG_CLONES
void Cut::refine() {
    const std::uint32_t index = queue_.pop();
    const glm::vec3 whole = clusters_[index].intensity;
    if (summed_) add_square(index, -1.0);
    const std::uint32_t added = split(index);

    const glm::vec3& rest = clusters_[index].intensity;
    const glm::vec3 change{rest.x - whole.x, rest.y - whole.y, rest.z - whole.z};
    add_luminance(*lanes_, clusters_.unit(index), change, luminance_);
    add_luminance(*lanes_, clusters_.unit(added), clusters_[added].intensity, luminance_);
    rule_.observe(luminance_);
    bound_and_queue(index);
    bound_and_queue(added);
    if (!summed_) return;
    add_square(index, 1.0);
    add_square(added, 1.0);
}

/// Replaces a cluster's node by the child that keeps its representative, and its rays; the other child is the new
/// cluster that is returned.
std::uint32_t Cut::split(std::uint32_t index) {
    const LightTree& tree = light_trees_.trees[clusters_[index].tree];
    const LightRef parent = clusters_[index].ref;
    const bool first_keeps = tree.first_represents(parent, lanes_->set);
    const std::uint32_t added = clusters_.add(clusters_[index].tree, tree.child(parent.index(), first_keeps ? 1 : 0));
    Cluster& kept = clusters_[index];
    Cluster& other = clusters_[added];
    other.representative = tree.other_representative(parent, kept.representative, lanes_->set);
    LightContribution contribution = clusters_.inherited(index);
    trace(added, contribution);

    kept.ref = tree.child(parent.index(), first_keeps ? 0 : 1);
    kept.intensity = tree.intensity(kept.ref);
    return added;
}

bool Cut::is_fine_enough() {
    // Keep a running sum once its largest parts are gone; it is checked against a fresh one.
    if (!summed_ && queue_.priority() < drowning_priority) {
        sum_afresh();
        summed_ = true;
    }
    if (!summed_ || clusters_.size() < next_look_ || !seems_safe()) return false;
    accepted_ = is_safe();
    next_look_ = clusters_.size() + 1 + clusters_.size() / 32;
    return accepted_;
}

/// Whether it is worth a look at all clusters.
bool Cut::seems_safe() {
    if (rule_.satisfied(sum_of_squares_)) return true;
    const auto limits = [this](std::uint32_t i) { return rule_.is_limiting(clusters_[i].bound, sum_of_squares_); };
    return queue_.priority() <= StoppingRule::safe_priority(lanes_->count) && !limits(queue_.front()) &&
           (limiting_ == no_cluster || !limits(limiting_));
}

/// Looks at all clusters. Where they are not safe, ranks them anew, since tolerances have moved.
bool Cut::is_safe() {
    sum_afresh();
    if (rule_.broken(sum_of_squares_, largest_) == 0) return true;
    queue_.clear();
    // Of those that are limiting note the one that would come last.
    limiting_ = no_cluster;
    float last = std::numeric_limits<float>::max();
    for (std::uint32_t i = 0; i < clusters_.size(); ++i) {
        if (!clusters_[i].is_open) continue;
        const float priority = rule_.priority(clusters_[i].bound);
        queue_.push(priority, i);
        if (priority >= last || !rule_.is_limiting(clusters_[i].bound, sum_of_squares_)) continue;
        limiting_ = i;
        last = priority;
    }
    return false;
}

RENDER2MPEG_CLONES
void Cut::add_square(std::uint32_t index, double sign) {
    const Cluster& cluster = clusters_[index];
    for (int i = 0; i < lane_count; ++i) {
        const double bound = finite(cluster.bound[i]);
        sum_of_squares_[i] += sign * (bound * bound);
    }
}

RENDER2MPEG_CLONES
void Cut::sum_luminance() {
    alignas(64) Lanes sum;
    for (int i = 0; i < lane_count; ++i) sum[i] = exact_luminance_[i];
    const std::size_t count = clusters_.size();
    for (std::size_t c = 0; c < count; ++c) add_luminance(*lanes_, clusters_.unit(c), clusters_[c].intensity, sum);
    for (int i = 0; i < lane_count; ++i) luminance_[i] = sum[i];
    rule_.observe(luminance_);
}

/// Luminance, squared and largest bounds of all clusters.
RENDER2MPEG_CLONES
void Cut::sum_afresh() {
    sum_luminance();
    alignas(64) double squares[lane_count] = {};
    alignas(64) Lanes largest = {};
    const std::size_t count = clusters_.size();
    for (std::size_t c = 0; c < count; ++c) {
        const Cluster& cluster = clusters_[c];
        for (int i = 0; i < lane_count; ++i) {
            const double bound = finite(cluster.bound[i]);
            squares[i] += bound * bound;
        }
        for (int i = 0; i < lane_count; ++i) largest[i] = inlined::max(largest[i], finite(cluster.bound[i]));
    }
    for (int i = 0; i < lane_count; ++i) sum_of_squares_[i] = squares[i];
    for (int i = 0; i < lane_count; ++i) largest_[i] = largest[i];
}

void Cut::estimate_errors(GatheredLight& out) {
    if (!accepted_) {
        sum_afresh();
        out.capped |= rule_.broken(sum_of_squares_, largest_);
    }
    for (int i = 0; i < lane_count; ++i) out.error[i] = rule_.error(i, sum_of_squares_[i], largest_[i]);
}

}  // namespace render2mpeg::renderer
