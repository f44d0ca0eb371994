#include "app/options/options.h"

#include <fmt/format.h>

#include <algorithm>

#include "app/options/coding_options.h"
#include "app/options/encode_options.h"
#include "app/options/experiment_options.h"
#include "app/options/help_format.h"
#include "app/options/scene_options.h"
#include "app/options/tune_options.h"
#include "app/system/memory_limit.h"
#include "core/error.h"
#include "core/rational.h"
#include "core/text.h"
#include "core/view.h"

namespace render2mpeg::app {
namespace {

constexpr const char* run_group = "Run";  ///< a group of options

/// What is written beside the film.
void add_product_options(CLI::App& command, RenderOptions& options) {
    command.add_option("--stats", options.stats, "Write statistics as JSON (docs/stats.md)")
        ->type_name("FILE.json")
        ->group(run_group);
    command
        .add_option("--report", options.report,
                    "Write a page about the render, with plots, for any browser, and its figures as JSON beside it "
                    "(docs/report.md)")
        ->type_name("FILE.html")
        ->group(run_group);
    command
        .add_option(
            "--audit", options.audit,
            "Gather so many pixels of every frame again, from every light point, and find their true light by paths: "
            "say how well tolerances were kept, and how far the picture is off by which cause")
        ->type_name("N")
        ->check(CLI::Range(0, 1 << 20))
        ->capture_default_str()
        ->group(run_group);
    command
        .add_option("--aov", options.layers, "Write one multilayer OpenEXR per frame into this folder (docs/layers.md)")
        ->type_name("DIR")
        ->group(run_group);
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

void add_run_options(CLI::App& command, RenderOptions& options) {
    command.add_option("--threads", options.threads, "Threads; 0: one per core. The film's bytes do not depend on it")
        ->check(CLI::Range(0, 1024))
        ->capture_default_str()
        ->group(run_group);
    command
        .add_option("--isa", options.isa,
                    "Instruction set (default: the best there is). Films differ in a few "
                    "roundings between them")
        ->type_name("sse2|sse4.2|avx|avx2|avx512")
        ->group(run_group);
    add_product_options(command, options);
    command
        .add_option("--memory", options.memory,
                    "Most memory to take, e.g. 8G: refuse what would need more before it is begun, and never swap "
                    "(default: no limit)")
        ->type_name("SIZE")
        ->check(checked(memory_from, ""))
        ->group(run_group);
    command
        .add_flag("--resume", options.resume,
                  "Go on where a run of the same film was interrupted or killed, after its last whole chunk: the same "
                  "bytes as of one run. Begins the film where nothing was left of it (docs/resume.md)")
        ->group(run_group);
    command.add_flag("--dry-run", options.dry_run, "Read and check everything, say what would be done, write nothing")
        ->group(run_group);
    command.add_flag("--quiet", options.quiet, "Print nothing but errors")->group(run_group);
}

CLI::App* add_render_command(CLI::App& app, RenderOptions& options) {
    CLI::App* command = app.add_subcommand("render", "Render a film");
    command->footer(
        "The ending of OUT chooses what is written: .mpg and .vob (MPEG-2 program streams), .ts, .m2v, .mkv, .mp4; "
        ".y4m; or numbered images, e.g. frames.%04d.exr or frames.%04d.png.\n"
        "Example: render2mpeg render animations/cornell -o cornell.mpg --quantiser 6");
    add_scene_options(*command, options);
    command->add_option("-o,--output", options.output, "File to write; the ending chooses its kind")
        ->type_name("OUT")
        ->required();
    add_picture_options(*command, options);
    add_light_options(*command, options);
    add_coding_options(*command, options.coding);
    add_sound_options(*command, options.coding);
    add_run_options(*command, options);
    return command;
}

CLI::App* add_plan_command(CLI::App& app, PlanOptions& options) {
    CLI::App* command = app.add_subcommand("plan", "Show which passes a scene calls for, and why");
    command->footer("Example: render2mpeg plan scene.glb --stats stats.json");
    add_scene_options(*command, options.render);
    const std::string planned = "Plan for a render with this option";
    command->add_option("-o,--output", options.render.output, "Only its ending counts (default: a film)")
        ->type_name("OUT")
        ->group(planned);
    add_tolerance_option(*command, options.render, planned);
    command->add_option("--bitrate", options.render.coding.bitrate, "Films of a rate have a first pass")
        ->type_name("RATE")
        ->group(planned);
    command->add_option("--passes", options.render.coding.passes, "With --bitrate: 1 or 2 (default: 2)")
        ->check(CLI::Range(1, 2))
        ->group(planned);
    command->add_option("--exposure", options.render.exposure, "EV, or `auto`: then it is measured")
        ->type_name("auto|EV")
        ->check(checked(check_exposure, ""))
        ->capture_default_str()
        ->group(planned);
    command->add_option("--view", options.render.view, "What bright light becomes (default: the scene's, or neutral)")
        ->type_name("NAME")
        ->check(checked(core::view_from, ""))
        ->group(planned);
    command->add_option("--cache", options.render.cache, "Light kept for other pixels and frames: on, off or auto")
        ->check(CLI::IsMember({"on", "off", "auto"}))
        ->capture_default_str()
        ->group(planned);
    command->add_option("--audit", options.render.audit, "Pixels of every frame")
        ->type_name("N")
        ->check(CLI::Range(0, 1 << 20))
        ->group(planned);
    command->add_option("--aov", options.render.layers, "Folder of multilayer OpenEXR files")
        ->type_name("DIR")
        ->group(planned);
    command->add_option("--stats", options.statistics, "Statistics of a render of this scene: adds what each pass cost")
        ->type_name("FILE.json")
        ->group(run_group);
    return command;
}

/// What was wrong with the command line, as one line that says where help is.
std::string mistake_text(const CLI::App* app, const CLI::Error& error) {
    std::string text = error.what(), command = "render2mpeg";
    std::replace(text.begin(), text.end(), '\n', ' ');
    for (const CLI::App* chosen : app->get_subcommands()) command += " " + chosen->get_name();
    return core::printable("render2mpeg: " + text + " (see " + command + " --help)") + "\n";
}

/// "render, encode, plan, info"
std::string commands_of(const CLI::App& app) {
    std::string names;
    for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
        names += (names.empty() ? "" : ", ") + command->get_name();
    return names;
}

/// Long names of the options that were given.
std::vector<std::string> given_of(const CLI::App& command) {
    std::vector<std::string> names;
    for (const CLI::Option* option : command.get_options())
        if (option->count() > 0 && !option->get_lnames().empty()) names.push_back("--" + option->get_lnames().front());
    return names;
}

/// What was said of each of them.
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
    // What would not be shown is written as numbers; every shell but the oldest reads them.
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

    CLI::App app("Renders a 3D animation with global illumination straight into an MPEG-2 file.", "render2mpeg");
    app.set_version_flag("--version", "render2mpeg " RENDER2MPEG_VERSION);
    app.require_subcommand(1);
    app.failure_message(mistake_text);
    app.footer(
        "Exit status: 0 done; 1 refused or failed, with one line that says why; 130 interrupted (143 by SIGTERM, 129 "
        "where the terminal was closed), with what there is of the film beside its name. `render2mpeg COMMAND --help` "
        "shows a command's options.");
    app.formatter(help_format());

    const CLI::App* render = add_render_command(app, line.render);
    const CLI::App* encode = add_encode_command(app, line.encode);
    const CLI::App* plan = add_plan_command(app, line.plan);
    const CLI::App* info = add_info_command(app, line.info);
    const CLI::App* cost = add_cost_command(app, line.cost);
    const CLI::App* tune = add_tune_command(app, line.tune);
    const CLI::App* compare = add_compare_command(app, line.compare);

    // CLI11 would only say that a command is missing.
    const auto named = [&](const CLI::App* command) { return command->get_name() == argv[1]; };
    if (argc > 1 && argv[1][0] != '-' && app.get_subcommands(named).empty())
        throw core::Error(std::string(argv[1]) + " is no command; there are " + commands_of(app));
    if (argc < 2) throw core::Error("which command? There are " + commands_of(app) + " (see render2mpeg --help)");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        line.exit_code = app.exit(error) == 0 ? 0 : 1;
        return line;
    }
    line.render.given = given_of(*render);
    line.render.said = said_of(*render);
    line.encode.given = given_of(*encode);
    line.cost.render.given = given_of(*cost);
    line.tune.render.given = given_of(*tune);
    line.tune.render.said = said_of(*tune);
    line.compare.render.given = given_of(*compare);
    line.command = render->parsed()   ? Command::render
                   : encode->parsed() ? Command::encode
                   : plan->parsed()   ? Command::plan
                   : info->parsed()   ? Command::info
                   : cost->parsed()   ? Command::cost
                   : tune->parsed()   ? Command::tune
                                      : Command::compare;
    return line;
}

}  // namespace render2mpeg::app
