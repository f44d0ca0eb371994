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

struct FilmClock {
    double rate = 25;        ///< frames per second
    bool in_frames = false;  ///< times are frame numbers, not seconds
    double end = 0;          ///< seconds at which the last frame ends; 0: the file does not say

    double seconds(const JsonValue& time) const;
};

/// Reading of one animated quantity.
struct Quantity {
    std::string_view name;
    int width = 1;
    double at_least = -1e7, at_most = 1e7;
    bool monotone = false;     ///< see Curve
    bool accumulates = false;  ///< in a loop every round begins where the last one ended
    bool steps = false;        ///< true or false: never in between
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

/// Nodes of a thing's `repeat`, without name or parent; one at the origin without it.
std::vector<Node> copies_of(const JsonValue& thing);

}  // namespace render2mpeg::scene
