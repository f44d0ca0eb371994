#pragma once
// Movement and times in an animation file.
#include <glm/glm.hpp>
#include <span>
#include <string_view>
#include <vector>

#include "scene/animation_file/curve.h"
#include "scene/animation_file/json.h"
#include "scene/model/animation.h"

namespace render2mpeg::scene {

/// What times mean in one animation file.
struct FilmClock {
    double rate = 25;        ///< frames per second
    bool in_frames = false;  ///< times are frame numbers, not seconds
    double end = 0;          ///< seconds at which the last frame ends; 0: the file does not say

    /// Seconds of a time as the file writes it.
    double seconds(const JsonValue& time) const;
};

/// How one quantity of a thing is read.
struct Quantity {
    std::string_view name;
    int width = 1;
    double at_least = -1e7, at_most = 1e7;
    bool monotone = false;     ///< see Curve
    bool accumulates = false;  ///< in a loop every round begins where the last one ended
    bool steps = false;        ///< true or false: never in between
};

/// The values of a quantity over time: from the thing's `keys` that mention it, else its own constant value, else
/// empty. Throws where both say it, and where times do not rise. A quantity of width 3 may be one number where `spread`
/// says what that means.
Curve curve_of(const JsonValue& thing, const Quantity& quantity, const FilmClock& clock,
               std::span<const std::string_view> key_names);

/// Where and how a thing stands: position, rotate or look_at, roll, scale, visible, as far as its keys may say them.
/// Sets the node, or adds tracks in place of those that it has. A thing that looks at something shows it its -z.
void place(Animation& film, int node, const JsonValue& thing, const FilmClock& clock,
           std::span<const std::string_view> key_names);

/// One more node.
int add_node(Animation& film, const std::string& name, int parent);

/// One more object: a mesh at a node.
void add_object(Animation& film, const std::string& name, int node, int mesh, int material);

/// The copies that a thing's `repeat` asks for, as nodes without name or parent: one at the origin where there is none.
std::vector<Node> copies_of(const JsonValue& thing);

}  // namespace render2mpeg::scene
