#pragma once
// Rate control: chooses quantisers before a picture is lit, and when it is coded.
#include <array>
#include <cstdint>
#include <map>
#include <optional>

#include "encoder/mpeg2/bitstream/levels.h"
#include "encoder/mpeg2/rate/rate_model.h"
#include "encoder/mpeg2/rate/vbv_schedule.h"
#include "encoder/types.h"

/// Chooses the quantisers of pictures by the rate mode.
namespace render2mpeg::encoder::mpeg2 {

/// Chooses each picture's quantiser twice: before it is lit, and finally when it is coded, at most a step away (except
/// for the first pictures of a chunk). VBV violations are handled in fitting.h.
///
/// The modes with a bit rate solve one equation: with quantiser k for I and P pictures and its ratio for B pictures,
/// the pictures that are left in the chunk take the bits that are left in the chunk. So the quantiser is constant as
/// far as the rate model is right, and the model's errors are spread over all pictures that follow.
class RateController {
  public:
    RateController(const Settings& settings, const Channel& channel, const MinimalBits& minimal);

    /// The quantiser to render a picture for. Pictures come in display order; `schedule` knows this one already.
    int plan(const PicturePlan& picture, const PictureFacts& facts, bool first_of_chunk, const VbvSchedule& schedule);
    /// The quantiser for coding a planned picture. If its type has changed since, it is chosen anew. If no picture of
    /// its type was known when it was planned, it may become coarser by any number of steps.
    int coding_quantiser(const PicturePlan& picture, const VbvSchedule& schedule);
    /// A coarser quantiser for a picture that took far more bits than expected, else the one it has: the first picture
    /// of each type is planned without knowledge, and a film may become harder at once. Never finer: it was lit for no
    /// more.
    int reconsider(const PicturePlan& picture, int quantiser, std::int64_t bits, const VbvSchedule& schedule);
    /// Records the actual cost of a picture, with stuffing included in `bits_sent`.
    void record(const PicturePlan& picture, int quantiser, std::int64_t bits, std::int64_t bits_sent);

  private:
    /// A picture planned but not coded.
    struct InFlight {
        PictureType type;
        int quantiser;
        std::optional<BitAllocation> allocation;
        double quality_factor;
        double ratio;          ///< of its quantiser to that of P pictures that nothing refers to
        bool guessed = false;  ///< planned before any picture of its type was coded
    };

    int rounded(const InFlight& entry, double wanted);
    double damped(double solved);
    double nominal(std::int64_t number, const InFlight& picture, const VbvSchedule& schedule);
    double bits(const InFlight& picture, double quantiser) const;
    /// Bits of a picture and all not planned yet under their allocation.
    double bits_as_allocated(const InFlight& picture) const;
    /// Numbers of I, P and B pictures not planned yet, as far as the horizon.
    std::array<double, 3> foreseen() const;
    double bits_of_rest(const std::array<double, 3>& rest, double quantiser) const;
    double bits_for_rest(std::int64_t number, const VbvSchedule& schedule) const;
    double limited(std::int64_t number, const InFlight& picture, double quantiser, const VbvSchedule& schedule) const;
    std::int64_t horizon() const;

    Settings settings_;
    Channel channel_;
    RateModel model_;
    PassModel pass_;
    std::map<std::int64_t, InFlight> in_flight_;

    std::int64_t chunk_start_ = 0;
    std::optional<std::int64_t> chunk_end_;  ///< first number after the chunk, if known
    bool hands_over_ = false;
    std::int64_t gop_start_ = 0;              ///< of the picture planned last
    std::int64_t planned_end_ = 0;            ///< first number not planned
    std::array<std::int64_t, 3> planned_{};   ///< pictures of the chunk, by type
    double spent_ = 0;                        ///< bits of the chunk so far
    double allocated_ = 0;                    ///< to the whole chunk, where there are allocations
    std::array<double, 3> allocated_rest_{};  ///< of it to pictures not planned yet, by type
    int reference_quantiser_ = 1;             ///< of the newest I or P picture planned
    double solved_ = 0;                       ///< by the last call of nominal
    int coded_in_chunk_ = 0;                  ///< pictures
    double steady_ = 0;    ///< steady state after the last picture: base quantiser or correction; 0: too early
    double rounding_ = 0;  ///< bits that rounding of quantisers has cost or saved lately
};

}  // namespace render2mpeg::encoder::mpeg2
