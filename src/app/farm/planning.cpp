#include "app/farm/farm.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "app/estimate/chunk_shares.h"
#include "app/farm/farm_plan.h"
#include "app/farm/job_files.h"
#include "app/files/file_io.h"
#include "app/files/publish.h"
#include "app/files/work_folder.h"
#include "app/options/usage_error.h"
#include "app/production/production.h"
#include "app/production/resume.h"
#include "app/system/image_reader.h"
#include "app/system/interrupt.h"
#include "app/system/program.h"
#include "core/error.h"
#include "core/scene_formats.h"
#include "core/text.h"
#include "parallel/loops.h"

namespace render2mpeg::app {
namespace {

/// The program of each scheduler's that a submission calls.
std::string needed_by(const std::string& scheduler) {
    if (scheduler == "slurm") return "sbatch";
    if (scheduler == "sge") return "qsub";
    if (scheduler == "kubernetes") return "kubectl";
    if (scheduler == "flamenco") return "curl";
    if (scheduler == "opencue") return "python3";
    return scheduler;  // parallel, openjd, snakemake
}

/// Runs the script. Returns its exit status. Throws core::Error where the scheduler is not at hand.
int submit(const FarmPlan& plan, const std::filesystem::path& script) {
    const std::string needed = needed_by(plan.scheduler);
    if (!is_installed(needed))
        throw core::Error("submitting", plan.folder.string(),
                          fmt::format("there is no {} here; run {} where there is", needed, script.string()));
    if (run_program({script.string()}, Output::passed_on).status != 0)
        throw core::Error("submitting", plan.folder.string(), script.string() + " failed");
    return 0;
}

/// The folder that both are in.
std::filesystem::path common_folder(const std::filesystem::path& a, const std::filesystem::path& b) {
    std::filesystem::path common;
    for (auto one = a.begin(), other = b.begin(); one != a.end() && other != b.end() && *one == *other; ++one, ++other)
        common /= *one;
    return common;
}

void copy_input(const std::filesystem::path& from, const std::filesystem::path& to) {
    std::error_code error;
    std::filesystem::create_directories(to.parent_path(), error);
    if (!error) std::filesystem::copy_file(from, to, std::filesystem::copy_options::overwrite_existing, error);
    if (error) throw core::Error("packing", from.string(), error.message());
}

/// Maps an option's value to its value in a pack: the name of a copy, or a full name.
class PackedNames {
  public:
    explicit PackedNames(std::filesystem::path inputs) : inputs_(std::move(inputs)) {}

    std::string of(const std::string& option, const std::string& value) {
        constexpr std::array<std::string_view, 5> outputs{"-o", "--output", "--stats", "--report", "--aov"};
        constexpr std::array<std::string_view, 3> inputs{"--sky", "--audio", "--keyframes"};
        if (std::ranges::find(outputs, option) != outputs.end()) return full_name(value);
        if (std::ranges::find(inputs, option) == inputs.end() || !is_file(value)) return value;
        const std::filesystem::path name =
            std::filesystem::path("more") /
            fmt::format("{}_{}", ++copied_, std::filesystem::path(value).filename().string());
        copy_input(value, inputs_ / name);
        return name.string();
    }
    static std::string full_name(const std::string& file) {
        std::error_code error;
        return std::filesystem::absolute(file, error).lexically_normal().string();
    }

