#pragma once
// Curves over time in an animation file.
#include <functional>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <span>
#include <vector>

#include "scene/model/track.h"

namespace render2mpeg::scene {

/// Interpolation of an animation file. `smooth`: cubic without a kink, flat between equal keys. `ease`: stops at every
/// key.
enum class Passage { smooth, ease, linear, step };

/// One animated quantity: numbers at rising times (seconds). Constant before the first key and after the last.
struct Curve {
    int width = 1;
    Passage passage = Passage::smooth;
    std::vector<double> times;
    std::vector<double> values;  ///< `width` for each time
    /// Stays between neighbouring keys, for factors and angles >= 0.
    bool monotone = false;

    bool empty() const { return times.empty(); }
    void add(double time, std::span<const double> value);
    /// Writes `width` numbers. Needs a key.
    void sample(double seconds, std::span<double> out) const;
};

/// Seconds in a track's precision, rounded down, so that a switch at a frame's time acts at that frame.
float track_time(double seconds);

/// The curve as a track, `factor` times its values.
Track track_of(const Curve& curve, TrackTarget target, int index, double factor = 1);

/// The turn of so many degrees about z (roll), then x (pitch), then y (yaw).
glm::dquat rotation_of(glm::dvec3 degrees);

/// Track of `rotation_at` over `times`, which rise and hold every possible kink. Keys are so dense that slerp is off by
/// at most 2e-5 rad where it was tested: a fiftieth of a pixel in a picture 1000 pixels wide.
Track rotation_track(const std::function<glm::dquat(double)>& rotation_at, std::vector<double> times, int node);

}  // namespace render2mpeg::scene
