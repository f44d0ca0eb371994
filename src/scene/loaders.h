#pragma once

#include <filesystem>

#include "scene/isolation/child_trial.h"
#include "scene/load.h"

/// One function per outside format; `load` chooses among them. Each returns what the file says, not yet completed.
namespace render2mpeg::scene {

/// What a file says, by the ending of its name, not yet completed: one of the three below. Throws core::Error for a
/// file that is not there. A loader that refers to another scene file reads it with this.
Animation load_as_is(const std::filesystem::path& file, const LoadOptions& options);

Animation load_gltf(const std::filesystem::path& file, const LoadOptions& options);

/// Every other mesh format (OBJ, PLY, FBX, DAE, 3DS, ...). `take_turns` is told whose code runs.
Animation load_with_assimp(
    const std::filesystem::path& file, const LoadOptions& options, const TakeTurns& take_turns = [](Turn) {});

/// Our own JSON (docs/animation-file.md): loads the scene it refers to (load_as_is) and adds to it. A result that is
/// completed already does no harm; `complete` may be called again.
Animation load_animation_file(const std::filesystem::path& file, const LoadOptions& options);

/// Checks everything that the rest of the program relies on (indices, finite numbers, no cycles, rising keys, sizes
/// that agree) and throws core::Error with file, object and cause; drops triangles that cannot be drawn; sets origin,
/// bounds, mobility and duration; gives a film without camera one, and one without light a light (default_light.h; not
/// if `default_light` is false). Idempotent.
void complete(Animation& animation, bool default_light = true);

}  // namespace render2mpeg::scene
