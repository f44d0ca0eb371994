#pragma once
// Light that fog scatters of all that is no lamp by itself: sky, shining surfaces, bounced light.
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <unordered_map>
#include <vector>

#include "core/archive.h"
#include "renderer/base/air.h"
#include "renderer/gather/final_gather.h"
#include "renderer/geometry/ray_tracer.h"
#include "renderer/tree/light_trees.h"

namespace render2mpeg::renderer {

/// Light trees, some of them, for light that is smooth in air.
struct SmoothAirLight {
    SmoothAirLight() = default;
    /// Of these light trees and direct light points without points, spots, suns and round lamps; `bounces`: with
    /// bounced light.
    SmoothAirLight(const LightTrees& light_trees, std::span<const LightPoint> points, bool bounces);

    LightTrees trees;
    bool shines = false;

    /// Mean radiance over all directions at places. `rays` counts shadow rays.
    std::vector<glm::vec3> at(const RayTracer& tracer, std::span<const glm::vec3> places, std::uint64_t& rays) const;
};

/// Light from all directions at places of air, on lattices that are fixed in the world, the finer the nearer to the
/// eye: it is smooth, and what is still stays still. Known as long as light stays the same.
class AmbientAir {
  public:
    /// Forgets what is known of another instant's light. `lit_frame` stands for it; `points`: its direct light points.
    /// `gather`: sees what `light_trees` and `points` lack; null: they have all. `bounces`: bounced light counts.
    void start(std::int64_t lit_frame, const LightTrees& light_trees, std::span<const LightPoint> points,
               FinalGather* gather, bool bounces, float extent);

    /// Whether there is any such light.
    bool shines() const { return shines_; }

    /// Makes known what `fluence` is asked for: places, and how far from the eye. Returns the shadow rays.
    std::uint64_t learn(const RayTracer& tracer, std::span<const glm::vec4> places);

    /// Light from all directions over 4 pi at a place so far from the eye.
    glm::vec3 fluence(glm::vec3 place, float distance) const;

    /// Places nearer to the eye are lit as those at this distance.
    float least_distance() const { return least_distance_; }

    /// What is known, and of which instant's light: `start` does not forget that.
    template <class A>
    friend void archive(A& a, AmbientAir& air) {
        auto& [lit_frame, is_known, shines, bounces, least_distance, smooth, gather, known, light] = air;
        a(lit_frame, known, light);
        for (const auto& [corner, place] : known)
            if (place >= light.size()) throw core::Error("light of the air is damaged");
        is_known = is_known || std::is_same_v<A, core::ArchiveReader>;
    }

  private:
    struct Corner;

    std::uint64_t gather(std::span<const Corner> corners, std::size_t first);
    template <class Visit>
    void for_each_corner(glm::vec3 place, float distance, Visit visit) const;

    std::int64_t lit_frame_ = -1;
    bool is_known_ = false;  ///< of `lit_frame_`, but not by which trees
    bool shines_ = false, bounces_ = true;
    float least_distance_ = 1;
    SmoothAirLight smooth_;
    FinalGather* gather_ = nullptr;
    std::unordered_map<std::uint64_t, std::uint32_t> known_;  ///< by corner
    std::vector<glm::vec3> light_;
};

}  // namespace render2mpeg::renderer
