#pragma once
// The table of options: names, place in --help, member, values, text, and when an option is idle.
#include <fmt/format.h>
#include <cmath>

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <type_traits>
#include <vector>

#include "app/options/options.h"
#include "core/error.h"

namespace render2mpeg::app {

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

/// Marks of rows: the default is part of the help, or this text is; the option must be given; not with another one, or
/// only with it; it takes no more than its own two words.
struct Shown {};
struct ShownAs {
    std::string text;
};
struct Required {};
struct NotWith {
    std::string other;
};
struct With {
    std::string other;
};
struct TwoWords {};

/// One option of some commands.
struct OptionRow {
    /// `names`: as CLI11 takes them, and @COMMAND where another row has the same. `group`: of --help; empty: the first.
    /// `parts`: the name of its values, `Values`, a parser of ours, marks, `Idle`.
    template <class Value, class... Parts>
    OptionRow(const std::string& names, const char* group, Value& value, const std::string& text, Parts... parts)
        : id(names.substr(names.find(',') + 1)) {
        const std::string own = names.substr(0, names.find('@'));
        (note(parts), ...);
        add_to = [=, &value](CLI::App& command) {
            CLI::Option* option = nullptr;
            if constexpr (std::is_same_v<Value, bool>)
                option = command.add_flag(own, value, text);
            else
                option = command.add_option(own, value, text);
            if (*group != '\0') option->group(group);
            (apply(parts, command, *option), ...);
        };
    }

    std::string id;  ///< as commands list it: the last name, with @COMMAND
    Idle idle = Idle::never;
    std::function<void(CLI::App&)> add_to;

  private:
    template <class Part>
    void note(const Part& part) {
        if constexpr (std::is_same_v<Part, Idle>) idle = part;
    }
    template <class Part>
    static void apply(const Part& part, CLI::App& command, CLI::Option& option) {
        if constexpr (std::is_same_v<Part, Shown>) {
            option.capture_default_str();
        } else if constexpr (std::is_same_v<Part, ShownAs>) {
            option.default_str(part.text);
        } else if constexpr (std::is_same_v<Part, Required>) {
            option.required();
        } else if constexpr (std::is_same_v<Part, NotWith>) {
            option.excludes(command.get_option(part.other));
        } else if constexpr (std::is_same_v<Part, With>) {
            option.needs(command.get_option(part.other));
        } else if constexpr (std::is_same_v<Part, TwoWords>) {
            option.allow_extra_args(false);
        } else if constexpr (std::is_same_v<Part, CLI::Validator>) {
            option.check(part);
        } else if constexpr (std::is_same_v<Part, Values>) {
            option.type_name(part.names)->check(part.check);
        } else if constexpr (std::is_convertible_v<Part, std::string>) {
            option.type_name(part);
        } else if constexpr (!std::is_same_v<Part, Idle>) {
            option.check(CLI::Validator(
                [part](std::string& text) -> std::string {
                    try {
                        part(text);
                        return {};
                    } catch (const core::Error& error) {
                        return error.what();
                    }
                },
                ""));
        }
    }
};

/// All options, which set the members of `line`.
std::vector<OptionRow> option_rows(CommandLine& line);

}  // namespace render2mpeg::app
