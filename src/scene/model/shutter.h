#pragma once
// The shutter: how long, and when, a frame is exposed.
#include <cmath>

namespace render2mpeg::scene {

/// A rotating shutter.
struct Shutter {
    float angle =
        0;  ///< degrees, 0..360: 180 is open for half the time between two frames; 0: closed, frames are sharp
    float phase = 0;    ///< where the middle of the exposure lies from the frame's own time, in frames, -0.5..0.5
    float rolling = 0;  ///< how much later the picture's last row is exposed than its first, in frames, 0..1

    bool is_open() const { return angle > 0; }
    static bool is_angle(double degrees) { return std::isfinite(degrees) && degrees >= 0 && degrees <= 360; }
    static bool is_phase(double frames) { return std::isfinite(frames) && std::abs(frames) <= 0.5; }
    static bool is_rolling(double frames) { return frames >= 0 && frames <= 1; }
};

/// Opening of one frame's shutter: seconds from the frame's time.
struct ShutterInterval {
    double opens = 0, closes = 0;  ///< of all rows together; the same: closed
    double frame = 0;              ///< from one frame to the next
    double rolls = 0;              ///< from when the first row opens to when the last does

    bool is_open() const { return closes > opens; }
    double middle() const { return 0.5 * (opens + closes); }

    /// Shutter time 0..1 of all rows for a row's own `time`; `down`: 0 at the top row, 1 at the bottom.
    float of_row(float time, float down) const {
        if (!(rolls > 0)) return time;
        const auto share = static_cast<float>(rolls / (closes - opens));
        return std::fmin(std::fmax((1 - share) * time + share * down, 0.0f), 1.0f);
    }
};

inline ShutterInterval interval_of(const Shutter& shutter, double rate) {
    if (!shutter.is_open()) return {};
    const double rolls = static_cast<double>(shutter.rolling),
                 half = static_cast<double>(shutter.angle) / 720.0 + rolls / 2,
                 middle = static_cast<double>(shutter.phase);
    return {(middle - half) / rate, (middle + half) / rate, 1 / rate, rolls / rate};
}

}  // namespace render2mpeg::scene
