#pragma once
// The shutter: how long, and when, a frame is exposed.
#include <cmath>

namespace render2mpeg::scene {

/// A rotating shutter as a film's maker knows it.
struct Shutter {
    float angle =
        0;  ///< degrees, 0..360: 180 is open for half the time between two frames; 0: closed, frames are sharp
    float phase = 0;  ///< where the middle of the exposure lies from the frame's own time, in frames, -0.5..0.5

    bool is_open() const { return angle > 0; }
    static bool is_angle(double degrees) { return std::isfinite(degrees) && degrees >= 0 && degrees <= 360; }
    static bool is_phase(double frames) { return std::isfinite(frames) && std::abs(frames) <= 0.5; }
};

/// When the shutter of one frame is open: seconds from the frame's own time.
struct ShutterInterval {
    double opens = 0, closes = 0;  ///< the same: closed
    double frame = 0;              ///< from one frame to the next

    bool is_open() const { return closes > opens; }
    double middle() const { return 0.5 * (opens + closes); }
};

/// Of a film with this many frames per second.
inline ShutterInterval interval_of(const Shutter& shutter, double rate) {
    if (!shutter.is_open()) return {};
    const double half = static_cast<double>(shutter.angle) / 720.0, middle = static_cast<double>(shutter.phase);
    return {(middle - half) / rate, (middle + half) / rate, 1 / rate};
}

}  // namespace render2mpeg::scene
