#pragma once
// The unit of estimated errors.
#include <cmath>

namespace render2mpeg::core {

/// Standard error of an estimated luminance: the root of its mean square error. Independent ones add by their squares.
struct StandardError {
    float value = 0;

    StandardError& operator+=(StandardError e) {
        value = std::hypot(value, e.value);
        return *this;
    }
    friend StandardError operator*(float scale, StandardError e) { return {scale * e.value}; }
};

/// Standard errors that one normally distributed value in a hundred exceeds.
inline constexpr float errors_of_one_in_hundred = 2.6f;

/// Standard errors that a tolerance holds where the error is noise, by rays or samples. chosen: 1.3 of 0.7 to 2.6, half
/// of what one point in a hundred exceeds: white noise is hidden by coding twice to four times as well as what is
/// smooth, such as errors of cuts.
inline constexpr float errors_of_noise = 1.3f;

}  // namespace render2mpeg::core
