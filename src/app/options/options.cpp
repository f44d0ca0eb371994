#include "app/options/options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <memory>
#include <sstream>
#include <type_traits>

#include "app/options/mistakes.h"
#include "app/options/option_table.h"
#include "app/options/output_kind.h"
#include "app/options/usage_error.h"
#include "app/system/terminal.h"
#include "core/error.h"
#include "core/text.h"
#include "core/view.h"

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
        if (option->get_required() && !option->get_positional()) text += " (needed)";
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
        std::ranges::replace(text, '\n', ' ');
        return wrapped(text, columns() - name_columns);
    }
};

/// Help as wide as the terminal, defaults as `[=4]`.
std::shared_ptr<CLI::FormatterBase> help_format() {
    return std::make_shared<HelpFormat>();
}

/// A command: its own help, and its options in the order of it (option_table.h).
struct CommandRow {
    const char *name, *text, *footer;
    std::string options;
};

const std::string scene_options =
    "INPUT --camera --projection --stereo --animation --variant --sky --light --indirect --vpls --caustics "
    "--limits ";
const std::string picture_options =
    "--size --fps --frames --hold --display-aspect --pixel-aspect --exposure --shutter --f-stop --focus --fog --glare "
    "--view --grain --peak --transparent ";
const std::string light_options = "--samples --edge-samples --exposure-samples ";
const std::string accuracy_options = "--tolerance --loss --masking --clamp --cache ";
/// Of all commands that code; options of rates stand apart, since some commands set them.
const std::string coding_options = "--for --quantiser --codec --level --crf ";
const std::string rate_options = "--quality --bitrate --cbr --maxrate --vbv --passes ";
const std::string group_options = "--gop --b-pictures --tune --encoder --keyframes ";
const std::string label_options = "--audio --audio-offset --title --timecode ";
const std::string film_options =
    picture_options + light_options + accuracy_options + coding_options + rate_options + group_options;
const std::string product_options =
    "--threads --isa --stats --report --audit --last-frame --aov --also --heatmap --memory "
    "--chunks-at-once --light-cache ";
const std::string trial_options = "--threads --isa --json@trial --report@trial --overwrite --quiet ";

