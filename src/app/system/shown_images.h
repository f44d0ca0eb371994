#pragma once

#include <set>

#include "scene/model/animation.h"

namespace render2mpeg::app {

/// The images that surfaces or the sky show, by their numbers.
std::set<int> images_of(const scene::Animation& film);

}  // namespace render2mpeg::app
