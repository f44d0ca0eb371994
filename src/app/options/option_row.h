#pragma once
// A row of the table of options: names, place in --help, member, values, text, and when the option is idle.
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "app/options/options.h"

namespace render2mpeg::app {

/// Marks of rows. Plain text is the name of the values; where there is none, `Words` or `Range` name them.
/// The only values, parted by `|`, of which mistakes name the nearest.
struct Words {
    const char* all;
};
struct Range {
    double low = 0, high = 0;  ///< both included
    bool is_whole = false;     ///< of whole numbers
};
/// Takes the text of an option, named without dashes. Throws core::Error where it is no value of it.
using Parser = std::function<void(const std::string& text, const std::string& option)>;
/// The default is part of the help, or this text is; the option must be given; not with another one, or only with it;
/// it takes no more than its own two words.
struct Shown {};
struct ShownAs {
    const char* text;
};
struct Required {};
struct NotWith {
    const char* other;
};
struct With {
    const char* other;
};
struct TwoWords {};
using Mark = std::variant<std::monostate, const char*, Words, Range, Parser, Shown, ShownAs, Required, NotWith, With,
                          TwoWords, Idle>;

/// One option of some commands: data alone, which options.cpp gives to CLI11. Texts outlive it.
struct OptionRow {
    /// Where the value goes; a bool is a flag; none: the parser knows.
    using Member =
        std::variant<std::monostate, bool*, int*, double*, std::string*, std::filesystem::path*, std::optional<int>*,
                     std::optional<std::int64_t>*, std::optional<float>*, std::optional<double>*,
                     std::optional<std::string>*, std::optional<std::filesystem::path>*,
                     std::vector<std::pair<std::string, std::string>>*>;

    /// `names`: as CLI11 takes them, and @COMMAND where another row has the same. `group`: of --help; empty: the first.
    OptionRow(const char* names, const char* group, Member member, const char* text, const Mark& first = {},
              const Mark& second = {}, const Mark& third = {}, const Mark& fourth = {});
    OptionRow(const char* names, const char* group, Parser parser, const char* text, const Mark& first = {},
              const Mark& second = {}, const Mark& third = {});

    /// As commands list it: the last name, with @COMMAND; and without.
    std::string id() const;
    std::string name() const;

    const char *names, *group, *text;
    Member member;
    const char *values = "", *words = "", *shown_as = "", *with = "";  ///< empty: none
    std::optional<Range> range;
    Parser parser;  ///< sets a member of another type than those of `Member`, or only checks; empty: none
    std::vector<std::string> not_with;
    bool is_shown = false, is_required = false, is_two_words = false;
    Idle idle = Idle::never;
};

}  // namespace render2mpeg::app