  private:
    std::filesystem::path inputs_;
    int copied_ = 0;
};

/// Whether Blender has to export a scene.
bool is_exported(const RenderOptions& options) {
    return core::scene_reader_of(options.input) == core::SceneReader::blender;
}

/// Copies a scene with all its files, their places beside each other kept. Returns the scene's new name: of what
/// Blender exported, where it did.
std::filesystem::path copy_scene(const RenderJob& film, const RenderOptions& options,
                                 const std::filesystem::path& inputs) {
    std::vector<std::filesystem::path> files = scene_files_of(film, options);
    if (film.animation->sound) files.push_back(*film.animation->sound);
    std::erase_if(files, [&](const std::filesystem::path& file) {
        return !is_file(file) || (options.sky && canonical_of(file) == canonical_of(*options.sky)) ||
               (is_exported(options) && canonical_of(file) == canonical_of(options.input));
    });
    // What was read first behind the .blend is the export's animation file.
    EXPECTS(!is_exported(options) || !files.empty());
    const std::filesystem::path input = canonical_of(is_exported(options) ? files.front() : options.input);
    std::filesystem::path folder = is_file(input) ? input.parent_path() : input;
    for (const std::filesystem::path& file : files) folder = common_folder(folder, canonical_of(file).parent_path());
    for (const std::filesystem::path& file : files)
        copy_input(file, inputs / "scene" / canonical_of(file).lexically_relative(folder));
    return std::filesystem::path("scene") / input.lexically_relative(folder);
}

/// Copies what Blender exported into the plan's folder, and changes `words` so that they name it: parts need neither
/// Blender nor its cache. Throws core::Error.
void keep_export(FarmPlan& plan, const RenderJob& film, const RenderOptions& options) {
    const auto place = std::find(plan.words.begin() + 2, plan.words.end(), options.input.string());
    if (place == plan.words.end())
        throw core::Error("packing", options.input.string(), "it is not in the command line");
    *place = (plan.inputs() / copy_scene(film, options, plan.inputs())).string();
}

/// Copies all inputs of a film into the plan's folder, and changes `words` and `start` so that they name the copies,
/// and outputs by their full names. Throws core::Error.
void pack_inputs(FarmPlan& plan, const RenderJob& film, const RenderOptions& options) {
    if (options.light_cache)
        throw core::Error("packing", options.light_cache->string(),
                          "a light file cannot be packed; leave --light-cache out");
    const std::filesystem::path inputs = plan.inputs();
    PackedNames names(inputs);
    std::vector<std::string> words(plan.words.begin(), plan.words.begin() + 2);
    bool named = false;
    for (std::size_t i = 2; i < plan.words.size(); ++i) {
        const std::string& word = plan.words[i];
        const std::string& before = plan.words[i - 1];
        const std::size_t equals = word.find('=');
        if (word.starts_with("--") && equals != std::string::npos)
            words.push_back(word.substr(0, equals + 1) + names.of(word.substr(0, equals), word.substr(equals + 1)));
        else if (i >= 2 && (plan.words[i - 2] == "--heatmap" || plan.words[i - 2] == "--also"))
            words.push_back(PackedNames::full_name(word));
        else if (!named && word == options.input.string() && !before.starts_with("-"))
            named = true, words.push_back(copy_scene(film, options, inputs).string());
        else
            words.push_back(names.of(before, word));
    }
    if (!named) {
        // The scene's name stands behind a flag.
        const auto place = std::find(words.begin() + 2, words.end(), options.input.string());
        if (place == words.end()) throw core::Error("packing", options.input.string(), "it is not in the command line");
        *place = copy_scene(film, options, inputs).string();
    }
    plan.words = words;
    plan.start = inputs;
}

/// Writes plan, job files and inputs into one file beside the folder, e.g. film.mpg.farm.tar. Throws core::Error.
void write_pack(const FarmPlan& plan) {
    const std::filesystem::path archive = std::filesystem::path(plan.folder) += ".tar",
                                beside = std::filesystem::path(archive) += ".unfinished";
    // The same files give the same bytes.
    std::vector<std::string> words{"tar",       "--create",  "--force-local",   "--sort=name",       "--mtime=@0",
                                   "--owner=0", "--group=0", "--numeric-owner", "--mode=u=rwX,go=rX"};
    words.push_back("--file=" + beside.string());
    words.push_back("--directory=" + plan.folder.parent_path().string());
    words.emplace_back("--");
    std::error_code error;
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(plan.folder, error)) {
        const std::string name = entry.path().filename().string();
        if (!name.starts_with("part_") && name != "log") names.push_back((plan.folder.filename() / name).string());
    }
    std::ranges::sort(names);
    words.insert(words.end(), names.begin(), names.end());
    const Finished packed = run_program(words, Output::caught);
    if (packed.status == 0) {
        bring_to_disk(beside);
        std::filesystem::rename(beside, archive, error);
    }
    if (packed.status == 0 && !error) return;
    std::filesystem::remove(beside, error);
    throw core::Error("packing", plan.folder.string(),
                      packed.status == 127 ? "there is no program tar"
                                           : "it cannot be written: " + packed.text.substr(0, packed.text.find('\n')));
}

using nlohmann::json;

bool same_parts(const std::vector<FilmPart>& a, const std::vector<FilmPart>& b) {
    const auto chunks = [](const FilmPart& part) { return std::pair(part.chunks.first, part.chunks.last); };
    return std::ranges::equal(a, b, {}, chunks, chunks);
}

std::vector<FilmPart> wanted_parts(const FarmOptions& options, const std::vector<Chunk>& chunks,
                                   const std::vector<double>& shares) {
    return parts_of(chunks, shares, options.parts, options.frames_per_part);
}

/// Reason against continuing an earlier plan in the same folder, in words; empty where there is none.
std::string hindrance(const FarmPlan& earlier, const FarmPlan& plan, const FarmOptions& options,
                      const std::vector<Chunk>& chunks) {
    const std::string difference = difference_of(earlier.facts->at("identity"), plan.facts->at("identity"));
    if (!difference.empty()) return difference;
    if (earlier.packed != plan.packed) return "--pack differs";
    if (earlier.shares.size() != chunks.size()) return "the number of chunks has changed";
    const std::vector<FilmPart> parts = wanted_parts(options, chunks, earlier.shares);
    if (!same_parts(earlier.parts, parts))
        return fmt::format("it has {} parts and not {}", earlier.parts.size(), parts.size());
    return {};
}

/// Removes a farm's files from its folder, and nothing else.
void remove_earlier(const FarmPlan& earlier) {
    std::error_code ignored;
    for (const FilmPart& part : earlier.parts) std::filesystem::remove_all(earlier.folder_of(part), ignored);
    for (const char* name : {plan_name, "joined", "log"}) std::filesystem::remove_all(earlier.folder / name, ignored);
}

/// Takes over what an earlier plan of the same film and parts in this folder decided. Returns whether there is one.
/// Removes an earlier plan of another film if `agreed`, else throws core::Error.
bool take_over(FarmPlan& plan, const FarmOptions& options, const std::vector<Chunk>& chunks, bool agreed) {
    if (!has_plan(plan.folder)) {
        std::error_code error;
        const bool taken = is_there(plan.folder) && !std::filesystem::is_empty(plan.folder, error) &&
                           !is_there(work_folder_of(plan.folder / "plan")) && !is_there(plan.inputs());
        if (taken) throw core::Error("writing", plan.folder.string(), "something of that name is in the way");
        return false;
    }
    const FarmPlan earlier = read_plan(plan.folder);
    const std::string reason = hindrance(earlier, plan, options, chunks);
    if (reason.empty()) {
        plan.facts = earlier.facts;
        plan.parts = earlier.parts;
        plan.shares = earlier.shares;
        return true;
    }
    if (!agreed)
        throw core::Error("writing", plan.folder.string(),
                          "there is a plan already: " + reason + "; --overwrite (-y) begins anew");
    remove_earlier(earlier);
    return false;
}

/// Makes the decisions common to the whole film, and cuts it into parts. Returns false after an interruption.
bool settle_once(RenderJob& film, const RenderOptions& render, FarmPlan& plan, const FarmOptions& options) {
    const json& identity = plan.facts->at("identity");
    const std::filesystem::path name = plan.folder / "plan";
    const auto earlier =
        WorkFolder::is_of(name, identity) ? WorkFolder::Earlier::resumed : WorkFolder::Earlier::removed;
    WorkFolder work(name, identity, earlier);
    const WallClock clock;
    RunStatistics statistics;
    settle(film, render, work, statistics);
    if (!InterruptGuard::requested()) plan.shares = chunk_shares(film, render.quiet);
    if (InterruptGuard::requested()) return false;
    plan.parts = wanted_parts(options, film.chunks(), plan.shares);
    json settled = json::object();
    for (const char* one : {"exposure", "light", "allocations"})
        if (const json value = work.kept(one); !value.is_null()) settled[one] = value;
    work.remove();
    plan.facts->update(
        {{"settled", settled},
         {"cost", {{"seconds", statistics.seconds}, {"wall", clock.seconds(statistics)}, {"cpu", cpu_seconds()}}}});
    return true;
}

/// What an earlier plan has of its inputs, which goes when a new one is agreed to, and comes back else.
class EarlierInputs {
  public:
    explicit EarlierInputs(const FarmPlan& plan) : inputs_(plan.inputs()), aside_(inputs_) {
        aside_ += ".earlier";
        std::error_code none;
        std::filesystem::rename(inputs_, aside_, none);
        std::filesystem::remove_all(inputs_, none);
    }
    EarlierInputs(const EarlierInputs&) = delete;
    EarlierInputs& operator=(const EarlierInputs&) = delete;
    ~EarlierInputs() {
        if (!is_there(aside_)) return;
        std::error_code ignored;
        std::filesystem::remove_all(inputs_, ignored);
        std::filesystem::rename(aside_, inputs_, ignored);
    }
    void drop() {
        std::error_code ignored;
        std::filesystem::remove_all(aside_, ignored);
    }

