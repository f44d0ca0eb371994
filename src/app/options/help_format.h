#pragma once
// How `--help` looks.
#include <memory>
#include <string>

namespace CLI {
class FormatterBase;
}

namespace render2mpeg::app {

/// Breaks a text into lines of at most `columns` characters between words; its own line ends stay.
std::string wrapped(const std::string& text, int columns);

/// How --help looks: as wide as the terminal, values as `1..31` or `fast|quality`, defaults as `[=4]`.
std::shared_ptr<CLI::FormatterBase> help_format();

}  // namespace render2mpeg::app
