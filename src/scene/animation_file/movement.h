#pragma once
// Movement and times in an animation file.
#include <functional>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <span>
#include <string_view>
#include <vector>

#include "scene/animation_file/json.h"
#include "scene/model/animation.h"
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

/// Rotation in degrees about z (roll), then x (pitch), then y (yaw).
glm::dquat rotation_of(glm::dvec3 degrees);

/// Track of `rotation_at` over `times`, which rise and hold every possible kink. Keys are so dense that slerp is off by
/// at most 2e-5 rad where it was tested: a fiftieth of a pixel in a picture 1000 pixels wide.
Track rotation_track(const std::function<glm::dquat(double)>& rotation_at, std::vector<double> times, int node);

struct FilmClock {
    double rate = 25;        ///< frames per second
    bool in_frames = false;  ///< times are frame numbers, not seconds
    double end = 0;          ///< seconds at which the last frame ends; 0: the file does not say

    double seconds(const JsonValue& time) const;
};

// chosen: a hand writes tens of keys, a program thousands; each may become 2^14 rotations at worst.
inline constexpr std::size_t most_keys = 10000;
// chosen: each mirrored ray asks all of them; a body of a car has some ten.
inline constexpr std::size_t most_reflections = 64;

/// Reading of one animated quantity.
struct Quantity {
    std::string_view name;
    int width = 1;
    double at_least = -1e7, at_most = 1e7;
    bool monotone = false;     ///< see Curve
    bool accumulates = false;  ///< in a loop every round begins where the last one ended
    bool steps = false;        ///< true or false: never in between
    int reflection = -1;       ///< it is said in this entry of `reflections`; -1: in the thing itself
};

/// A quantity over time: from `keys` that mention it, else the constant, else empty. Throws where both say it, and
/// where times do not rise.
Curve curve_of(const JsonValue& thing, const Quantity& quantity, const FilmClock& clock,
               std::span<const std::string_view> key_names);

/// Reads position, rotate or look_at, roll, scale and visible; sets the node, or replaces its tracks. Things look along
/// -z.
void place(Animation& film, int node, const JsonValue& thing, const FilmClock& clock,
           std::span<const std::string_view> key_names);

int add_node(Animation& film, const std::string& name, int parent);

void add_object(Animation& film, const std::string& name, int node, int mesh, int material);

/// Adds a node for each copy of a thing's `repeat` below its own, `placed`; that one itself without it.
std::vector<int> copies_of(const JsonValue& thing, int placed, Animation& film);

}  // namespace render2mpeg::scene
