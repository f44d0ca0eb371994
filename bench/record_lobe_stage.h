#pragma once

#include <memory>
#include <string>
#include <vector>

#include "bench/wishes.h"
#include "renderer/surface/gather_point.h"
#include "renderer/surface/posed_scene.h"
#include "renderer/tree/light_trees.h"

/// What the trials of lobes are lit by, and where.
namespace render2mpeg::bench {

/// Whatever lights a frame.
struct Stage {
    std::shared_ptr<const scene::Animation> animation;
    renderer::PosedScene posed_scene;
    renderer::LightTrees light_trees;
    renderer::Seen seen;
};

/// A pixel and its neighbours.
using Places = std::vector<renderer::GatherPoint>;

inline constexpr int place_count = 13;  ///< a pixel, and the four so far off it to each side

Stage stage_of(const std::string& scene, const Wishes& wishes);

/// Pixels with a lobe whose neighbours to all sides show the same surface.
std::vector<Places> places_of(const renderer::Seen& seen, int count);

}  // namespace render2mpeg::bench
