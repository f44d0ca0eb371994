#pragma once
// An edit of a mirror's reflection.

namespace render2mpeg::scene {

/// Has the objects at a node show one place at one point (pose/bent_reflections.h). Lengths are those of the node's own
/// space.
struct Reflection {
    int mirror = -1;   ///< node of the objects that mirror
    int at = -1;       ///< node at the point on them; the nearest point of their surface is meant
    int see = -1;      ///< node at the target to be seen there
    float radius = 1;  ///< distance from the point within which the reflection turns as a whole, > 0
    float border = 1;  ///< at least so wide is the ring about it in which the turn fades, > 0
};

}  // namespace render2mpeg::scene