const std::vector<CommandRow> commands{
    {"render", "Render a film",
     "The ending of OUT chooses what is written: .mpg and .vob (MPEG-2 program streams), .ts, .m2v, .mkv, .webm, .gif, "
     ".mp4, .mov; .y4m; or numbered images, e.g. frames.%04d.exr or frames.%04d.png.\n"
     "Example: render2mpeg render animations/cornell -o cornell.mpg --quantiser 6",
     scene_options + "--output@render --as --preview --effort " + film_options + label_options + product_options +
         "--resume --dry-run --within --overwrite --quiet --verbose --progress"},
    {"encode", "Encode frames and motion of any renderer",
     "Motion: OpenEXR files with the number of their frame, as `render --aov` writes them (docs/coding.md).\n"
     "Example: render2mpeg encode shot.%04d.exr -o shot.mpg --motion shot.%04d.exr --exposure 0.5",
     "FRAMES --output@encode --as@encode --projection@encode --stereo@encode --fps@encode --frames@encode "
     "--display-aspect --pixel-aspect --exposure@encode --view@encode --grain@encode --peak@encode "
     "--transparent@encode --motion "
     "--motion-convention " +
         coding_options + rate_options + group_options + label_options +
         "--threads --stats --overwrite --quiet --progress"},
    {"plan", "Show what a film will take, which passes its scene calls for, and why",
     "Example: render2mpeg plan scene.glb --within 1m",
     scene_options + "--output@plan --effort " + film_options +
         "--audit@plan --aov@plan --within --price --machines --cores --quiet@plan --threads --memory --chunks-at-once "
         "--isa "
         "--progress"},
    {"info", "Show how the pictures of a film are coded",
     "Whose encoder made the file does not matter. Exit status 1 where pictures are damaged "
     "(docs/first-film.md).\n"
     "Example: render2mpeg info film.mpg --summary",
     "FILE --json@info --summary"},
    {"cost", "Show what accuracy costs in time, and what it buys",
     "Lights a sample of the film with one tolerance after the other, coupled to its coding and by each --effort; "
     "tells what the whole film takes with each, and by unbiased paths, and what one sees of it "
     "(docs/choosing.md). The reference is dear: it comes first, with an estimate.\n"
     "Example: render2mpeg cost scene.glb --size 320x180 --report cost.html",
     scene_options + "--sample@cost --within@cost --tolerances " + picture_options + light_options +
         "--loss --masking --clamp --cache " + coding_options + group_options + trial_options + "--progress"},
    {"tune", "Find the setting that reaches a quality, rate, size or time",
     "Tries a sample of the film, each try a row of a table, then renders the film and tells what became of it "
     "(docs/choosing.md). Exit status 1 where the target is out of reach, or the film missed it.\n"
     "Example: render2mpeg tune scene.glb --target-psnr 40 --dry-run",
     scene_options +
         "--output@tune --target-psnr --target-ssim --of --target-bitrate --max-size --max-time --sample@tune "
         "--references@tune " +
         picture_options + light_options + accuracy_options + coding_options + "--quality --maxrate --vbv " +
         group_options + label_options + trial_options + "--dry-run@tune --progress"},
    {"compare", "Compare with rendering first and encoding with ffmpeg then",
     "Lights a sample of the film coupled to its coding and by a fixed 2 %, codes the latter by this program, by "
     "ffmpeg as people use it and by its strongest command, and holds all against reference light "
     "(docs/choosing.md). Needs the program ffmpeg. The references are dear: they come first, with an "
     "estimate. With --beside cycles a .blend's film is held against Cycles with a denoiser instead.\n"
     "Example: render2mpeg compare scene.glb --size 640x360 --report compare.html",
     scene_options + "--beside --blender --sample@compare --references@compare --quantisers " + picture_options +
         light_options + "--masking --clamp --cache --codec --crf --gop --b-pictures --tune --encoder " +
         trial_options + "--progress"},
    {"watch", "Show a draft, and a new one whenever the scene's files change",
     "The draft is that of `render --preview` (docs/pictures.md), shown over and over in ffplay or mpv until the "
     "player is closed. A scene that cannot be read is told in one line; what was shown last stays. With --live "
     "another program says what is drawn.\n"
     "Example: render2mpeg watch scene.glb",
     scene_options + "--output@watch --player --live " + film_options + "--threads --quiet --progress"},
    {"farm", "Spread a film over many machines",
     "Settles what is settled once for a film, and writes a plan and job files into OUT.farm. `part` makes a part, "
     "`join` the film: the same bytes as of `render`. Given again, it keeps what is made already "
     "(docs/machines.md).\n"
     "Example: render2mpeg farm scene.glb -o film.mpg --to slurm --parts 8 --submit",
     scene_options + "--output@farm --to --parts --frames-per-part --pack --submit --effort " + film_options +
         label_options + product_options + "--overwrite --quiet --verbose --progress"},
    {"part", "Make one part of a film that `farm` has planned",
     "Goes on where a try before was ended, and waits while another one makes the same part. Exit status: 0 the "
     "part is whole; 1 it failed, and another try may do better; 3 this machine, this version or the inputs are "
     "not those of the plan: another try here fails alike.\n"
     "Example: render2mpeg part film.mpg.farm 3",
     "PLAN I --into@part --after-chunk --threads --memory@part --quiet --progress"},
    {"join", "Put the parts of a film together",
     "Proves that all parts are whole and of one film, puts them together, decodes the film to see that it holds "
     "what was made, and writes all that one run would have written beside it.\n"
     "Example: render2mpeg join film.mpg.farm",
     "PLAN --from --into --threads --quiet"},
    {"farm-status", "Show how far the parts of a film are", "Example: render2mpeg farm-status film.mpg.farm",
     "PLAN --from --price@farm-status --left"}};

std::vector<std::string> values_in(const char* parted) {
    std::vector<std::string> words;
    std::istringstream left(parted);
    for (std::string word; std::getline(left, word, '|');) words.push_back(word);
    return words;
}

