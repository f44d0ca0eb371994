#include "renderer/geometry/layer_limit.h"

namespace render2mpeg::renderer {

LayerLimit::LayerLimit(const scene::Animation& animation) {
    if (!animation.layers) return;
    most_ = *animation.layers;
    limited_.reserve(animation.objects.size());
    for (const scene::Object& object : animation.objects) {
        const auto material = static_cast<std::size_t>(object.material);
        limited_.push_back(animation.materials[material].alpha_mode != scene::AlphaMode::opaque);
    }
}

}  // namespace render2mpeg::renderer
