#include "app/probe.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "app/commands/commands.h"
#include "app/options/options.h"
#include "app/system/image_reader.h"
#include "core/error.h"
#include "core/picture.h"
#include "encoder/av/av.h"
#include "encoder/av/inspect.h"
#include "scene/assimp/load.h"
#include "scene/blender/export.h"
#include "scene/gltf/load.h"
#include "scene/isolation/probe.h"
#include "scene/volumes/volume_reader.h"

namespace render2mpeg::app {
namespace {

using Words = std::vector<std::string>;

/// FILE [ANIMATION]
std::string read_scene(const Words& words, const scene::BeginLimits& begin_limits) {
    scene::LoadOptions options;
    if (words.size() > 1) options.animation = words[1];
    begin_limits();
    scene::load_with_assimp(words.at(0), options);
    return {};
}

/// FILE
std::string read_gltf(const Words& words, const scene::BeginLimits& begin_limits) {
    scene::load_gltf(words.at(0), {}, [&](std::uintmax_t) { begin_limits(); });
    return {};
}

/// FILE
std::string read_film(const Words& words, const scene::BeginLimits& begin_limits) {
    const std::filesystem::path film = words.at(0);
    begin_limits();
    av::decode(film, [](const core::Picture&) {});
    av::inspect(film);
    return {};
}

/// FILE
std::string read_sound(const Words& words, const scene::BeginLimits& begin_limits) {
    begin_limits();
    return std::to_string(av::channels_of_sound(words.at(0)));
}

/// Runs become_blender() with these words.
std::string run_blender(const Words& words, const scene::BeginLimits& begin_limits) {
    begin_limits();
    scene::become_blender(words);
    throw core::Error("starting", words.at(0), "it cannot be started");
}

/// FILE, and the flags that are set: json, summary
std::string read_facts(const Words& words, const scene::BeginLimits& begin_limits) {
    InfoOptions options;
    options.input = words.at(0);
    const auto given = [&](const char* flag) { return std::find(words.begin() + 1, words.end(), flag) != words.end(); };
    options.json = given("json");
    options.summary = given("summary");
    begin_limits();
    return info_of(options);
}

}  // namespace

void probe(int argc, char** argv) {
    scene::live_as_probe(argc, argv,
                         {{"scene", read_scene},
                          {"gltf", read_gltf},
                          {"images", read_probed_images},
                          {"volume", scene::read_probed_volume},
                          {"outlines", scene::read_probed_outlines},
                          {"film", read_film},
                          {"sound", read_sound},
                          {"info", read_facts},
                          {"blend", run_blender}});
}

}  // namespace render2mpeg::app
