#pragma once
// Motion while the shutter is open.
#include <cstdint>
#include <vector>

#include "scene/model/shutter.h"
#include "scene/pose/snapshot.h"

namespace render2mpeg::scene {

/// Shutter time of the instant that a snapshot is of; 0: the shutter opens, 1: it closes.
inline constexpr float middle_time = 0.5f;

/// Objects at one instant of the shutter.
struct SweepKnot {
    std::vector<ObjectState> objects;  ///< static ones are as in the snapshot
    std::vector<DeformedMesh> deformed;
};

/// Motion of a snapshot's objects and camera while the shutter is open. Between two knots vertices move linearly, as
/// rays meet them; a surface's own arc deviates from that by less than an eighth of a pixel where eight segments
/// suffice. Objects absent in the middle are absent; objects that jump or are switched stay as in the middle.
struct Sweep {
    ShutterInterval shutter;          ///< of the frame
    std::vector<SweepKnot> knots;     ///< evenly from shutter time 0 to 1; odd many, so that one is the middle; or none
    std::vector<std::uint8_t> moves;  ///< by object: whether knots differ. Empty where there are none
    bool camera_moves = false;

    int segments() const { return static_cast<int>(knots.size()) - 1; }
    bool object_moves(std::uint32_t object) const { return !moves.empty() && moves[object] != 0; }
};

/// Where `time` lies among the knots of so many segments: between one, and the next by this share.
struct SweepPlace {
    std::size_t knot;
    float share;
    SweepPlace(int segments, float time);
};

/// A snapshot's camera at `count` instants that part the shutter's time evenly, each in the middle of its part. Not
/// interpolated.
std::vector<Camera> cameras_over(const Snapshot& snapshot, int count);

/// Position of a surface point at shutter time 0 (`closing` false) or 1, and its image in the camera; none where it is
/// behind the eye. `camera`: of that instant.
std::optional<glm::vec3> swept_position(const core::SurfaceAddress& address, const Snapshot& snapshot, bool closing);

}  // namespace render2mpeg::scene
