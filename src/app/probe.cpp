#include "app/probe.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "app/commands/commands.h"
#include "app/options/options.h"
#include "app/system/probes.h"
#include "core/error.h"
#include "core/picture.h"
#include "encoder/av/av.h"
#include "encoder/av/inspect.h"
#include "scene/assimp/load.h"
#include "scene/blender/export.h"
#include "scene/gltf/load.h"
#include "scene/isolation/probe.h"

namespace render2mpeg::app {
namespace {

using Words = std::vector<std::string>;

/// FILE [ANIMATION]
std::string read_scene(const Words& words, const scene::TakeTurns& take_turns) {
    scene::LoadOptions options;
    if (words.size() > 1) options.animation = words[1];
    take_turns(scene::Turn::parser);
    scene::load_with_assimp(words.at(0), options, take_turns);
    return {};
}

/// FILE
std::string read_gltf(const Words& words, const scene::TakeTurns& take_turns) {
    scene::load_gltf(words.at(0), {}, [&](std::uintmax_t) { take_turns(scene::Turn::parser); });
    return {};
}

std::string read_images(const Words&, const scene::TakeTurns& take_turns) {
    return read_probed_images(take_turns);
}

/// FILE
std::string read_film(const Words& words, const scene::TakeTurns& take_turns) {
    const std::filesystem::path film = words.at(0);
    take_turns(scene::Turn::parser);
    av::decode(film, [](const core::Picture&) {});
    av::inspect(film);
    return {};
}

/// FILE
std::string read_sound(const Words& words, const scene::TakeTurns& take_turns) {
    take_turns(scene::Turn::parser);
    av::length_of_sound(words.at(0));
    return {};
}

/// Runs become_blender() with these words.
std::string run_blender(const Words& words, const scene::TakeTurns& take_turns) {
    take_turns(scene::Turn::parser);
    scene::become_blender(words);
    throw core::Error("starting", words.at(0), "it cannot be started");
}

/// FILE, and the flags that are set: json, summary
std::string read_facts(const Words& words, const scene::TakeTurns& take_turns) {
    InfoOptions options;
    options.input = words.at(0);
    for (const std::string& word : words) {
        options.json = options.json || (&word != &words[0] && word == "json");
        options.summary = options.summary || (&word != &words[0] && word == "summary");
    }
    take_turns(scene::Turn::parser);
    return info_of(options, [&] { take_turns(scene::Turn::ours); });
}

}  // namespace

void probe(int argc, char** argv) {
    scene::live_as_probe(argc, argv,
                         {{"scene", read_scene},
                          {"gltf", read_gltf},
                          {"images", read_images},
                          {"film", read_film},
                          {"sound", read_sound},
                          {"info", read_facts},
                          {"blend", run_blender}});
}

}  // namespace render2mpeg::app
