#include "app/run.h"

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <map>
#include <memory>
#include <new>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <thread>

#include "app/commands/commands.h"
#include "app/experiments/experiments.h"
#include "app/farm/farm.h"
#include "app/options/options.h"
#include "app/options/usage_error.h"
#include "app/probe.h"
#include "app/system/interrupt.h"
#include "app/system/memory_limit.h"
#include "app/system/progress.h"
#include "app/system/terminal.h"
#include "parallel/loops.h"
#include "scene/isolation/probe.h"

namespace render2mpeg::app {
namespace {

/// Memory may run out where nobody catches: in a thread of Embree's or TBB's. One line then, too, and what there is of
/// a film stays for --resume.
[[noreturn]] void end_in_one_line() {
    try {
        if (const std::exception_ptr thrown = std::current_exception()) std::rethrow_exception(thrown);
    } catch (const std::bad_alloc&) {
        std::fputs("render2mpeg: out of memory\n", stderr);
        std::_Exit(1);
    } catch (...) {
        // A fault of ours: as loud as usual.
    }
    std::abort();
}

/// Of the loops of this run, for bench/scaling; null: nobody wants one.
std::unique_ptr<parallel::LoopRecord> wanted_record() {
    const char* file = std::getenv("RENDER2MPEG_LOOPS");
    if (file == nullptr || *file == '\0') return nullptr;
    return std::make_unique<parallel::LoopRecord>(file);
}

/// Commands by their names. Each returns the exit status.
const std::map<std::string_view, int (*)(const CommandLine&)> calls{
    {"render", [](const CommandLine& line) { return render(line.render, line.text, nullptr); }},
    {"encode", [](const CommandLine& line) { return encode(line.encode, line.text); }},
    {"plan", [](const CommandLine& line) { return plan(line.render); }},
    {"info", [](const CommandLine& line) { return info(line.info); }},
    {"cost", [](const CommandLine& line) { return cost(line.trial, line.words); }},
    {"tune", [](const CommandLine& line) { return tune(line.trial, line.words, render); }},
    {"compare", [](const CommandLine& line) { return compare(line.trial, line.words); }},
    {"farm", [](const CommandLine& line) { return farm(line.farm, line.words); }},
    {"part", [](const CommandLine& line) { return make_part(line.part); }},
    {"join", [](const CommandLine& line) { return join(line.part); }},
    {"farm-status", [](const CommandLine& line) { return farm_status(line.part); }},
    {"watch", [](const CommandLine& line) { return watch(line.render, line.text); }}};

}  // namespace

int run(int argc, char** argv) {
    hold_standard_descriptors();
    // Where files may not grow any more (ulimit -f), writing fails with a message instead.
    std::signal(SIGXFSZ, SIG_IGN);
    // However this program was started, it wants to know how its probes end.
    std::signal(SIGCHLD, SIG_DFL);
    if (scene::is_probe(argc, argv)) probe(argc, argv);
    keep_freed_memory();
    std::set_terminate(end_in_one_line);
    try {
        expect_stack();
        const CommandLine line = parse({argv, argv + argc});
        if (line.exit_code) return *line.exit_code;
        show_progress_as(progress_style_from(line.progress));
        const std::jthread teller = tell_activities(line.render.quiet);
        const auto record = wanted_record();
        return calls.at(line.command)(line);
    } catch (const std::bad_alloc&) {
        std::fputs("render2mpeg: out of memory\n", stderr);
    } catch (const std::filesystem::filesystem_error& error) {
        const std::string place = error.path1().empty() ? std::string() : error.path1().string() + ": ";
        print_error(place + error.code().message());
    } catch (const UsageError& error) {
        print_error(error.what());
        return 2;
    } catch (const Refusal& error) {
        print_error(error.what());
        return 3;
    } catch (const Interrupted& error) {
        print_error(error.what());
        return InterruptGuard::status();
    } catch (const nlohmann::json::exception&) {
        print_error("what an earlier run or `farm` left of this film is damaged: remove it, and begin anew");
    } catch (const std::exception& error) {
        print_error(error.what());
    }
    return 1;
}

}  // namespace render2mpeg::app
