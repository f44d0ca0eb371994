#pragma once

#include <cstdint>
#include <vector>

#include "renderer/cache/records.h"
#include "scene/pose/snapshot.h"

namespace render2mpeg::renderer {

/// Whether two instants have the same light: everything but the camera.
bool same_light(const scene::Snapshot& a, const scene::Snapshot& b);

/// Drops records that the change from one instant to the next leaves no hope for: those on what moves, and those near
/// it, where its shadow is sharp.
void drop_disturbed(Records& records, const scene::Snapshot& before, const scene::Snapshot& now);

/// What light was found to be at a place that older records tell of as well.
struct LightChange {
    Record place;  ///< with the light of now
    glm::vec3 direct_before{0}, indirect_before{0};
    float allowed = 0;  ///< luminance that a white receiver there may be off by
};

/// What became of older records.
struct FollowedRecords {
    std::uint64_t changed = 0, dropped = 0;
};

/// Light has changed. Where the changes found around an older record agree within what is allowed (one is added to all,
/// or all are multiplied by one), it changes as they do; else it is dropped, as is what lies off the picture. `map` is
/// of these records. The same for any number of threads.
FollowedRecords follow(Records& records, const RecordMap& map, const std::vector<LightChange>& changes,
                       const scene::Camera& camera);

}  // namespace render2mpeg::renderer
