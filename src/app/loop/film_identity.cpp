#include "app/loop/film_identity.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <string_view>
#include <system_error>

#include "app/files/file_io.h"

namespace render2mpeg::app {
namespace {

using nlohmann::json;

/// Options that change no byte of the film; heatmaps have work folders of their own.
constexpr std::array<std::string_view, 15> idle{"--output", "--threads",   "--quiet",   "--stats",  "--report",
                                                "--hold",   "--overwrite", "--verbose", "--within", "--progress",
                                                "--resume", "--dry-run",   "--heatmap", "--memory", "--isa"};

json options_of(const RenderOptions& options) {
    json words = json::object();
    for (const auto& [name, value] : options.said)
        if (std::find(idle.begin(), idle.end(), name) == idle.end()) words[name] = value;
    // Layers already written lie in this folder alone.
    if (options.layers) words["--aov"] = canonical_of(*options.layers).string();
    return words;
}

}  // namespace

std::vector<Files> inputs_of(const RenderJob& film, const RenderOptions& options) {
    std::vector<Files> inputs{Files(options.input)};
    for (const std::filesystem::path& file : film.animation->files) inputs.emplace_back(file);
    for (const scene::ImageSource& image : film.animation->images) inputs.emplace_back(image.path);
    inputs.emplace_back(options.coding.keyframes.value_or(""));
    inputs.emplace_back(film.sound.file);
    return inputs;
}

json identity_of(const RenderJob& film, const RenderOptions& options) {
    json inputs = json::array();
    for (const Files& input : inputs_of(film, options)) {
        std::error_code error;
        // A missing image is shown as missing; a list of keyframes is no file.
        if (!std::filesystem::is_regular_file(input.name, error)) continue;
        const std::string file = canonical_of(input.name).string();
        const auto known = [&](const json& other) { return other["file"] == file; };
        if (std::none_of(inputs.begin(), inputs.end(), known))
            inputs.push_back({{"file", file}, {"checksum", text_of(checksum_of(input.name))}});
    }
    return {{"version", RENDER2MPEG_VERSION},           {"build", build_identity()},
            {"isa", core::name_of(film.rendering.isa)}, {"frames", {film.frames.first, film.frames.last}},
            {"options", options_of(options)},           {"inputs", inputs}};
}

json identity_of(const Film& film, const std::string& command) {
    std::error_code error;
    return {{"version", RENDER2MPEG_VERSION},
            {"command", command},
            {"folder", std::filesystem::current_path(error).string()},
            {"input", film.source},
            {"frames", {film.frames.first, film.frames.last}}};
}

}  // namespace render2mpeg::app
