#include "app/options/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "app/options/coding_options.h"
#include "app/options/command_options.h"
#include "app/options/help_format.h"
#include "app/options/mistakes.h"
#include "app/options/output_kind.h"
#include "app/options/scene_options.h"
#include "app/options/usage_error.h"
#include "app/system/memory_limit.h"
#include "app/system/progress.h"
#include "core/rational.h"
#include "core/text.h"
#include "core/view.h"

namespace render2mpeg::app {
namespace {

constexpr const char* run_group = "Run";  ///< a group of options

void add_product_options(CLI::App& command, RenderOptions& options) {
    add_option(command, run_group, "--stats", options.stats, "Write statistics as JSON (docs/json.md)", "FILE.json");
    add_option(command, run_group, "--report", options.report,
               "Write a page about the render, with plots, for any browser, and its figures as JSON beside it "
               "(docs/first-film.md)",
               "FILE.html");
    add_option(command, run_group, "--audit", options.audit,
               "Gather so many pixels of every frame again, by reference light, and find their true light by paths: "
               "say how well tolerances were kept, and how far the picture is off by which cause",
               "N", range(0, 1 << 20), shown);
    add_option(command, run_group, "--last-frame", options.last_frame,
               "Show the frame lit last in this picture, in place of the one before, once a second", "FILE.png");
    add_option(command, run_group, "--aov", options.layers,
               "Write one multilayer OpenEXR per frame into this folder (docs/pictures.md)", "DIR");
    command
        .add_option(
            "--heatmap", options.heatmaps,
            "Write a film in false colours beside: what each pixel's light may be off by (`tolerance`), clusters "
            "(`cut`), what it may be off by as gathered (`error`), each macroblock's `quantiser`, or, where "
            "`--cache` keeps light, how many `records` lie in each pixel, the `age` of its light in frames, and its "
            "`reuse`, the share of its "
            "points that it was not gathered for; may be given several times")
        ->allow_extra_args(false)  // at a time: else it would take INPUT behind it for a third word
        ->type_name("tolerance|cut|error|quantiser|records|age|reuse OUT.mpg")
        ->group(run_group);
}

void add_whole_run_options(CLI::App& command, RenderOptions& options) {
    add_flag(command, run_group, "--resume", options.resume,
             "Go on where a run of the same film was interrupted or killed, after its last whole chunk: the same "
             "bytes as of one run. Begins the film where nothing was left of it (docs/first-film.md)");
    add_flag(command, run_group, "--dry-run", options.dry_run,
             "Read and check everything, say what would be done and what it would take, write nothing");
    add_within_option(command, options.within, run_group);
}

void add_memory_options(CLI::App& command, RenderOptions& options) {
    add_option(command, run_group, "--memory", options.memory,
               "Most memory to take, e.g. 8G: refuse what would need more before it is begun, and never swap "
               "(default: no limit)",
               "SIZE", memory_from);
    add_option(command, run_group, "--chunks-at-once", options.chunks_at_once,
               "Chunks of some 60 frames that are made beside each other, each by a thread or more, where one frame "
               "cannot keep all cores busy (default: one for 16 threads, as memory allows; docs/machines.md). The "
               "film's bytes do not depend on it",
               range(1, 1024));
}

/// `whole`: of a command that renders by itself.
void add_run_options(CLI::App& command, RenderOptions& options, bool whole) {
    add_threads_option(command, options.threads);
    add_isa_option(command, options.isa);
    add_product_options(command, options);
    add_memory_options(command, options);
    add_option(command, run_group, "--light-cache", options.light_cache,
               "Begin with the light that earlier runs of the same frames found, and add the light of this one: with "
               "another quantiser, bit rate or codec light takes a third of the time. For light that never changes; "
               "made where it is missing (docs/choosing.md)",
               "FILE");
    if (whole) add_whole_run_options(command, options);
    add_consent_option(command, options.overwrite);
    CLI::Option* quiet = add_flag(command, run_group, "--quiet", options.quiet, "Print nothing but errors");
    add_flag(command, run_group, "-v,--verbose", options.verbose,
             "Also say what runs and why, and what each chunk came to")
        ->excludes(quiet);
}

CLI::App* add_render_command(CLI::App& app, RenderOptions& options) {
    CLI::App* command = app.add_subcommand("render", "Render a film");
    command->footer(
        "The ending of OUT chooses what is written: .mpg and .vob (MPEG-2 program streams), .ts, .m2v, .mkv, .mp4, "
        ".mov; "
        ".y4m; or numbered images, e.g. frames.%04d.exr or frames.%04d.png.\n"
        "Example: render2mpeg render animations/cornell -o cornell.mpg --quantiser 6");
    add_scene_options(*command, options);
    command
        ->add_option("-o,--output", options.output, "File to write; the ending chooses its kind; `-`: standard output")
        ->type_name("OUT")
        ->required();
    add_as_option(*command, options.as, {"ts", "m2v", "y4m"});
    add_flag(*command, "Picture and time", "--preview", options.preview,
             "A draft of every frame, in minutes: half the size unless --size is given, rough light, coded fast; "
             "timing, framing, light and cuts are the film's (docs/pictures.md)");
    add_effort_option(*command, options);
    add_film_options(*command, options);
    add_sound_options(*command, options.coding);
    add_run_options(*command, options, true);
    return command;
}

CLI::App* add_watch_command(CLI::App& app, RenderOptions& options) {
    CLI::App* command = app.add_subcommand("watch", "Show a draft, and a new one whenever the scene's files change");
    command->footer(
        "The draft is that of `render --preview` (docs/pictures.md), shown over and over in ffplay or mpv until the "
        "player is closed. A scene that cannot be read is told in one line; what was shown last stays.\n"
        "Example: render2mpeg watch scene.glb");
    add_scene_options(*command, options);
    command->add_option("-o,--output", options.output, "Write each draft to this file instead of showing it")
        ->type_name("OUT");
    add_option(*command, run_group, "--player", options.player,
               "Player to start: ffplay, mpv, or a program that reads bare MPEG-2", "PROGRAM");
    add_film_options(*command, options);
    add_threads_option(*command, options.threads);
    add_flag(*command, run_group, "--quiet", options.quiet, "Print nothing but errors");
    options.preview = true;
    options.overwrite = true;
    return command;
}

CLI::App* add_plan_command(CLI::App& app, RenderOptions& options) {
    CLI::App* command =
        app.add_subcommand("plan", "Show what a film will take, which passes its scene calls for, and why");
    command->footer("Example: render2mpeg plan scene.glb --within 1m");
    add_scene_options(*command, options);
    command->add_option("-o,--output", options.output, "Only its ending counts (default: a film)")->type_name("OUT");
    add_effort_option(*command, options);
    add_film_options(*command, options);
    add_option(*command, run_group, "--audit", options.audit, "Pixels of every frame that would be gathered again", "N",
               range(0, 1 << 20));
    add_option(*command, run_group, "--aov", options.layers, "Folder of multilayer OpenEXR files", "DIR");
    add_within_option(*command, options.within, run_group);
    add_flag(*command, run_group, "--quiet", options.quiet, "Show no progress");
    add_threads_option(*command, options.threads);
    add_memory_options(*command, options);
    add_isa_option(*command, options.isa);
    return command;
}

CLI::App* add_farm_command(CLI::App& app, FarmOptions& options) {
    CLI::App* command = app.add_subcommand("farm", "Spread a film over many machines");
    command->footer(
        "Settles what is settled once for a film, and writes a plan and job files into OUT.farm. `part` makes a part, "
        "`join` the film: the same bytes as of `render`. Given again, it keeps what is made already "
        "(docs/machines.md).\n"
        "Example: render2mpeg farm scene.glb -o film.mpg --to slurm --parts 8 --submit");
    add_scene_options(*command, options.render);
    command->add_option("-o,--output", options.render.output, "File to write; the ending chooses its kind")
        ->type_name("OUT")
        ->required();
    add_spreading_options(*command, options);
    add_effort_option(*command, options.render);
    add_film_options(*command, options.render);
    add_sound_options(*command, options.render.coding);
    add_run_options(*command, options.render, false);
    return command;
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

}  // namespace

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

CommandLine parse(int argc, char** argv) {
    CommandLine line;
    line.words.assign(argv, argv + argc);
    for (int i = 0; i < argc; ++i) line.text += (i == 0 ? "" : " ") + quoted(argv[i]);

    CLI::App app("Renders a 3D animation with global illumination straight into a film.", "render2mpeg");
    app.set_version_flag("--version", "render2mpeg " RENDER2MPEG_VERSION);
    app.require_subcommand(1);
    app.footer(
        "Exit status: 0 done; 1 refused or failed, with one line that says why; 2 a mistake on the command line; 3 no "
        "part of a farm's film is made here; 130 "
        "interrupted (143 by SIGTERM, 129 where the terminal was closed), with what there is of the film beside its "
        "name. `render2mpeg help COMMAND` shows a command's options.");
    app.formatter(help_format());

    struct Known {
        CLI::App* app;
        Command command;
        std::map<std::string, std::string>* said;  ///< its words are kept there; null: nowhere
        bool shows_progress = true;
    };
    const Known all[] = {{add_render_command(app, line.render), Command::render, &line.render.said},
                         {add_encode_command(app, line.encode), Command::encode, &line.encode.said},
                         {add_plan_command(app, line.plan), Command::plan, &line.plan.said},
                         {add_info_command(app, line.info), Command::info, nullptr, false},
                         {add_cost_command(app, line.cost), Command::cost, &line.cost.render.said},
                         {add_tune_command(app, line.tune), Command::tune, &line.tune.render.said},
                         {add_compare_command(app, line.compare), Command::compare, &line.compare.render.said},
                         {add_watch_command(app, line.watch), Command::watch, &line.watch.said},
                         {add_farm_command(app, line.farm), Command::farm, nullptr},
                         {add_part_command(app, line.part), Command::part, nullptr},
                         {add_join_command(app, line.join), Command::join, nullptr, false},
                         {add_farm_status_command(app, line.farm_status), Command::farm_status, nullptr, false}};
    for (const Known& known : all)
        if (known.shows_progress)
            add_option(*known.app, run_group, "--progress", line.progress,
                       "How far it is: `line`, for people; `minute`, a line a minute, for logs; `json`, a line for "
                       "programs at every step; `openjd`, as OpenJD reads it; or `none`",
                       one_of({"line", "minute", "json", "openjd", "none"}), shown);
    line.exit_code = read(app, without_help_command(line.words));
    if (line.exit_code) return line;
    for (const Known& known : all) {
        if (!known.app->parsed()) continue;
        line.command = known.command;
        if (known.said != nullptr) *known.said = said_of(*known.app);
        // Parts run without a terminal.
        if (known.command == Command::part && known.app->get_option("--progress")->empty()) line.progress = "minute";
    }
    if (line.command == Command::render) settle_stream(line.render.output, line.render.as);
    if (line.command == Command::encode) settle_stream(line.encode.output, line.encode.as);
    return line;
}

std::vector<std::string> changed_command(const std::vector<std::string>& words, const std::string& command,
                                         const std::vector<std::string>& without, const std::vector<std::string>& flags,
                                         const std::vector<std::pair<std::string, std::string>>& with) {
    const auto among = [](const std::string& word, const std::vector<std::string>& names) {
        return std::find(names.begin(), names.end(), word.substr(0, word.find('='))) != names.end();
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

}  // namespace render2mpeg::app