/// Why a text is no value of an option; empty where it is one.
std::string objection(const OptionRow& row, const std::string& text) {
    if (*row.words != '\0') {
        const std::vector<std::string> words = values_in(row.words);
        if (std::ranges::find(words, text) == words.end())
            return fmt::format("{}: expected {}{}", text, fmt::join(words, ", "), core::did_you_mean(text, words));
    }
    if (row.range) {
        const auto [low, high, is_whole] = *row.range;
        int number = 0;
        double value = 0;
        // NaN lies in no range.
        if (!(is_whole ? CLI::detail::lexical_cast(text, number) && number >= low && number <= high
                       : CLI::detail::lexical_cast(text, value) && value >= low && value <= high))
            return fmt::format("{}: expected a number from {} to {}", text, low, high);
    }
    if (row.parser) {
        try {
            row.parser(text, row.name().substr(row.name().find_first_not_of('-')));
        } catch (const core::Error& error) {
            return error.what();
        }
    }
    return {};
}

void give_option(CLI::App& command, const OptionRow& row) {
    const std::string names = row.names, own = names.substr(0, names.find('@'));
    CLI::Option& option = std::visit(
        [&]<class Member>(Member member) -> CLI::Option& {
            if constexpr (std::is_same_v<Member, std::monostate>)
                return *command.add_option_function<std::string>(
                    own, [](const std::string& /*parsed*/) {}, row.text);
            else if constexpr (std::is_same_v<Member, bool*>)
                return *command.add_flag(own, *member, row.text);
            else
                return *command.add_option(own, *member, row.text);
        },
        row.member);
    if (*row.group != '\0') option.group(row.group);
    if (*row.values != '\0')
        option.type_name(row.values);
    else if (*row.words != '\0')
        option.type_name(row.words);
    else if (row.range)
        option.type_name(fmt::format("{}..{}", row.range->low, row.range->high));
    if (*row.words != '\0' || row.range || row.parser)
        option.check(CLI::Validator([row](std::string& text) { return objection(row, text); }, ""));
    if (row.is_shown) option.capture_default_str();
    if (*row.shown_as != '\0') option.default_str(row.shown_as);
    if (row.is_required) option.required();
    for (const std::string& other : row.not_with) option.excludes(command.get_option(other));
    if (*row.with != '\0') option.needs(command.get_option(row.with));
    if (row.is_two_words) option.allow_extra_args(false);
}

/// Adds all commands with their options, which set the members of `line`.
void add_commands(CLI::App& app, CommandLine& line) {
    std::map<std::string, OptionRow> rows;
    for (const OptionRow& row : option_rows(line)) rows.emplace(row.id(), row);
    for (const CommandRow& command : commands) {
        CLI::App* const added = app.add_subcommand(command.name, command.text)->footer(command.footer);
        std::istringstream names(command.options);
        for (std::string name; names >> name;) give_option(*added, rows.at(name));
    }
}

/// `help COMMAND` is `COMMAND --help`, `version` --version.
std::vector<std::string> without_help_command(std::vector<std::string> words) {
    if (words.size() == 2 && words[1] == "version") return {words[0], "--version"};
    if (words.size() < 2 || words[1] != "help") return words;
    words.erase(words.begin() + 1);
    words.resize(std::min<std::size_t>(words.size(), 2));
    words.emplace_back("--help");
    return words;
}

/// Returns the exit status where --help or --version was printed. Throws UsageError.
std::optional<int> read(CLI::App& app, const std::vector<std::string>& words) {
    const std::vector<std::string> said(words.begin() + std::min<std::ptrdiff_t>(1, std::ssize(words)), words.end());
    refuse_unknown_command(app, said);
    const auto named = [&](const CLI::App* command) { return command->get_name() == said.front(); };
    const std::vector<const CLI::App*> chosen = std::as_const(app).get_subcommands(named);
    if (!chosen.empty()) refuse_unknown_options(app, *chosen.front(), {said.begin() + 1, said.end()});
    try {
        app.parse(std::vector<std::string>(said.rbegin(), said.rend()));
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error);
        throw UsageError(core::printable(mistake_text(chosen.empty() ? app : *chosen.front(), error)));
    }
    return {};
}

std::map<std::string, std::string> said_of(const CLI::App& command) {
    std::map<std::string, std::string> said;
    for (const CLI::Option* option : command.get_options()) {
        if (option->count() == 0 || option->get_lnames().empty()) continue;
        std::string& text = said["--" + option->get_lnames().front()];
        for (const std::string& word : option->results()) text += (text.empty() ? "" : " ") + word;
    }
    return said;
}

