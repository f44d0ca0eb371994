#pragma once
// Begins a frame with light of the last one, and ends it.
#include <cstdint>
#include <vector>

#include "renderer/cache/frame_state.h"

namespace render2mpeg::renderer {

/// Light of a point of the last frame; kept for a frame that shows the very same point.
struct LitPoint {
    core::SurfaceAddress address;
    glm::vec3 outgoing{0}, weight{0};
    std::uint32_t places = 0;  ///< within its pixel that shadow rays left
    PointTolerance tolerance;  ///< that it was within
    PointLight exact, trees;
};

/// The last frame of an eye.
struct FrameHistory {
    std::vector<std::vector<LitPoint>> tiles;  ///< empty: nothing of it holds
    std::int64_t frame = 0;
    float error_scale = 1;  ///< that it was lit with
};

template <class A>
void archive(A& a, FrameHistory& history) {
    auto& [tiles, frame, error_scale] = history;
    a(tiles, frame, error_scale);
}

/// Begins a frame: shares out its tolerances among points, reuses the light of points that are the very same as in the
/// last frame, and gathers the lights that are not clustered where they are not known by that. `reused_error`: factor
/// of the errors of the last frame, which was lit with another error scale.
void start(FrameState& frame, const FrameHistory& history, float reused_error);

/// Keeps what is known of the left eye's points for the right one.
void tell(const FrameState& frame, OtherEye& eye);

/// Ends it: adds the parts of each point's light, and becomes the history of the next frame.
FrameLight finish(FrameState& frame, FrameHistory& history);

}  // namespace render2mpeg::renderer
