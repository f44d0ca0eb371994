#pragma once
// Splits the error of pixels by cause.
#include <array>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <span>

#include "renderer/truth/pixel_truth.h"

namespace render2mpeg::renderer {

/// Causes of a pixel's difference from the truth (docs/model/truth.md). The first three add up to the last.
enum class ErrorCause : std::uint8_t {
    gathering,     ///< cuts, rays and records, against every light point
    light_points,  ///< places and number of light points, photons, clamps, lobe rays, against paths
    eye_samples,   ///< the gather points, against the whole area of the pixel
    total,
    count
};
inline constexpr std::size_t cause_count = static_cast<std::size_t>(ErrorCause::count);
inline constexpr std::array cause_names{"gathering", "light_points", "eye_samples", "total"};

/// Measure of an error.
enum class ErrorMeasure : std::uint8_t {
    luminance,
    relative,    ///< over the true luminance
    code_value,  ///< of 8-bit luma, unrounded
    count
};
inline constexpr std::size_t measure_count = static_cast<std::size_t>(ErrorMeasure::count);

/// A pixel beside its truth: radiances.
struct ValidatedPixel {
    glm::ivec2 place{0};     ///< on the picture
    glm::vec3 shown{0};      ///< of the picture
    glm::vec3 at_points{0};  ///< by every light point, at its gather points
    float least = 0;         ///< luminance that errors are shares of at least
    PixelTruth truth;
};

/// Sums over pixels of one cause. `squares`: the truth's variance is not in them, so they may come out below 0.
struct CauseSums {
    double difference = 0, difference_squares = 0;            ///< of luminances, signed
    double dark_difference = 0, dark_difference_squares = 0;  ///< 0 for pixels that are not dark
    std::array<double, measure_count> squares{}, square_squares{};
    double block_squares = 0, block_square_squares = 0;      ///< of means of 8x8 pixels, code values
    double flicker_squares = 0, flicker_square_squares = 0;  ///< of changes from frame to frame, code values
};

/// Errors of a pixel in code values: by half of its truth, by cause.
using CodeErrors = std::array<std::array<double, cause_count>, 2>;

/// `luma` tells code values of radiance.
CodeErrors code_errors(const ValidatedPixel& pixel, const std::function<double(glm::vec3)>& luma);

/// A mean and its standard error.
struct MeanError {
    double value = 0, error = 0;
};

/// The error of many pixels by cause: sums that add up over frames and runs.
class ErrorSplit {
  public:
    /// Adds pixels of one frame; the half of them whose truth is darker counts as dark, those that fill a block of 8x8
    /// as a block. `luma` tells code values of radiance.
    void add(std::span<const ValidatedPixel> pixels, const std::function<double(glm::vec3)>& luma);

    /// Adds a point that two frames in a row show, with its errors in both.
    void add_change(const CodeErrors& before, const CodeErrors& now);

    /// Adds the sums of another run.
    void add(const ErrorSplit& others);

    std::uint64_t pixels() const { return sums_.pixels; }
    /// Mean square of the pixels' errors.
    MeanError mean_square(ErrorCause cause, ErrorMeasure measure) const;
    /// Its root; 0 where chance hides it.
    double rms(ErrorCause cause, ErrorMeasure measure) const;
    /// Likewise of the errors' means over blocks of 8x8 pixels, in code values.
    MeanError block_mean_square(ErrorCause cause) const;
    double block_rms(ErrorCause cause) const;
    /// Likewise of the errors' changes from frame to frame at points that both show.
    MeanError flicker_mean_square(ErrorCause cause) const;
    double flicker(ErrorCause cause) const;
    /// Light too much (too little: < 0) over all light, of all pixels and of the darker half.
    MeanError bias(ErrorCause cause) const;
    MeanError dark_bias(ErrorCause cause) const;

    /// All that is to be kept between runs.
    struct Sums {
        std::uint64_t pixels = 0, paths = 0, blocks = 0, followed = 0;
        double light = 0, dark_light = 0;  ///< of the truth
        std::array<CauseSums, cause_count> causes{};
    };
    Sums& sums() { return sums_; }
    const Sums& sums() const { return sums_; }

  private:
    const CauseSums& of(ErrorCause cause) const { return sums_.causes[static_cast<std::size_t>(cause)]; }

    Sums sums_;
};

}  // namespace render2mpeg::renderer
