#include "app/farm/farm.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>

#include "app/farm/farm_plan.h"
#include "app/farm/job_files.h"
#include "app/farm/pack.h"
#include "app/files/file_io.h"
#include "app/files/publish.h"
#include "app/files/work_folder.h"
#include "app/loop/resume.h"
#include "app/options/option_text.h"
#include "app/options/usage_error.h"
#include "app/production/production.h"
#include "app/system/image_reader.h"
#include "app/system/interrupt.h"
#include "core/error.h"
#include "core/text.h"
#include "parallel/loops.h"

namespace render2mpeg::app {
namespace {

using nlohmann::json;

RenderOptions read_words(std::vector<std::string> words) {
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    return parse(static_cast<int>(arguments.size()), arguments.data()).render;
}

bool same_parts(const std::vector<FilmPart>& a, const std::vector<FilmPart>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const FilmPart& one, const FilmPart& other) {
        return one.chunks.first == other.chunks.first && one.chunks.last == other.chunks.last;
    });
}

/// Reason against continuing an earlier plan in the same folder, in words; empty where there is none.
std::string hindrance(const FarmPlan& earlier, const FarmPlan& plan) {
    const std::string difference = difference_of(earlier.facts->at("identity"), plan.facts->at("identity"));
    if (!difference.empty()) return difference;
    if (earlier.packed != plan.packed) return "--pack differs";
    if (!same_parts(earlier.parts, plan.parts))
        return fmt::format("it has {} parts and not {}", earlier.parts.size(), plan.parts.size());
    return {};
}

/// Removes a farm's files from its folder, and nothing else.
void remove_earlier(const FarmPlan& earlier) {
    std::error_code ignored;
    for (const FilmPart& part : earlier.parts) std::filesystem::remove_all(earlier.folder_of(part), ignored);
    for (const char* name : {"plan.json", "joined", "log"}) std::filesystem::remove_all(earlier.folder / name, ignored);
}

/// Values settled by an earlier plan of the same film and parts in this folder; null where there is none. Removes an
/// earlier plan of another film if `agreed`, else throws core::Error.
json take_over(const FarmPlan& plan, bool agreed) {
    if (!has_plan(plan.folder)) {
        std::error_code error;
        const bool taken = std::filesystem::exists(plan.folder, error) &&
                           !std::filesystem::is_empty(plan.folder, error) &&
                           !std::filesystem::exists(work_folder_of(plan.folder / "plan"), error) &&
                           !std::filesystem::exists(plan.folder / "inputs", error);
        if (taken) throw core::Error("writing", plan.folder.string(), "something of that name is in the way");
        return {};
    }
    const FarmPlan earlier = read_plan(plan.folder);
    const std::string reason = hindrance(earlier, plan);
    if (reason.empty()) return *earlier.facts;
    if (!agreed)
        throw core::Error("writing", plan.folder.string(),
                          "there is a plan already: " + reason + "; --overwrite (-y) begins anew");
    remove_earlier(earlier);
    return {};
}

/// Makes the decisions common to the whole film. None after an interruption.
std::optional<json> settle_once(RenderJob& film, const RenderOptions& options, const FarmPlan& plan) {
    const json& identity = plan.facts->at("identity");
    const std::filesystem::path name = plan.folder / "plan";
    const auto earlier =
        WorkFolder::is_of(name, identity) ? WorkFolder::Earlier::resumed : WorkFolder::Earlier::removed;
    WorkFolder work(name, identity, earlier);
    const WallClock clock;
    RunStatistics statistics;
    settle(film, options, work, statistics);
    if (InterruptGuard::requested()) return {};
    json settled = json::object();
    for (const char* one : {"exposure", "light", "allocations"})
        if (const json value = work.kept(one); !value.is_null()) settled[one] = value;
    work.remove();
    return json{
        {"settled", settled},
        {"cost", {{"seconds", statistics.seconds}, {"wall", clock.seconds(statistics)}, {"cpu", cpu_seconds()}}}};
}

