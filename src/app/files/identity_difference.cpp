#include "app/files/identity_difference.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>

namespace render2mpeg::app {
namespace {

using nlohmann::json;

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
