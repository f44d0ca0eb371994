#include "fuzz/targets.h"

#include <array>

namespace render2mpeg::fuzz {

std::span<const NamedTarget> targets() {
    static constexpr std::array<NamedTarget, 10> all{{{"gltf", gltf, 400},
                                                      {"animation", animation, 300},
                                                      {"model", model, 40},
                                                      {"tracks", tracks, 20000},
                                                      {"image", image, 600},
                                                      {"sky", sky, 300},
                                                      {"layers", layers, 100},
                                                      {"y4m", y4m, 300},
                                                      {"motion", motion, 5000},
                                                      {"hints", hints, 1000}}};
    return all;
}

}  // namespace render2mpeg::fuzz
