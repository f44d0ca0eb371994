#include "renderer/geometry/layer_limit.h"

namespace render2mpeg::renderer {

LayerLimit::LayerLimit(const scene::Animation& animation, int most_counted) {
    if (!animation.layers || *animation.layers >= most_counted) return;
    most_ = *animation.layers;
    limited_.reserve(animation.objects.size());
    for (const scene::Object& object : animation.objects) {
        const auto material = static_cast<std::size_t>(object.material);
        limited_.push_back(animation.materials[material].alpha_mode != scene::AlphaMode::opaque);
    }
}

}  // namespace render2mpeg::renderer
