// Peculiarities of glTF exporters: Blender's units of light, and unticked boxes.
#include <algorithm>
#include <cstdio>
#include <utility>

#include "scene/gltf/parts.h"
#include "scene/model/wording.h"

namespace render2mpeg::scene::gltf {
namespace {

/// Version of Blender's exporter; 0, 0 for another one.
std::pair<int, int> blender_exporter(const Document& document) {
    const std::optional<Element> asset = document.root().object("asset");
    const std::string generator = asset ? asset->string("generator", "") : "";
    int major = 0, minor = 0;
    const int read = std::sscanf(generator.c_str(), "Khronos glTF Blender I/O v%d.%d", &major, &minor);
    return read == 2 ? std::pair(major, minor) : std::pair(0, 0);
}

/// Whether lamps are photometric: from version 3.4 on Blender's exporter multiplies by 683 lm/W by default, and does
/// not say so.
bool lamps_are_photometric(const Animation& animation) {
    // chosen: between what the brightest of a film's lamps are in either: suns of 0.1 to 10 W/m2 are 68 lx and more, or
    // 10 and less; points of 5 to 1500 W are 270 cd and more, or 120 and less.
    constexpr float least_lux = 30, least_candela = 150;
    bool is = false;
    for (const Light& light : animation.lights)
        is = is || light.intensity >= (light.kind == LightKind::directional ? least_lux : least_candela);
    return is;
}

bool shines(const Animation& animation) {
    return !animation.lights.empty() || std::any_of(animation.materials.begin(), animation.materials.end(),
                                                    [](const Material& material) { return material.emits(); });
}

}  // namespace

void heed_exporter(const Document& document, Animation& animation) {
    const auto version = blender_exporter(document);
    if (version.first == 0) return;
    if (version >= std::pair(3, 4) && lamps_are_photometric(animation)) {
        constexpr float lumens_per_watt = 683;
        for (Light& light : animation.lights) light.intensity /= lumens_per_watt;
        note_once(animation,
                  "lamps are in candela and lux, as Blender's exporter writes them: divided by 683, so that "
                  "they shine as in Blender");
    }
    if (animation.cameras.empty())
        note_once(animation, "has no camera: Blender exports them where Include > Cameras is ticked");
    if (!shines(animation))
        note_once(animation,
                  "has no lamp: Blender exports points, spots and suns where Include > Punctual Lights is "
                  "ticked, and neither area lamps nor the world");
}

}  // namespace render2mpeg::scene::gltf
