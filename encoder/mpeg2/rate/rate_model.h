#pragma once
// How many bits a picture takes by its quantiser, type and followers.
#include <array>
#include <cstdint>
#include <optional>

#include "encoder/mpeg2/picture/minimal_picture.h"
#include "encoder/types.h"

/// Predicts pictures' bits from those coded so far.
namespace render2mpeg::encoder::mpeg2 {

/// The quantiser of a picture over that of a P picture that nothing refers to; `followers`: pictures that depend on it,
/// directly or not.
double quantiser_ratio(PictureType type, std::int64_t followers);

/// The same where only the type and the length of GOPs are known.
double usual_quantiser_ratio(PictureType type, int gop);

/// Of a planned picture.
double ratio_of(const PicturePlan& picture);

/// How a picture's bits fall with its quantiser: overhead + complexity * quantiser^-slope.
/// fit: docs/measurements.md#rates
double rate_slope(PictureType type);

/// Predicted cost of pictures of each type, learned from pictures already coded.
class RateModel {
  public:
    RateModel(const Settings& settings, const MinimalBits& minimal);

    /// Bits of the next picture of a type at a quantiser, >= 1, not necessarily whole.
    double bits(PictureType type, double quantiser) const;
    /// Learns the bits of a representative picture: valid until one of its type is coded.
    void expect(PictureType type, int quantiser, double bits);
    /// Learns the bits of a picture.
    void learn(PictureType type, int quantiser, std::int64_t bits);
    /// Whether it is far more than expected of a type that is known.
    bool surprised(PictureType type, int quantiser, std::int64_t bits) const;
    /// Whether there was a picture of this type.
    bool knows(PictureType type) const { return learned_[static_cast<std::size_t>(type) - 1].has_value(); }

  private:
    double complexity(PictureType type) const;

    double overhead_[3];
    double first_guess_;  ///< complexity of an unknown I picture
    double detail(PictureType type, int quantiser, double bits) const;

    std::array<std::optional<double>, 3> learned_, expected_;
};

/// Ratio of a film's real bits to those of an earlier pass. Pictures may have changed their type since: allocations to
/// future pictures are known by their types then.
class PassModel {
  public:
    /// Bits of a picture that was allocated so much, at another quantiser.
    double bits(PictureType type, const BitAllocation& allocation, double quantiser) const;
    void learn(PictureType type, const BitAllocation& allocation, int quantiser, std::int64_t bits);
    /// Real over allocated bits where the allocated quantisers are used: mean over what was coded lately, of what was
    /// of one type then (of all where there was none of it) and of all.
    double excess(PictureType then) const;
    double excess() const;

  private:
    std::array<std::array<std::optional<double>, 3>, 3> learned_;  ///< by type then, and by type now
    std::array<double, 3> real_{}, expected_{};                    ///< bits by type then, fading
};

}  // namespace render2mpeg::encoder::mpeg2