/// Gives the members that commands share to the one that was given.
void hand_on(CommandLine& line) {
    RenderOptions& render = line.render;
    if (line.command == "watch") render.preview = render.overwrite = true;
    static_cast<FilmOptions&>(line.encode) = line.farm.render = line.trial.render = render;
    line.part.threads = render.threads;
    line.part.memory = render.memory;
    line.part.quiet = render.quiet;
    if (line.command == "render") settle_stream(render.output, render.as);
    if (line.command == "encode") settle_stream(line.encode.output, line.encode.as);
}

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

std::string quoted(const std::string& word) {
    constexpr const char* plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_@%+=:,./-";
    if (!word.empty() && word.find_first_not_of(plain) == std::string::npos) return word;
    if (core::printable(word) == word) {
        std::string text = "'";
        for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
        return text + "'";
    }
    // Unprintable bytes become octal escapes.
    std::string text = "$'";
    for (const char c : word) {
        const auto byte = static_cast<unsigned char>(c);
        const bool shown = byte >= 0x20 && byte < 0x7f && c != '\'' && c != '\\';
        text += shown ? std::string(1, c) : fmt::format("\\{:03o}", byte);
    }
    return text + "'";
}

CommandLine parse(const std::vector<std::string>& words) {
    CommandLine line;
    line.words = words;
    line.text = line_of(words);

    CLI::App app("Renders a 3D animation with global illumination straight into a film.", "render2mpeg");
    app.set_version_flag("--version", "render2mpeg " RENDER2MPEG_VERSION);
    app.require_subcommand(1);
    app.footer(
        "Exit status: 0 done; 1 refused or failed, with one line that says why; 2 a mistake on the command line; 3 no "
        "part of a farm's film is made here; 130 "
        "interrupted (143 by SIGTERM, 129 where the terminal was closed), with what there is of the film beside its "
        "name. `render2mpeg help COMMAND` shows a command's options.");
    app.formatter(help_format());
    add_commands(app, line);
    line.exit_code = read(app, without_help_command(line.words));
    if (line.exit_code) return line;
    const CLI::App& given = *app.get_subcommands().front();
    line.command = given.get_name();
    line.render.said = said_of(given);
    for (const auto& [subject, file] : line.heatmaps) line.render.side_films.push_back({subject, file, {}});
    for (const auto& [subject, file] : line.also)
        line.render.side_films.push_back({subject, file, view_and_codec_from(subject)});
    // Parts run without a terminal.
    if (line.command == "part" && given.get_option("--progress")->empty()) line.progress = "minute";
    hand_on(line);
    return line;
}

std::vector<std::string> changed_command(const std::vector<std::string>& words, const std::string& command,
                                         const std::vector<std::string>& without, const std::vector<std::string>& flags,
                                         const std::vector<std::pair<std::string, std::string>>& with) {
    const auto among = [](const std::string& word, const std::vector<std::string>& names) {
        return std::ranges::find(names, word.substr(0, word.find('='))) != names.end();
    };
    std::vector<std::string> changed;
    for (std::size_t i = 0; i < words.size(); ++i) {
        if (i == 1)
            changed.push_back(command);
        else if (among(words[i], flags))
            continue;
        else if (among(words[i], without))
            i += words[i].find('=') == std::string::npos ? 1 : 0;
        else
            changed.push_back(words[i]);
    }
    for (const auto& [name, value] : with) {
        changed.push_back(name);
        if (!value.empty()) changed.push_back(value);
    }
    return changed;
}

std::string line_of(const std::vector<std::string>& words) {
    std::string line;
    for (const std::string& word : words) line += (line.empty() ? "" : " ") + quoted(word);
    return line;
}

std::vector<std::string> render_words(const std::vector<std::string>& farm) {
    const std::vector<std::string> flags{"--submit", "--pack", "--quiet", "-v", "--verbose"};
    std::vector<std::string> without{"--to", "--parts", "--frames-per-part", "-j", "--threads", "--progress"};
    without.insert(without.end(), flags.begin(), flags.end());
    return changed_command(farm, "render", without, flags, {});
}

}  // namespace render2mpeg::app
