#pragma once

#include <memory>
#include <string>

#include "renderer/base/plan.h"
#include "renderer/renderer.h"
#include "scene/model/animation.h"
#include "scene/pose/snapshot.h"

namespace render2mpeg::bench {

/// A film and how it is to be lit, at one frame.
struct Subject {
    std::shared_ptr<const scene::Animation> animation;
    renderer::Plan plan{{}};
    renderer::Settings settings;
    scene::Snapshot world;
};

/// `scene`: one of the films of mover_scenes.h, or a file. Throws core::Error where it cannot be read.
Subject subject(const std::string& scene, int frame, int width, int height);

/// The film that a test's builder made.
Subject subject(scene::Animation animation, int frame, int width, int height);

}  // namespace render2mpeg::bench