  private:
    std::filesystem::path inputs_, aside_;
};

std::string plan_line(const FarmPlan& plan, const FarmOptions& options, const std::vector<Chunk>& chunks) {
    const std::string parts = core::counted(plan.parts.size(), "part");
    std::string text;
    if (options.parts && static_cast<std::size_t>(*options.parts) > plan.parts.size())
        text = fmt::format("{} parts were asked for; the film has {} of {} frames: {}\n", *options.parts,
                           core::counted(chunks.size(), "chunk"), chunks.front().frames(), parts);
    const auto count = static_cast<double>(plan.parts.size());
    return text + fmt::format("{}: {} of {} frames at most; the longest takes {:.2g} times the mean by forecast\n",
                              core::printable(plan.folder.string()), parts, plan.most_frames(),
                              count * plan.share_of(plan.longest_first().front()) /
                                  std::reduce(plan.shares.begin(), plan.shares.end()));
}

/// The plan of a film, not settled yet. With --pack, its inputs are copied, of a .blend always its export, and the film
/// and the options are those of the copies.
FarmPlan begin_plan(const FarmOptions& options, const std::vector<std::string>& words, RenderJob& film,
                    RenderOptions& render, std::optional<EarlierInputs>& earlier) {
    FarmPlan plan;
    std::error_code error;
    plan.words = render_words(words);
    plan.start = std::filesystem::current_path(error);
    plan.folder = std::filesystem::absolute(farm_folder_of(render.output), error).lexically_normal();
    plan.scheduler = options.scheduler;
    plan.output_name = render.output.filename().string();
    plan.packed = options.pack;
    check_job_files(plan);
    if (options.pack || is_exported(render)) {
        earlier.emplace(plan);
        if (options.pack)
            pack_inputs(plan, film, render);
        else
            keep_export(plan, film, render);
        std::filesystem::current_path(plan.start);
        render = parse(plan.words).render;
        render.quiet = options.render.quiet;
        film = prepare_within_memory(render);
    }
    plan.facts = std::make_shared<json>();
    (*plan.facts)["identity"] = farm_identity(plan, film, render);
    return plan;
}

}  // namespace

