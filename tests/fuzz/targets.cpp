#include "fuzz/targets.h"

#include <array>

namespace render2mpeg::fuzz {

std::span<const NamedTarget> targets() {
    static constexpr std::array<NamedTarget, 17> all{{{"gltf", gltf, 400},
                                                      {"animation", animation, 300},
                                                      {"model", model, 25},
                                                      {"volume", volume, 8},
                                                      {"tracks", tracks, 20000},
                                                      {"image", image, 400},
                                                      {"sky", sky, 300},
                                                      {"layers", layers, 100},
                                                      {"y4m", y4m, 300},
                                                      {"motion", motion, 2000},
                                                      {"hints", hints, 600},
                                                      {"plan", plan, 1000},
                                                      {"light", light, 300},
                                                      {"film", film, 60},
                                                      {"sound", sound, 60},
                                                      {"chunk", chunk, 100},
                                                      {"state", state, 20}}};
    return all;
}

}  // namespace render2mpeg::fuzz
