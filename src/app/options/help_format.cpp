#include "app/options/help_format.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <sstream>

#include "app/system/terminal.h"

namespace render2mpeg::app {
namespace {

/// Columns for names and values of options, before their descriptions.
constexpr int name_columns = 30;

class HelpFormat : public CLI::Formatter {
  public:
    HelpFormat() {
        column_width(name_columns);
        label("SUBCOMMAND", "COMMAND");
    }

    std::string make_option_opts(const CLI::Option* option) const override {
        std::string text;
        // Flags take no value, and positionals name theirs.
        if (option->get_type_size() != 0 && !option->get_type_name().empty() && !option->get_positional())
            text += " " + option->get_type_name();
        if (!option->get_default_str().empty()) text += " [=" + option->get_default_str() + "]";
        if (option->get_required() && !option->get_positional()) text += " (required)";
        return text;
    }

    std::string make_option_desc(const CLI::Option* option) const override {
        return described(option->get_description());
    }

    std::string make_subcommand(const CLI::App* command) const override {
        std::stringstream out;
        CLI::detail::format_help(out, command->get_name(), described(command->get_description()), column_width_);
        return out.str();
    }

    std::string make_footer(const CLI::App* app) const override {
        return app->get_footer().empty() ? "" : "\n" + wrapped(app->get_footer(), columns()) + "\n";
    }

  private:
    /// chosen: longer lines than 110 columns are hard to follow; below 60 descriptions would have no room.
    static int columns() { return std::clamp(columns_of_output(), 60, 110); }

    /// Descriptions are wrapped to the terminal.
    static std::string described(std::string text) {
        std::replace(text.begin(), text.end(), '\n', ' ');
        return wrapped(text, columns() - name_columns);
    }
};

}  // namespace

std::string wrapped(const std::string& text, int columns) {
    std::istringstream lines(text);
    std::string result, line, word;
    while (std::getline(lines, line)) {
        std::istringstream words(line);
        std::size_t used = 0;
        if (!result.empty()) result += "\n";
        while (words >> word) {
            if (used > 0 && used + 1 + word.size() > static_cast<std::size_t>(columns)) {
                result += "\n";
                used = 0;
            } else if (used > 0) {
                result += " ";
                ++used;
            }
            result += word;
            used += word.size();
        }
    }
    return result;
}

std::shared_ptr<CLI::FormatterBase> help_format() {
    return std::make_shared<HelpFormat>();
}

}  // namespace render2mpeg::app
