#pragma once
// Starts a cut from a neighbouring group's splits.
#include <cstdint>
#include <vector>

namespace render2mpeg::renderer {

/// The splits that made a cut, so that other groups on the same surface may begin with those that it could not do
/// without: near points split the same upper clusters, and need not find that out again by their bounds. What is left
/// is bounded and refined as ever, so that every tolerance is kept as without.
struct CutOutline {
    struct Split {
        std::uint32_t part;  ///< child 0 or 1 of split n (2n, 2n + 1), or a tree's root (of_root + tree)
        float priority;      ///< see CutRule
        float tolerance;     ///< of the group's first point when it was so urgent
    };
    static constexpr std::uint32_t of_root = 0x80000000u;

    std::vector<Split> splits;  ///< parents before children; as urgent as when the cut was done
    float enough = 0;           ///< priority that the cut accepted
    float strictness = 0;       ///< of the group's tolerances (CutRule)
    float irradiance = 0;       ///< luminance that the group's points received, over what they reflect

    bool empty() const { return splits.empty(); }
};

}  // namespace render2mpeg::renderer
