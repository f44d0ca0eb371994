#include "app/loop/film_identity.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <string_view>
#include <system_error>

#include "app/files/build_identity.h"
#include "app/files/checksum.h"

namespace render2mpeg::app {
namespace {

using nlohmann::json;

/// Options that change no byte of the film, or that are told otherwise: heatmaps have work folders of their own.
constexpr std::array<std::string_view, 10> idle{"--output", "--threads", "--quiet",   "--stats",  "--report",
                                                "--resume", "--dry-run", "--heatmap", "--memory", "--isa"};

std::string full_name_of(const std::filesystem::path& file) {
    std::error_code error;
    return std::filesystem::weakly_canonical(std::filesystem::absolute(file, error), error).string();
}

json options_of(const RenderOptions& options) {
    json words = json::object();
    for (const auto& [name, value] : options.said)
        if (std::find(idle.begin(), idle.end(), name) == idle.end()) words[name] = value;
    // The frames' layers that are there already are there alone.
    if (options.layers) words["--aov"] = full_name_of(*options.layers);
    return words;
}

/// A value of the manifest in a message.
std::string shown(const json& value) {
    return value.is_string() ? value.get<std::string>() : value.dump(-1, ' ', false, json::error_handler_t::replace);
}

std::string difference_of_options(const json& before, const json& now) {
    for (const auto& [name, value] : now.items()) {
        if (!before.contains(name)) return fmt::format("{} was not given and is {}", name, shown(value));
        if (before[name] != value) return fmt::format("{} was {} and is {}", name, shown(before[name]), shown(value));
    }
    for (const auto& [name, value] : before.items())
        if (!now.contains(name)) return fmt::format("{} was {} and is not given", name, shown(value));
    return {};
}

std::string difference_of_inputs(const json& before, const json& now) {
    for (std::size_t i = 0; i < std::max(before.size(), now.size()); ++i) {
        if (i >= now.size()) return fmt::format("the input {} is gone", shown(before[i].value("file", json())));
        const std::string file = shown(now[i].value("file", json()));
        if (i >= before.size()) return fmt::format("the input {} is new", file);
        if (before[i].value("checksum", json()) != now[i].value("checksum", json()))
            return fmt::format("the input {} has changed", file);
    }
    return {};
}

}  // namespace

std::vector<Files> inputs_of(const RenderJob& film, const RenderOptions& options) {
    std::vector<Files> inputs{Files(options.input)};
    for (const std::filesystem::path& file : film.animation->files) inputs.emplace_back(file);
    for (const scene::ImageSource& image : film.animation->images) inputs.emplace_back(image.path);
    inputs.emplace_back(options.coding.keyframes.value_or(""));
    return inputs;
}

json identity_of(const RenderJob& film, const RenderOptions& options) {
    json inputs = json::array();
    for (const Files& input : inputs_of(film, options)) {
        std::error_code error;
        // An image that is missing is shown as missing; a list of keyframes is no file.
        if (!std::filesystem::is_regular_file(input.name, error)) continue;
        const std::string file = full_name_of(input.name);
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

std::string difference_of(const json& before, const json& now) {
    if (before == now) return {};
    if (!before.is_object()) return "what was left is of no known version";
    for (const char* name : {"version", "isa"})
        if (before.value(name, json()) != now.value(name, json()))
            return fmt::format("the {} was {} and is {}",
                               std::string_view(name) == "isa" ? "instruction set" : "version of render2mpeg",
                               shown(before.value(name, json())), shown(now.value(name, json())));
    if (before.value("build", json()) != now.value("build", json())) return "render2mpeg was built anew since";
    const auto part = [](const json& of, const char* name, const json& otherwise) {
        return of.contains(name) && of[name].type() == otherwise.type() ? of[name] : otherwise;
    };
    std::string text =
        difference_of_options(part(before, "options", json::object()), part(now, "options", json::object()));
    if (text.empty())
        text = difference_of_inputs(part(before, "inputs", json::array()), part(now, "inputs", json::array()));
    if (text.empty() && before.value("frames", json()) != now.value("frames", json()))
        text = fmt::format("the frames were {} and are {}", shown(before.value("frames", json())),
                           shown(now.value("frames", json())));
    return text.empty() ? "it is another film" : text;
}

}  // namespace render2mpeg::app
