#pragma once
// The options of MPEG-2 coding.
#include <fmt/format.h>
#include <cmath>

#include <CLI/CLI.hpp>
#include <string>
#include <type_traits>
#include <vector>

#include "app/options/options.h"
#include "core/error.h"

namespace render2mpeg::app {

/// A parser of ours as a CLI11 check.
template <class Parser>
CLI::Validator checked(Parser parser) {
    return CLI::Validator(
        [parser](std::string& text) -> std::string {
            try {
                parser(text);
                return {};
            } catch (const core::Error& error) {
                return error.what();
            }
        },
        "");
}

/// Values of an option as --help names them, and their check.
struct Values {
    std::string names;
    CLI::Validator check;
};
template <class Number>
Values range(Number low, Number high) {
    const auto check = [=](std::string& text) {
        double value = 0;
        // NaN lies in no range.
        if (CLI::Range(low, high)(text).empty() && (!CLI::detail::lexical_cast(text, value) || !std::isnan(value)))
            return std::string();
        return fmt::format("{}: expected a number from {} to {}", text, low, high);
    };
    return {fmt::format("{}..{}", low, high), CLI::Validator(check, "")};
}
/// One of these words, of which mistakes name the nearest.
Values one_of(const std::vector<std::string>& words);

/// Mark of an option whose default is part of its help.
struct ShowsDefault {};
inline constexpr ShowsDefault shown;

/// Adds an option to a group of --help. `parts`: the name of its values, `Values`, a parser of ours, `shown`.
template <class Value, class... Parts>
CLI::Option* add_option(CLI::App& command, const std::string& group, const std::string& names, Value& value,
                        const std::string& text, Parts&&... parts) {
    CLI::Option* option = command.add_option(names, value, text)->group(group);
    const auto apply = [&](auto&& part) {
        using Part = std::decay_t<decltype(part)>;
        if constexpr (std::is_same_v<Part, ShowsDefault>)
            option->capture_default_str();
        else if constexpr (std::is_convertible_v<Part, std::string>)
            option->type_name(part);
        else if constexpr (std::is_same_v<Part, Values>)
            option->type_name(part.names)->check(part.check);
        else
            option->check(checked(part));
    };
    (apply(parts), ...);
    return option;
}
inline CLI::Option* add_flag(CLI::App& command, const std::string& group, const std::string& names, bool& value,
                             const std::string& text) {
    return command.add_flag(names, value, text)->group(group);
}

/// Coding options of `render` and `encode`.
void add_coding_options(CLI::App& command, CodingOptions& options);
/// Sound options of `render`, `encode` and `tune`.
void add_sound_options(CLI::App& command, CodingOptions& options);
/// --as of these kinds.
void add_as_option(CLI::App& command, std::optional<std::string>& as, const std::vector<std::string>& kinds);
/// --threads.
void add_threads_option(CLI::App& command, int& threads);
/// --isa.
void add_isa_option(CLI::App& command, std::optional<std::string>& isa);
/// --overwrite.
void add_consent_option(CLI::App& command, bool& overwrite);
/// --within.
void add_within_option(CLI::App& command, std::string& within, const std::string& group);
/// --display-aspect and --pixel-aspect.
void add_shape_options(CLI::App& command, CodingOptions& options);

}  // namespace render2mpeg::app
