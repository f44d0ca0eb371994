#pragma once
// How `--help` looks.
#include <memory>
#include <string>
#include <vector>

namespace CLI {
class FormatterBase;
}

namespace render2mpeg::app {

/// Breaks a text into lines of at most `columns` characters between words; its own line ends stay.
std::string wrapped(const std::string& text, int columns);

/// The values of an option, from CLI11's name of them: "INT:INT in [1 - 31]", "TEXT:{a,b}".
struct OptionValues {
    explicit OptionValues(const std::string& type);

    std::string low, high;             ///< of a range; empty: it has none
    std::vector<std::string> choices;  ///< of which it takes one; empty: it takes others
};

/// How --help looks: as wide as the terminal, values as `1..31` or `fast|quality`, defaults as `[=4]`.
std::shared_ptr<CLI::FormatterBase> help_format();

}  // namespace render2mpeg::app
