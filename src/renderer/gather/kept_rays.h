#pragma once
// Gather rays of a record, kept for when light changes.
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include "core/packed_normal.h"
#include "renderer/base/light_packing.h"
#include "renderer/cut/point_light.h"
#include "renderer/gather/surface_cache.h"
#include "renderer/surface/gather_point.h"

namespace render2mpeg::renderer {

/// A gather ray and the cell that it met [Smyk2005]: it brings `light`, times the cell's radiance if it met any.
struct KeptGatherRay {
    /// No index: the cell was its own, and is evaluated again at every change.
    static constexpr std::uint32_t own = CellTable::none - 1;

    core::PackedNormal direction;
    float far = 0;
    PackedLight light{};
    std::uint32_t cell = CellTable::none;
    std::array<std::uint16_t, 3> weights{};  ///< in the parts of RayLight: `short_float`

    bool has_cell() const { return cell < own; }
};

/// The upper half of a float >= 0, rounded.
inline std::uint16_t short_float(float value) {
    return static_cast<std::uint16_t>((std::bit_cast<std::uint32_t>(std::min(value, 1e38f)) + 0x8000u) >> 16);
}
inline float long_float(std::uint16_t value) {
    return std::bit_cast<float>(static_cast<std::uint32_t>(value) << 16);
}

/// All of a point.
struct KeptRays {
    glm::vec3 origin{0}, normal{0, 0, 1};
    float extent = 0;                   ///< GatherRequest
    std::uint64_t seed = 0;             ///< likewise
    std::uint64_t pool = 0;             ///< of points that were gathered together; none other has its number
    std::uint32_t count = 0;            ///< of rays, those that could meet nothing among them
    float brighter = 1;                 ///< luminance, over that by which their number was chosen
    bool is_lost = false;               ///< some of its light is none of these rays'
    std::array<glm::vec3, 3> mean{};    ///< RayLight's parts by these rays, as of the last instant
    std::array<glm::vec3, 3> change{};  ///< added to them by the last change of light
    std::vector<KeptGatherRay> rays;
    GatherPoint receiver{};                  ///< that is lit
    PointTolerance tolerance{};              ///< within which
    std::uint8_t set = 0;                    ///< of representatives
    std::array<glm::vec3, 4> trees{};        ///< light trees' light: direct, indirect, the lobe's parts
    std::array<glm::vec3, 4> tree_change{};  ///< added to it by the last change

    /// Takes more rays of the same point.
    void add(const KeptRays& more);
    /// RayLight's parts by these rays, as cells are.
    std::array<glm::vec3, 3> sum(const SurfaceCache& cells) const;
};

/// Rays that are kept, at most: 768 MB. chosen: a film that has more gathers what is beyond anew in every frame.
inline constexpr std::size_t most_kept_rays = std::size_t{1} << 25;

}  // namespace render2mpeg::renderer
