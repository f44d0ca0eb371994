#pragma once
// Spreads landed light over gather points.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "core/color.h"
#include "core/numeric.h"
#include "renderer/caustics/caustic_photons.h"
#include "renderer/caustics/splat_lanes.h"
#include "renderer/surface/frame.h"
#include "renderer/surface/posed_scene.h"

namespace render2mpeg::renderer {

/// Footprint of a landing: an ellipse across its way, in which light falls off with the squared distance. [Herzog2007,
/// eq. 4.6]
struct Footprint {
    glm::vec3 across[2]{};  ///< unit vectors across the way
    glm::vec3 turn[2]{};    ///< change of the light's direction by unit of way along these
    float blur = 0;         ///< variance of the direction about that, both axes together; radians squared
    glm::mat2 inverse{1};   ///< of the squared semi-axes' matrix
    float peak = 0;         ///< 2 / (pi r1 r2)
    float widest = 0;       ///< r1; 0: nothing lands
};

/// `pixel`: the least semi-axis; `limit`: the largest.
Footprint footprint_of(const Landing& landing, float pixel, float limit);

/// Light by caustics of one gather point.
struct CausticLight {
    glm::vec3 irradiance{0};     ///< over pi: times the diffuse reflectance it is what is scattered
    glm::vec3 glossy{0};         ///< radiance, of points with a lobe: all that they scatter
    float sum = 0, squares = 0;  ///< of the photons' luminances
    float glossy_squares = 0;    ///< of their luminances in `glossy`

    /// Square of the standard error of as many random photons, over the light.
    float relative_variance() const {
        const float light = core::luminance(glossy);
        const float error =
            light > 0.0f ? std::sqrt(glossy_squares) / light : core::divide_or(std::sqrt(squares), sum, 0.0f);
        return error * error;
    }
};

/// Costs of splatting.
struct SplatCounts {
    std::uint64_t pairs = 0, doubtful = 0;  ///< photons and points; of them those that took a ray
};

/// Whether pairs whose point may lie in the dark ask a ray. [HerzogThesis, 5] `none`: for tests.
enum class SplatVisibility { by_rays, none };

/// The gather points of a frame, by place.
class SplatTree {
  public:
    /// `seen` outlives this.
    explicit SplatTree(const Frame& seen);

    /// Adds landings, each with its footprint, to `light`: as many as there are points, in this tree's order. The same
    /// for any number of threads.
    void add(const PosedScene& posed_scene, std::span<const Landing> landings, std::span<const Footprint> footprints,
             SplatVisibility visibility, std::vector<CausticLight>& light, SplatCounts& counts) const;

    std::size_t size() const { return points_.size(); }
    const GatherPoint& operator[](std::size_t i) const { return *points_[i].point; }
    std::uint32_t tile(std::size_t i) const { return points_[i].tile; }

  private:
    struct Entry {
        glm::vec3 position{0};
        const GatherPoint* point = nullptr;
        std::uint32_t tile = 0, index = 0;
    };
    struct Node {
        glm::vec3 low{0}, high{0};
        std::uint32_t first = 0, last = 0;  ///< points
        std::uint32_t right = 0;            ///< node; 0: a leaf; the left one follows
        std::uint32_t leaf = 0;             ///< of these so many come before
    };
    class Part;
    void build(std::uint32_t first, std::uint32_t last, int depth);
    void fill_lanes();
    void assign(std::uint32_t node, const SplatQuery& query, float reach, std::uint32_t index,
                std::vector<std::vector<std::uint32_t>>& of_part) const;

    std::vector<Entry> points_;
    std::vector<Node> nodes_;
    std::uint32_t leaf_count_ = 0;
    std::vector<SplatPoints> leaves_;
    std::vector<std::uint32_t> parts_;  ///< nodes whose points are spread over by one thread
    std::vector<std::int32_t> part_of_node_;
};

}  // namespace render2mpeg::renderer
