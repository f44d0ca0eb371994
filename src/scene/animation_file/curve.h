#pragma once
// Curves over time in an animation file.
#include <functional>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <span>
#include <vector>

#include "scene/model/track.h"

namespace render2mpeg::scene {

/// How an animation file goes from key to key. `smooth`: through the keys without a kink (cubic); what is the same at
/// two neighbouring keys stays so between them. `ease`: stands still at every key. `linear`: straight. `step`: jumps.
enum class Passage { smooth, ease, linear, step };

/// One animated quantity: numbers at rising times (seconds). Constant before the first key and after the last.
struct Curve {
    int width = 1;
    Passage passage = Passage::smooth;
    std::vector<double> times;
    std::vector<double> values;  ///< `width` for each time
    /// Never leaves the range between two neighbouring keys: for factors and angles that must not become negative.
    bool monotone = false;

    bool empty() const { return times.empty(); }
    void add(double time, std::span<const double> value);
    /// Writes `width` numbers. Needs a key.
    void sample(double seconds, std::span<double> out) const;
};

/// Seconds in a track's precision, rounded down: a switch that is thrown at a frame's time is thrown at that frame, not
/// at the next.
float track_time(double seconds);

/// The same curve as a track, exactly, `factor` times its values.
Track track_of(const Curve& curve, TrackTarget target, int index, double factor = 1);

/// The turn of so many degrees about z (roll), then x (pitch), then y (yaw).
glm::dquat rotation_of(glm::dvec3 degrees);

/// A track of rotations that follows `rotation_at` from the first of `times` to the last. Its keys lie so dense that
/// the straight way between two of them is never off by more than 2e-5 rad where it was tested: a fiftieth of a pixel
/// in a picture 1000 pixels wide. `times` rise and hold every instant at which the motion may have a kink.
Track rotation_track(const std::function<glm::dquat(double)>& rotation_at, std::vector<double> times, int node);

}  // namespace render2mpeg::scene
