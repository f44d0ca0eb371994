#pragma once
// How `--help` looks.
#include <memory>
#include <string>

namespace CLI {
class FormatterBase;
}

namespace render2mpeg::app {

/// Wraps text at `columns`; its own line ends stay.
std::string wrapped(const std::string& text, int columns);

/// Help as wide as the terminal, defaults as `[=4]`.
std::shared_ptr<CLI::FormatterBase> help_format();

}  // namespace render2mpeg::app
