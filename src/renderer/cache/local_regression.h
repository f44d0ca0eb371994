#pragma once
// Weighted local regression among records, of the order and radius that promise the least error.
#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "renderer/cache/glossy_record.h"

namespace render2mpeg::renderer {

/// Errors of a local regression at a point: squares of luminance of its pixel.
struct RegressionError {
    double square = 0;          ///< mean square: variance of rays, plus the square of a plane's bias
    double variance = 0;        ///< the first part
    double of_block = 0;        ///< of it that the mean of 8x8 pixels about the point has
    double batch_variance = 0;  ///< of the mean of 8 rays there (RayLight)
    double variance_share = 1;  ///< of the variance of one record that is left
    int radius = -1;            ///< pixels; 0: one record alone; -1: there is no estimate
    bool is_valid() const { return radius >= 0; }
};

/// Light at a gather point by the records about it [Moon2014]: planes of weighted least squares, bent alike in all
/// directions, through those within 1, 2, 4 and 6 pixels that lie on its surface, and a record in its place alone. The
/// one with the least estimated mean square error is taken, its bias estimated by the distance of records from the
/// plane beyond their rays' variance (docs/model/irradiance-cache.md). Planes lie over the picture.
class LocalRegression {
  public:
    enum class Of {
        all_light,   ///< light that records send into the pixel, in the point's material
        rays_light,  ///< light of their rays alone, for the plain receiver in its place (receiver.h)
        /// Residual m - c m0 of the control variate: pilots of the last instant beyond `factor` times those of
        /// baselines.
        change
    };
    /// A record as an unknown one.
    static constexpr std::uint32_t none = 0xffffffffu;

    /// Finds the records about a point; `own` is the record of the point itself, if it has one.
    void collect(const CacheQuery& query, Of of, const RecordGrid& grid, const RecordStore& records,
                 std::uint32_t own = none);
    /// Chooses among the estimates.
    RegressionError estimate();

    /// Light now over that of the baselines, which explains most of what pilots find; after `collect` of changes.
    double factor() const { return factor_; }
    /// Variance of the mean of 8 rays now, likewise: luminance of the pixel, squared.
    float batch_variance_now() const { return batch_variance_now_; }

    /// Number of records that may take part, and their part of it: the weights of the last estimate, which sum to 1.
    std::size_t size() const { return members_.size(); }
    float weight(std::size_t i) const { return weights_[i]; }
    std::uint32_t record(std::size_t i) const { return members_[i].record; }
    const SeenLobe& lobe(std::size_t i) const { return members_[i].lobe; }

  private:
    struct Member {
        std::uint32_t record = 0;
        bool is_own = false;  ///< the point's, or one in its place
        SeenLobe lobe;
    };
    static constexpr std::size_t member_lanes = 8;
    using MemberValues = std::array<float, member_lanes>;
    /// Members side by side, for vector code; those beyond the last are far away.
    struct alignas(32) MemberLanes {
        MemberValues x{}, y{};          ///< from the point, pixels
        MemberValues distance2{};       ///< square of its length
        MemberValues value{};           ///< luminance of the pixel
        MemberValues precision{};       ///< by which it is weighted
        MemberValues batch_share{};     ///< variance of its rays' mean over that of a batch
        MemberValues batch_variance{};  ///< luminance of the pixel, squared
    };
    struct Plane;
    void explain_change(const GatherPoint& plain, const RecordStore& records, float receives2);
    MemberLanes& lanes_of(std::size_t i) { return lanes_[i / member_lanes]; }
    void fit_plane(int radius, double common, RegressionError& best);
    void take_own(RegressionError& best);

    bool crowded_ = false, priced_ = false;  ///< CacheQuery
    double alike_ = 1;                       ///< points of the pixel that get the same light, with its noise
    std::vector<Member> members_;
    std::vector<MemberLanes> lanes_;
    std::vector<float> weights_, plane_;
    double factor_ = 1;
    float batch_variance_now_ = 0;
};

}  // namespace render2mpeg::renderer
