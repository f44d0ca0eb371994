#pragma once
// Photons of the instant before, kept where nothing on their way has moved.
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "renderer/geometry/ray_tracer.h"
#include "renderer/lights/photon_splat.h"
#include "renderer/lights/photons.h"

namespace render2mpeg::renderer {

/// The paths of one instant, what they left and what they passed. A photon takes the same numbers at every instant, so
/// its path is the same again if it starts from the same lights, met nothing that moves, and nothing that moves has
/// come into its way. What is kept never changes the light: it is what would be found anew.
class KeptPhotons {
  public:
    /// How many hits are kept at most: they take some 240 bytes each. Changing light has 131,072, unless it is asked
    /// for more.
    static constexpr std::size_t most = 1u << 18;

    /// Forgets all unless it started from these lights, beams of light in this box.
    void start(std::span<const LightPoint> lights, const WorldBox& box, std::uint64_t paths);
    void forget() { *this = {}; }

    /// Which of the paths from `first` to `last` (not included) must be followed anew, as `scene` is posed: places
    /// after `first`, rising.
    std::vector<std::uint64_t> changed(std::uint64_t first, std::uint64_t last, const RayTracer& scene) const;

    /// Takes the next paths, `count` of them, in their order: those of `changed` from `traced`, whose hits are `hits`,
    /// the others as they were.
    void take(std::uint64_t count, std::span<const std::uint64_t> changed, const PhotonResult& traced,
              std::span<const PhotonHit> hits);
    /// After all were taken.
    void finish();

    std::span<const PhotonPath> paths() const { return now_.paths; }
    std::span<const PhotonHit> hits() const { return hits_; }
    std::span<KeptShares> shares() { return shares_; }

  private:
    /// All paths and where they pass, in the order of the paths.
    struct Paths {
        std::vector<PhotonPath> paths;
        std::vector<std::size_t> first_place;  ///< of each
        std::vector<glm::vec3> places;

        void reserve(std::uint64_t count, std::size_t place_count);
    };

    static constexpr std::uint32_t none = 0xffffffffu;
    /// Where a hit of this instant comes from: places in hits_ and shares_, rising; none: it is new.
    struct Source {
        std::uint32_t hit, shares;
    };

    bool passes_clear(std::uint64_t path, const RayTracer& scene) const;
    std::uint32_t shares_of(std::uint64_t path, std::uint32_t k, const PhotonHit& hit) const;

    std::vector<LightPoint> lights_;
    WorldBox box_;
    Paths now_, next_;
    std::vector<PhotonHit> hits_;     ///< of now_
    std::vector<KeptShares> shares_;  ///< of each of them
    std::vector<Source> sources_;     ///< of the hits of next_
    std::vector<PhotonHit> new_hits_;
    std::size_t taken_hits_ = 0;  ///< of now_, by those that next_ has
};

}  // namespace render2mpeg::renderer
