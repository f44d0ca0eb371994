#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "core/tolerance_map.h"
#include "record_gradients_fits.h"

namespace render2mpeg::bench {

inline constexpr int tolerance_count = 2;
inline constexpr float relative_tolerances[tolerance_count] = {0.02f, 0.08f};
inline constexpr int radius_count = 2;
/// Factors that disagreement is multiplied by: fourth roots of two.
inline constexpr int least_trust = -20, most_trust = 28;

inline float trust_of(int k) {
    return std::exp2(0.25f * static_cast<float>(k));
}

/// What one method says with one radius.
struct Judged {
    bool found = false;
    bool instead = false;           ///< Guess::instead
    float error = 0;                ///< luminance, signed
    float off = 0;                  ///< disagreement, luminance
    float over[tolerance_count]{};  ///< disagreement as the product doubts it, over the tolerance
};

/// A pixel between records.
struct Sample {
    float luminance = 0, floor = 0;  ///< of the pixel; half a code value
    bool smooth = false;             ///< the records around see the same lights
    bool has_nearest = false;
    float change = 0, left = 0;  ///< luminance that the nearest record is off by, as it is and with its gradients
    Judged judged[method_count][radius_count];
    /// The product's own estimate: signed error over tolerance by trust, NaN where it does not serve.
    std::vector<float> served[tolerance_count];

    float allowed(int t) const { return core::Tolerance{floor, relative_tolerances[t]}.allows(luminance); }
    float share(float error) const { return std::abs(error) / std::max(luminance, floor); }
};

/// Prints a table.
void report(const std::string& title, const std::vector<Sample>& samples);

}  // namespace render2mpeg::bench
