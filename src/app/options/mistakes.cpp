#include "app/options/mistakes.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <regex>
#include <string_view>
#include <system_error>

#include "app/options/help_format.h"
#include "app/options/usage_error.h"
#include "core/text.h"

namespace render2mpeg::app {
namespace {

bool is_option_word(const std::string& word) {
    return word.size() > 1 && word[0] == '-' && word != "--" &&
           std::isdigit(static_cast<unsigned char>(word[1])) == 0 && word[1] != '.';
}

std::vector<const CLI::App*> commands_in(const CLI::App& program) {
    return program.get_subcommands([](const CLI::App*) { return true; });
}

/// "--size" and "-s" of all options of a command.
std::vector<std::string> names_of(const CLI::App& command) {
    std::vector<std::string> names;
    for (const CLI::Option* option : command.get_options()) {
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
        for (const std::string& name : option->get_snames()) names.push_back("-" + name);
    }
    return names;
}

bool has(const std::vector<std::string>& names, const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

std::string nearest_of(const std::string& word, const std::vector<std::string>& words) {
    const std::vector<std::string_view> views(words.begin(), words.end());
    return core::nearest_word(word, views);
}

/// "a, b and c", at most three of them.
std::string listed_commands(const std::vector<std::string>& names) {
    std::string text;
    for (std::size_t i = 0; i < names.size(); ++i)
        text += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + ("`" + names[i] + "`");
    return text;
}

/// Why an option of this name is none of the command's, and what is.
std::string advice_for(const CLI::App& program, const CLI::App& command, const std::string& name) {
    const std::string here = ": `" + command.get_name() + "` has no such option";
    const std::vector<std::string> names = names_of(command);
    // One hyphen too few: "-size".
    if (name.size() > 2 && name[1] != '-' && has(names, "-" + name)) return here + "; did you mean -" + name + "?";
    std::vector<std::string> others;
    for (const CLI::App* other : commands_in(program))
        if (other != &command && has(names_of(*other), name)) others.push_back(other->get_name());
    // Bare hyphens are in all of them and say nothing.
    std::vector<std::string> long_names;
    for (const std::string& other : names)
        if (other.starts_with("--")) long_names.push_back(other.substr(2));
    const std::string bare =
        name.substr(name.find_first_not_of('-') == std::string::npos ? name.size() : name.find_first_not_of('-'));
    const std::string nearest = nearest_of(bare, long_names);
    const std::string meant = nearest.empty() ? "" : "; did you mean --" + nearest + "?";
    if (others.empty()) return here + meant;
    return here + ", " + listed_commands(others) + (others.size() == 1 ? " has" : " have") + meant;
}

std::string help_of(const std::string& command) {
    return " (see render2mpeg " + (command.empty() ? "" : command + " ") + "--help)";
}

/// "0.000000" as one writes it.
std::string short_number(const std::string& text) {
    if (text.find('.') == std::string::npos) return text;
    std::string shorter = text.substr(0, text.find_last_not_of('0') + 1);
    if (shorter.back() == '.') shorter.pop_back();
    return shorter;
}

/// What the option takes, for messages.
std::string values_of(const CLI::Option& option) {
    const OptionValues values(option.get_type_name());
    if (!values.low.empty()) return "a number from " + short_number(values.low) + " to " + short_number(values.high);
    if (!values.choices.empty()) return CLI::detail::join(values.choices, ", ");
    return option.get_type_name().empty() ? "a value" : option.get_type_name();
}

std::string sentence_for(const std::string& name, const CLI::Option& option, const std::string& value) {
    const std::string meant = nearest_of(value, OptionValues(option.get_type_name()).choices);
    return name + " " + value + ": expected " + values_of(option) +
           (meant.empty() ? "" : "; did you mean " + meant + "?");
}

/// What a check of ours says: "size 640: expected ...", with the option's name in place of the noun.
std::string checked_text(const std::string& name, const std::string& value, const std::string& said) {
    const std::size_t at = value.empty() ? std::string::npos : said.find(value);
    if (at == std::string::npos) return name + ": " + said;
    // Frame numbers and the like are parts of what was said.
    return name + " " + said.substr(at);
}

/// What is missing where a positional or a required option is.
std::string missing_text(const std::string& name, const std::string& command) {
    if (name == "INPUT")
        return "INPUT is missing: which scene? For example: render2mpeg " + command + " scene.glb" +
               (command == "render" ? " -o film.mpg"
                : command == "tune" ? " --target-psnr 40 -o film.mpg"
                                    : "");
    if (name == "FRAMES")
        return "FRAMES is missing: which frames? For example: render2mpeg encode frames.%04d.png -o film.mpg";
    if (name == "FILE") return "FILE is missing: which film? For example: render2mpeg info film.mpg";
    if (name == "--output" || name == "-o") return "-o is missing: which film is to be made? For example: -o film.mpg";
    return name + " is missing";
}

const CLI::Option* option_named(const CLI::App& command, const std::string& name) {
    for (const CLI::Option* option : command.get_options())
        if (option->check_name(name)) return option;
    return nullptr;
}

}  // namespace

void refuse_unknown_options(const CLI::App& program, const CLI::App& command, const std::vector<std::string>& words) {
    const std::vector<std::string> names = names_of(command);
    for (std::size_t i = 0; i < words.size(); ++i) {
        if (words[i] == "--") return;
        if (!is_option_word(words[i])) continue;
        const std::string name = words[i].substr(0, words[i].find('='));
        // "-q4": the value behind a short name.
        const bool attached = name[1] != '-' && has(names, name.substr(0, 2)) && !has(names, "-" + name);
        if (!has(names, name) && !attached)
            throw UsageError(name + advice_for(program, command, name) + help_of(command.get_name()));
        if (name != words[i])
            for (const CLI::Option* option : command.get_options())
                if (option->check_name(name) && option->get_expected_max() == 0)
                    throw UsageError(words[i] + ": " + name + " takes no value" + help_of(command.get_name()));
        if (name == "--heatmap" &&
            (i + 2 >= words.size() || is_option_word(words[i + 1]) || is_option_word(words[i + 2])))
            throw UsageError(
                "--heatmap" + (i + 1 < words.size() && !is_option_word(words[i + 1]) ? " " + words[i + 1] : "") +
                ": expected what to show and a file, e.g. --heatmap tolerance heat.mpg" + help_of(command.get_name()));
    }
}

void refuse_unknown_command(const CLI::App& program, const std::vector<std::string>& words) {
    std::vector<std::string> names;
    std::string all;
    for (const CLI::App* command : commands_in(program)) {
        names.push_back(command->get_name());
        all += (all.empty() ? "" : ", ") + command->get_name();
    }
    if (words.empty()) throw UsageError("which command? There are " + all + help_of(""));
    const std::string& word = words.front();
    if (has(names, word) || word == "-h" || word == "--help" || word == "--version") return;
    if (is_option_word(word)) throw UsageError(word + ": the command comes first; there are " + all + help_of(""));
    std::error_code error;
    if (std::filesystem::exists(word, error))
        throw UsageError(word + " is no command; to render it: render2mpeg render " + word + " -o film.mpg");
    const std::string meant = nearest_of(word, names);
    throw UsageError(word + " is no command" +
                     (meant.empty() ? "; there are " + all : "; did you mean " + meant + "? There are " + all) +
                     help_of(""));
}

std::string mistake_text(const CLI::App& command, const CLI::Error& error) {
    static const std::regex named(R"((-[^ :]+): (.*))"), member(R"((.*) not in \{.*\})"),
        range(R"(Value (.*) not in range (\S+ to \S+|\[.*\]))"), convert(R"(Could not convert: (-\S+) = (.*))"),
        required(R"((\S+) is required)"), few(R"((\d+) required .*missing)"), many(R"(At Most (\d+) required.*)"),
        needs(R"((\S+) requires (\S+))"), excludes(R"((\S+) excludes (\S+))");
    std::string text = error.what();
    std::replace(text.begin(), text.end(), '\n', ' ');
    const std::string help = help_of(command.get_name());
    std::smatch found;
    if (std::regex_match(text, found, required)) {
        // Two names where one is a film: its -o is missing.
        const std::vector<std::string> left = command.remaining(true);
        if (found.str(1) == "--output" && command.get_name() == "encode" && !left.empty())
            return left.front() +
                   ": frames go by one name with a number in it, e.g. frames.%04d.png, and the film by -o" + help;
        return missing_text(found.str(1), command.get_name()) + help;
    }
    if (std::regex_match(text, found, needs)) return found.str(1) + ": give " + found.str(2) + " too" + help;
    if (std::regex_match(text, found, excludes))
        return found.str(1) + " and " + found.str(2) + " contradict each other: give one" + help;
    if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr) {
        const std::vector<std::string> left = command.remaining(true);
        std::string extra;
        for (const std::string& word : left) extra += (extra.empty() ? "" : " ") + word;
        if (command.get_name() == "encode")
            return extra + ": frames go by one name with a number in it, e.g. frames.%04d.png, and the film by -o" +
                   help;
        std::error_code error;
        if (command.get_name() == "render" && left.size() == 1 && !std::filesystem::exists(extra, error))
            return extra + ": a scene goes without an option, and the film by -o: -o " + extra + help;
        return extra + ": what is this for? Only one name goes without an option" + help;
    }
    if (std::regex_match(text, found, convert)) {
        const std::string name = found.str(1), value = found.str(2);
        const CLI::Option* option = option_named(command, name);
        return (option != nullptr ? sentence_for(name, *option, value) : name + " " + value + ": cannot be read") +
               help;
    }
    if (!std::regex_match(text, found, named)) return text + help;
    const std::string name = found.str(1), said = found.str(2);
    const CLI::Option* option = option_named(command, name);
    if (option == nullptr) return text + help;
    std::string value;
    for (const std::string& word : option->results()) value += (value.empty() ? "" : " ") + word;
    if (std::regex_match(said, found, member) || std::regex_match(said, found, range))
        return sentence_for(name, *option, found.str(1)) + help;
    if (std::regex_match(said, found, few)) return name + ": its value is missing, " + values_of(*option) + help;
    if (std::regex_match(said, found, many)) return name + " is said more than once: " + value + "; give one" + help;
    return checked_text(name, value, said) + help;
}

}  // namespace render2mpeg::app
