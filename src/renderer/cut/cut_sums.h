#pragma once
// Sums light over clusters in two levels, for accuracy.
#include "renderer/cut/gathered_light.h"
#include "renderer/tree/light_kernels.h"

namespace render2mpeg::renderer {

/// Sums of gathered light over clusters, in two levels: few numbers are added to a part, parts to the whole, so that a
/// sum over a million lights in single precision keeps its digits. The order of calls decides the bytes.
class CutSums {
  public:
    explicit CutSums(const GatherLanes& lanes);

    /// Adds a cluster's light.
    void add(const UnitLight& unit, const glm::vec3& intensity, bool direct);

    /// Adds irradiance, a share of it in each lane.
    void add(const RgbLanes& irradiance, const Lanes& share, bool direct);

    /// Adds a light of its own in each lane; nothing translucent.
    void add(const UnitLight& unit, const Vec3Lanes& intensity, bool direct);

    /// Counts what the clamp took from a cluster: the difference to what its light sends when only the form factor of a
    /// whole sky bounds it, G <= 1 / disc2; the unclamped sum has no finite variance to be measured.
    void add_clamped(const TreeLight& light, const UnitLight& visible, const glm::vec3& intensity, GeometryClamp clamp);

    void store(GatheredLight& out);

  private:
    static constexpr int part_length = 64;
    struct Part {
        RgbLanes direct, indirect, f0, schlick;
    };
    void flush();

    const GatherLanes& lanes_;
    int in_part_ = 0;
    Part part_{}, whole_{};
    alignas(64) Lanes clamped_{};
};

}  // namespace render2mpeg::renderer
