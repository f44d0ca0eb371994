#include "encoder_rd/crowd.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <fstream>
#include <nlohmann/json.hpp>
#include <vector>

#include "core/error.h"

namespace render2mpeg::bench {
namespace {

using nlohmann::json;

struct Walker {
    float x, z, heading;  ///< of its path's middle, metres, and degrees about +y; it walks towards its own +z
    float pace;           ///< times of its steps over the original's: below 1 is faster
};

constexpr std::array<Walker, 6> walkers = {{{-0.7f, -0.2f, 8, 1.0f},
                                            {0.3f, 1.0f, 172, 0.85f},
                                            {1.0f, 0.2f, -4, 0.72f},
                                            {-1.4f, 1.2f, 150, 0.93f},
                                            {1.5f, 0.3f, 200, 1.1f},
                                            {0.5f, -0.1f, 60, 1.25f}}};

/// Times of the keys, stretched: a buffer of its own behind the figure's, one run of floats per walker.
void add_times(json& gltf, const std::filesystem::path& character, const std::filesystem::path& folder, int input,
               std::vector<int>& accessors) {
    const json accessor = gltf["accessors"][static_cast<std::size_t>(input)];
    const json view = gltf["bufferViews"][accessor["bufferView"].get<std::size_t>()];
    const auto count = accessor["count"].get<std::size_t>();
    std::vector<float> times(count), stretched;
    std::ifstream in(character / "figure.bin", std::ios::binary);
    in.seekg(view.value("byteOffset", 0) + accessor.value("byteOffset", 0));
    in.read(reinterpret_cast<char*>(times.data()), static_cast<std::streamsize>(count * sizeof(float)));
    if (!in) throw core::Error("reading", (character / "figure.bin").string(), "no times of keys in it");
    for (const Walker& walker : walkers) {
        const std::size_t first = stretched.size();
        for (const float t : times) stretched.push_back(walker.pace * t);
        accessors.push_back(static_cast<int>(gltf["accessors"].size()));
        gltf["bufferViews"].push_back({{"buffer", gltf["buffers"].size()},
                                       {"byteOffset", first * sizeof(float)},
                                       {"byteLength", count * sizeof(float)}});
        gltf["accessors"].push_back({{"bufferView", gltf["bufferViews"].size() - 1},
                                     {"componentType", 5126},
                                     {"count", count},
                                     {"type", "SCALAR"},
                                     {"min", {stretched[first]}},
                                     {"max", {stretched.back()}}});
    }
    gltf["buffers"].push_back({{"uri", "paces.bin"}, {"byteLength", stretched.size() * sizeof(float)}});
    std::ofstream(folder / "paces.bin", std::ios::binary)
        .write(reinterpret_cast<const char*>(stretched.data()),
               static_cast<std::streamsize>(stretched.size() * sizeof(float)));
}

/// A copy of the figure's nodes below a node that puts it in its place; returns that node.
std::size_t add_nodes(json& gltf, const json& figure, const Walker& walker) {
    const std::size_t first = gltf["nodes"].size();
    for (json node : figure["nodes"]) {
        if (node.contains("children"))
            for (json& child : node["children"]) child = child.get<std::size_t>() + first;
        if (node.contains("skin")) node["skin"] = gltf["skins"].size();
        gltf["nodes"].push_back(node);
    }
    json skin = figure["skins"][0];
    for (json& joint : skin["joints"]) joint = joint.get<std::size_t>() + first;
    skin["skeleton"] = skin["skeleton"].get<std::size_t>() + first;
    gltf["skins"].push_back(skin);

    json children = figure["scenes"][0]["nodes"];
    for (json& child : children) child = child.get<std::size_t>() + first;
    const float half = walker.heading * 3.14159265f / 360;
    gltf["nodes"].push_back({{"translation", {walker.x, 0.0f, walker.z}},
                             {"rotation", {0.0f, std::sin(half), 0.0f, std::cos(half)}},
                             {"children", children}});
    return gltf["nodes"].size() - 1;
}

}  // namespace

void write_crowd(const std::filesystem::path& character, const std::filesystem::path& folder) {
    std::ifstream in(character / "figure.gltf");
    if (!in) throw core::Error("reading", (character / "figure.gltf").string(), "no such file");
    const json figure = json::parse(in);
    json gltf = figure;
    gltf["nodes"] = gltf["skins"] = json::array();
    gltf["scenes"][0]["nodes"] = json::array();
    json& animation = gltf["animations"][0];
    animation["channels"] = animation["samplers"] = json::array();

    const json& original = figure["animations"][0];
    std::vector<int> times;
    add_times(gltf, character, folder, original["samplers"][0]["input"].get<int>(), times);
    for (std::size_t w = 0; w < walkers.size(); ++w) {
        const std::size_t first_node = gltf["nodes"].size(), first_sampler = animation["samplers"].size();
        for (json sampler : original["samplers"]) {
            sampler["input"] = times[w];
            animation["samplers"].push_back(sampler);
        }
        for (json channel : original["channels"]) {
            channel["sampler"] = channel["sampler"].get<std::size_t>() + first_sampler;
            channel["target"]["node"] = channel["target"]["node"].get<std::size_t>() + first_node;
            animation["channels"].push_back(channel);
        }
        gltf["scenes"][0]["nodes"].push_back(add_nodes(gltf, figure, walkers[w]));
    }
    std::ofstream(folder / "crowd.gltf") << gltf;
    std::filesystem::copy_file(character / "figure.bin", folder / "figure.bin",
                               std::filesystem::copy_options::overwrite_existing);
}

}  // namespace render2mpeg::bench