std::string plan_line(const FarmPlan& plan, const FarmOptions& options, std::size_t chunks) {
    const FilmPart& first = plan.parts.front();
    std::string text;
    if (options.parts && static_cast<std::size_t>(*options.parts) > plan.parts.size())
        text =
            fmt::format("{} parts were asked for; the film has {} chunk{} of {} frames: {} part{}\n", *options.parts,
                        chunks, chunks == 1 ? "" : "s",
                        (first.frames.last + 1 - first.frames.first) / static_cast<std::int64_t>(first.chunks.count()),
                        plan.parts.size(), plan.parts.size() == 1 ? "" : "s");
    std::int64_t most = 0;
    for (const FilmPart& part : plan.parts) most = std::max(most, part.frames.last + 1 - part.frames.first);
    return text + fmt::format("{}: {} part{} of {} frames at most\n", core::printable(plan.folder.string()),
                              plan.parts.size(), plan.parts.size() == 1 ? "" : "s", most);
}

/// The plan of a film, not settled yet. With --pack, its inputs are copied, and the film and the options are those of
/// the copies.
FarmPlan begin_plan(const FarmOptions& options, const std::vector<std::string>& words, RenderJob& film,
                    RenderOptions& render) {
    FarmPlan plan;
    std::error_code error;
    plan.words = render_words(words);
    plan.start = std::filesystem::current_path(error);
    plan.folder = std::filesystem::absolute(farm_folder_of(render.output), error).lexically_normal();
    plan.scheduler = options.scheduler;
    plan.output_name = render.output.filename().string();
    plan.packed = options.pack;
    if (options.pack) {
        pack_inputs(plan, film, render);
        std::filesystem::current_path(plan.start);
        render = read_words(plan.words);
        render.quiet = options.render.quiet;
        film = prepare_within_memory(render);
    }
    plan.parts = parts_of(film.chunks(), options.parts, options.frames_per_part);
    plan.facts = std::make_shared<json>();
    (*plan.facts)["identity"] = farm_identity(plan, film, render);
    return plan;
}

}  // namespace

int farm(const FarmOptions& options, const std::vector<std::string>& words) {
    const parallel::ThreadLimit threads(options.render.threads);
    const InterruptGuard guard(options.render.quiet);
    RenderOptions render = read_words(render_words(words));
    render.quiet = options.render.quiet;
    if (render.as) throw UsageError("-o -: parts need a name to lie beside; give one, such as -o film.mpg");
    RenderJob film = prepare_within_memory(render);
    if (InterruptGuard::requested()) return InterruptGuard::status();
    print_notes(film, render);
    check_outputs(film, render);
    if (!render.memory) film.images->read_ahead(image_probes(false));
    const std::filesystem::path before = std::filesystem::current_path();
    check_writable(farm_folder_of(render.output) / "plan.json");
    FarmPlan plan = begin_plan(options, words, film, render);
    job_templates(plan.scheduler);  // missing ones are told at once
    const json earlier = take_over(plan, render.overwrite);
    if (earlier.is_null() || plan.is_joined()) require_consent(written_by(film, render), render.overwrite);
    std::error_code ignored;
    std::filesystem::remove(plan.joined_mark(), ignored);
    if (earlier.is_null()) {
        const std::optional<json> settled = settle_once(film, render, plan);
        if (!settled) return InterruptGuard::status();
        plan.facts->update(*settled);
    } else {
        plan.facts->update({{"settled", earlier.at("settled")}, {"cost", earlier.at("cost")}});
    }
    // The join needs no second consent.
    if (!render.overwrite) plan.words.emplace_back("--overwrite");
    write_plan(plan);
    const std::filesystem::path script = write_job_files(plan);
    std::filesystem::current_path(before);
    if (plan.packed) write_pack(plan);
    if (!render.quiet)
        print(plan_line(plan, options, film.chunks().size()) +
              (earlier.is_null() ? "" : "what was planned and made before is kept\n") +
              core::printable(script.string()) + " submits them\n");
    return options.submit ? submit(plan, script) : 0;
}

}  // namespace render2mpeg::app
