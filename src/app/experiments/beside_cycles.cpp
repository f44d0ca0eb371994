#include "app/experiments/beside_cycles.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "app/experiments/installed_metrics.h"
#include "app/experiments/trial.h"
#include "app/experiments/trial_command.h"
#include "app/files/file_io.h"
#include "app/files/temporary_folder.h"
#include "app/job/eyes.h"
#include "app/options/usage_error.h"
#include "app/system/interrupt.h"
#include "app/system/program.h"
#include "app/system/progress.h"
#include "app/system/terminal.h"
#include "core/error.h"
#include "core/module.h"
#include "core/scene_formats.h"
#include "core/text.h"
#include "encoder/codec.h"
#include "parallel/loops.h"
#include "scene/blender/export.h"

namespace render2mpeg::app {
namespace {

using nlohmann::json;

/// chosen: seconds a frame on a few cores, and edges and hair that one still sees.
constexpr int usual_width = 192;
/// chosen: beyond 512 samples users denoise; the truth has to be better than these.
constexpr int most_samples = 512, truth_samples = 1024;

/// Has all exports and films made by this Blender, by the programs that we start, too.
void use_blender(const std::string& name) {
    if (!is_installed(name)) throw core::Error("running", name, "there is no such program, or it may not be executed");
    setenv("RENDER2MPEG_BLENDER", name.c_str(), 1);
}

void check(const TrialOptions& options) {
    const std::filesystem::path& scene = options.render.input;
    if (core::ending_of(scene) != ".blend")
        throw UsageError("--beside cycles: Cycles renders .blend files, and " + scene.string() + " is none");
    if (options.report)
        throw UsageError("--beside cycles and --report: there is no page of it; --json has its figures");
    // Options that Cycles and `encode` are told as well, or that are about our light alone.
    constexpr std::array<std::string_view, 25> known{
        "--beside",     "--blender",   "--size",         "--frames",
        "--exposure",   "--view",      "--codec",        "--samples",
        "--sample",     "--json",      "--vpls",         "--masking",
        "--clamp",      "--cache",     "--edge-samples", "--exposure-samples",
        "--isa",        "--indirect",  "--caustics",     "--threads",
        "--quantisers", "--overwrite", "--quiet",        "--progress",
        "--limits"};
    for (const auto& [name, words] : options.render.said)
        if (std::ranges::find(known, name) == known.end())
            throw UsageError("--beside cycles and " + name + ": Cycles' picture would not follow it");
    if (options.quantisers && options.quantisers->empty())
        throw UsageError("--beside cycles and --quantisers none: there is nothing to compare");
    if (options.blender) use_blender(*options.blender);
    if (!is_installed("ffmpeg"))
        throw core::Error("running", "ffmpeg", "there is no such program; its package is called ffmpeg");
}

/// The size of each eye's pictures in small.
Size small_size(const RenderJob& film, const RenderOptions& render) {
    const Size whole{film.rendering.format.width, film.rendering.format.height};
    const auto own = film.animation->size.value_or(glm::ivec2(whole.width, whole.height));
    const double shape = 1.0 * whole.width * own.y / (1.0 * whole.height * own.x);
    if (std::abs(shape - 1) > 0.02)
        throw UsageError(
            fmt::format("--beside cycles and --size {}x{}: the film is {}x{}, and another shape has "
                        "another view in Cycles",
                        whole.width, whole.height, own.x, own.y));
    if (render.size || whole.width <= usual_width) return whole;
    return scaled(whole, 1.0 * usual_width / whole.width, film.codec());
}

json order_of(const TrialOptions& options, const RenderJob& film, const std::vector<std::string>& words) {
    std::vector<std::string> without(options_of_trials.begin(), options_of_trials.end());
    without.insert(without.end(), {"--size", "--frames", "--codec", "--exposure", "--progress"});
    const std::string codec(encoder::facts_of(film.coding.codec).word);
    // Windows would measure exposures of their own.
    std::vector<std::string> render =
        changed_command(words, "render", without, {"--quiet", "-y", "--overwrite"},
                        {{"--codec", codec}, {"--exposure", fmt::format("{}", film.exposure.value_or(0))}});
    render[0] = core::program_file().string();
    json windows = json::array();
    for (const Chunk& window : windows_by_shot(film, options.sample.value_or(SampleExtent{3, 3})))
        windows.push_back({window.first, window.last});
    const Size size = small_size(film, options.render);
    return {{"scene", std::filesystem::absolute(options.render.input).string()},
            {"render", render},
            {"codec", codec},
            {"size", {size.width, size.height}},
            {"windows", windows},
            {"quantisers", options.quantisers.value_or(std::vector{4})},
            {"samples", {8, 32, 128}},
            {"most_samples", most_samples},
            {"truth_samples", truth_samples},
            {"threads", options.render.threads},
            {"denoiser", "best"},
            {"everything", false},
            {"quiet", options.render.quiet || !shows_words()}};
}

/// What Blender finds out; null after an interruption.
json found_by_blender(json order) {
    const TemporaryFolder folder;
    const std::string file = folder.file("order.json");
    const std::filesystem::path result = folder.file("result.json");
    order["folder"] = folder.file("films");
    order["result"] = result.string();
    const std::string script = core::installed_file("blender/beside_cycles/compare.py").string();
    tell_activity("");  // it tells its own
    std::vector<std::string> command = scene::words_of_blender(scene::blender_program());
    order["blender"] = command;
    write_json(file, order);
    command.insert(command.end(), {"--background", "--factory-startup", "--disable-autoexec", "-noaudio",
                                   "--python-exit-code", "1", "--python", script, "--", file});
    const Finished finished = run_program(command, Output::errors_passed_on);
    if (InterruptGuard::requested()) return nullptr;
    json found = json::parse(std::ifstream(result), nullptr, false);
    const std::string name = order.at("scene");
    if (!found.is_object())
        throw core::Error("comparing", name, fmt::format("Blender ended with status {}", finished.status));
    if (found.contains("error")) throw core::Error("comparing", name, found.at("error").get<std::string>());
    for (json& window : found.at("windows")) window.erase("films");  // they go with the folder
    return found;
}

double number(const json& row, const char* key) {
    return row.at(key).get<double>();
}

std::string row_of(const std::string& name, int quantiser, const json& row) {
    return fmt::format("{:<24} {:>3} {:>9.2f} {:>8.1f} {:>8.4f} {:>9.1f} {:>8.2f}\n", name, quantiser,
                       number(row, "cpu"), number(row, "psnr_y"), number(row, "ssim_y"), 1e-3 * number(row, "bytes"),
                       number(row, "flicker"));
}

/// Members whose names are numbers, ascending.
std::map<int, json> by_number(const json& object) {
    std::map<int, json> members;
    for (const auto& [name, value] : object.items()) members[std::stoi(name)] = value;
    return members;
}

std::string table_of(const json& found) {
    const json& all = found.at("all");
    std::string text = fmt::format("\n{:<24} {:>3} {:>9} {:>8} {:>8} {:>9} {:>8}\n", "", "q", "CPU s/fr.", "PSNR-Y",
                                   "SSIM", "kB", "flicker");
    for (const auto& [quantiser, ours] : by_number(all.at("ours"))) {
        text += row_of("render2mpeg", quantiser, ours);
        for (const auto& [samples, row] : by_number(all.at("cycles").at(std::to_string(quantiser))))
            text += row_of(fmt::format("Cycles, {} samples", samples), quantiser, row);
    }
    return text;
}

/// Metrics of other programs, or which of them are missing.
std::string installed_table_of(const json& found) {
    const json& all = found.at("all");
    std::string text;
    const auto row = [&](const std::string& name, int quantiser, const json& figures) {
        std::string line = fmt::format("{:<24} {:>3}", name, quantiser);
        bool is_known = false;
        for (const char* key : {"xpsnr_y", "xpsnr_y_low", "ssimulacra2", "ssimulacra2_low"}) {
            is_known = is_known || figures.at(key).is_number();
            line += figures.at(key).is_number() ? fmt::format(" {:>11.2f}", number(figures, key))
                                                : fmt::format(" {:>11}", "-");
        }
        if (is_known) text += line + "\n";
    };
    for (const auto& [quantiser, ours] : by_number(all.at("ours"))) {
        row("render2mpeg", quantiser, ours);
        for (const auto& [samples, figures] : by_number(all.at("cycles").at(std::to_string(quantiser))))
            row(fmt::format("Cycles, {} samples", samples), quantiser, figures);
    }
    const std::string missing = InstalledMetrics().missing();
    if (!text.empty())
        text = fmt::format("\n{:<24} {:>3} {:>11} {:>11} {:>11} {:>11}\n", "", "q", "XPSNR", "lowest 5 %",
                           "SSIMULACRA2", "lowest 5 %") +
               text;
    constexpr int columns = 80;
    return missing.empty() ? text : text + "\n" + wrapped(missing, columns) + "\n";
}

/// Who denoised the peer's pictures, and how.
std::string denoiser_text(const json& found) {
    if (found.at("denoiser") != "blender")
        return "denoised by a stand-in, since it has no OpenImageDenoise: a regression whose time does not count";
    return "denoised by its OpenImageDenoise (albedo and normal, prefiltered accurately), " +
           std::string(found.at("light_tree").get<bool>() ? "with" : "without") + " light tree";
}

/// "3.1 times less CPU", "1.4 times the CPU"
std::string times_text(double times) {
    return times >= 1 ? fmt::format("{:.1f} times less CPU", times) : fmt::format("{:.1f} times the CPU", 1 / times);
}

/// At one quantiser.
std::string sentence_at(int quantiser, const json& equal) {
    const std::string beyond = equal.at("beyond");
    const double times = number(equal, "times"), flicker = number(equal, "flicker");
    if (beyond == "<")
        return fmt::format("at quantiser {} the fewest samples are nearer to the truth already, for {}", quantiser,
                           times_text(1 / times));
    const bool flickers = flicker > 0;  // Windows of one frame have none.
    if (beyond == ">")
        return fmt::format(
            "at quantiser {} no count of samples comes as near to the truth; the best takes {:.1f} "
            "times your film's CPU{}",
            quantiser, times, flickers ? fmt::format(" and has {:.1f} times its flicker", 1 / flicker) : "");
    return fmt::format("at quantiser {} your film takes {} at equal quality{}", quantiser, times_text(times),
                       flickers ? fmt::format(", and has {:.1f} times the flicker", flicker) : "");
}

}  // namespace

std::string sentence_of_peers(const json& found) {
    std::string text;
    for (const auto& [quantiser, equal] : by_number(found.at("all").at("equal")))
        text += (text.empty() ? "Beside Cycles with a denoiser, " : "; ") + sentence_at(quantiser, equal);
    std::string better;
    for (const json& window : found.at("windows"))
        for (const auto& [quantiser, equal] : window.at("equal").items())
            if (number(equal, "times") < 1 && equal.at("beyond") != ">") {
                better += fmt::format("{}{} to {}", better.empty() ? "" : ", ", window.at("first").get<int>(),
                                      window.at("last").get<int>());
                break;
            }
    if (!better.empty()) text += ". Cycles with a denoiser would be better in frames " + better;
    return text + ".";
}

int compare_beside_cycles(const TrialOptions& options, const std::vector<std::string>& words) {
    check(options);
    const parallel::ThreadLimit threads(options.render.threads);
    const InterruptGuard guard(options.render.quiet);
    TrialOptions told = options;
    if (!told.render.coding.codec) told.render.coding.codec = encoder::Codec::h264;
    const RenderJob film = prepare_trials(told.render, told);
    json order = order_of(told, film, words);
    json found = InterruptGuard::requested() ? json() : found_by_blender(order);
    if (found.is_null()) return interrupted_before_rows(options.render.quiet);
    const json size = order.at("size");
    const bool weighted = found.at("windows").front().at("psnr_y_by") != "pixels";
    found["psnr_y_by"] = found.at("windows").front().at("psnr_y_by");
    found.update({{"command", line_of(words)},
                  {"version", RENDER2MPEG_VERSION},
                  {"input", film.animation->source},
                  {"codec", order.at("codec")},
                  {"width", size.at(0)},
                  {"height", size.at(1)},
                  {"truth_samples", truth_samples},
                  {"summary", sentence_of_peers(found)}});
    if (!options.render.quiet) {
        print(fmt::format("{} frames of {}x{}{}, {}; Cycles of Blender {}, {}\n", film.frame_count(),
                          size.at(0).get<int>(), size.at(1).get<int>(), eyes_text(film.animation->stereo),
                          encoder::facts_of(film.coding.codec).name, found.at("blender").get<std::string>(),
                          denoiser_text(found)));
        if (weighted) print_line("PSNR-Y is weighted by solid angle (WS-PSNR).");
        print(table_of(found) + installed_table_of(found));
        print_sentence(found.at("summary"));
    }
    if (options.json) write_json(*options.json, found);
    return 0;
}

}  // namespace render2mpeg::app