int farm(const FarmOptions& options, const std::vector<std::string>& words) {
    const parallel::ThreadLimit threads(options.render.threads);
    const InterruptGuard guard(options.render.quiet);
    RenderOptions render = parse(render_words(words)).render;
    render.quiet = options.render.quiet;
    if (render.as) throw UsageError("-o -: parts need a name to lie beside; give one, such as -o film.mpg");
    RenderJob film = prepare_within_memory(render);
    if (InterruptGuard::requested()) return InterruptGuard::status();
    print_notes(film, render);
    check_outputs(film, render);
    if (!render.memory) film.images->read_ahead(image_probes(false));
    const std::filesystem::path before = std::filesystem::current_path();
    check_writable(farm_folder_of(render.output) / plan_name);
    std::optional<EarlierInputs> inputs;
    FarmPlan plan = begin_plan(options, words, film, render, inputs);
    const bool goes_on = take_over(plan, options, film.chunks(), render.overwrite);
    if (!goes_on || plan.is_joined()) require_consent(written_by(film, render), render.overwrite);
    if (inputs) inputs->drop();
    std::error_code ignored;
    std::filesystem::remove(plan.joined_mark(), ignored);
    if (!goes_on && !settle_once(film, render, plan, options)) return InterruptGuard::status();
    // The join needs no second consent.
    if (!render.overwrite) plan.words.emplace_back("--overwrite");
    write_plan(plan);
    const std::filesystem::path script = write_job_files(plan);
    std::filesystem::current_path(before);
    if (plan.packed) write_pack(plan);
    if (!render.quiet)
        print(plan_line(plan, options, film.chunks()) + (goes_on ? "what was planned and made before is kept\n" : "") +
              core::printable(script.string()) + " submits them\n");
    return options.submit ? submit(plan, script) : 0;
}

}  // namespace render2mpeg::app
