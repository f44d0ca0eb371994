#pragma once
// Exact fractions, for time.
#include <cstdint>
#include <string>
#include <vector>

namespace render2mpeg::core {

/// An exact fraction, so that frame 1000000 of a 29.97 Hz film has the time it should have.
struct Rational {
    std::int64_t num = 0;
    std::int64_t den = 1;  ///< > 0

    double value() const { return static_cast<double>(num) / static_cast<double>(den); }
    bool operator==(const Rational&) const = default;
};

/// "16:9" or "2.21:1": positive numbers with at most three decimals, up to 10000, in lowest terms. Throws Error.
Rational ratio_from(const std::string& text);

/// "16:9"; where neither number is below 100 "2.39:1".
std::string text_of(Rational ratio);

/// In lowest terms.
Rational product(Rational a, Rational b);

/// A frame rate.
struct FrameRate {
    Rational hertz;    ///< pictures per second
    int code = 0;      ///< MPEG-2's frame_rate_code, 1..8 [H262, table 6-4]; 0: none of those
    std::string name;  ///< as users write it: "29.97", "12", "25/2"
};

/// MPEG-2's eight, in the order of their codes.
const std::vector<FrameRate>& mpeg2_frame_rates();

/// The rate a user means by "25", "29.97", "30000/1001", "12.5" or "15", from 0.1 to 240. Throws Error otherwise.
FrameRate frame_rate_from(const std::string& text);

/// Time of frame n in seconds, exactly n / rate.
Rational time_of(std::int64_t frame, const FrameRate& rate);

}  // namespace render2mpeg::core
