#pragma once
// Volumes of an animation file.
#include <filesystem>

#include "scene/animation_file/json.h"
#include "scene/animation_file/movement.h"
#include "scene/model/animation.h"

namespace render2mpeg::scene {

/// Reads `volumes`, after all nodes. Files lie below `folder`.
void read_volumes(const JsonValue& volumes, Animation& film, const std::filesystem::path& folder,
                  const FilmClock& clock);

}  // namespace render2mpeg::scene
