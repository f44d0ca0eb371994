#include "app/experiments/experiments.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "app/experiments/comparison.h"
#include "app/experiments/ffmpeg_program.h"
#include "app/experiments/trial_command.h"
#include "app/files/file_io.h"
#include "app/options/option_text.h"
#include "app/options/options.h"
#include "app/system/error_collector.h"
#include "app/system/interrupt.h"
#include "app/system/terminal.h"
#include "core/error.h"
#include "parallel/loops.h"

namespace render2mpeg::app {
namespace {

/// Runs the command; rows are printed as they come.
class Comparing {
  public:
    Comparing(const CompareOptions& options, const RenderJob& film, const std::string& ffmpeg);

    /// Returns whether nobody interrupted. In this order.
    bool light_references();
    /// Everything that is timed, once.
    bool run_all();
    /// Replaces times by the medians of all runs.
    void conclude();
    void look_at_foreign_film();
    /// Sets the command of the recommended way.
    void settle(const std::vector<std::string>& words, const std::filesystem::path& input);

    const Comparison& found() const { return found_; }
    const RenderJob& film() const { return trials_.film(); }

  private:
    /// Adds a row to a way, or a further run's times to a known one.
    void add(std::size_t way, const Trial& trial);
    bool light_fixed();
    void log(const std::string& text) const {
        if (!options_.render.quiet) print(text);
    }
    std::string in_run(const std::string& name) const {
        return options_.runs == 1 ? name : fmt::format("run {}, {}", runs_ + 1, name);
    }

    const CompareOptions& options_;
    std::vector<int> quantisers_;
    Trials trials_;
    Comparison found_;
    LitWindows fixed_;
    int runs_ = 0;  ///< whole ones
};

Comparing::Comparing(const CompareOptions& options, const RenderJob& film, const std::string& ffmpeg)
    : options_(options),
      quantisers_(in_scale_of(film.coding.codec, quantisers_from(options.quantisers))),
      trials_(film, windows_of(film.frames, sample_from(options.sample)), options.references) {
    found_.windows = trials_.windows();
    if (options.kept_references) trials_.keep_references_in(ReferenceCache(*options.kept_references));
    trials_.mask_all();
    found_.ffmpeg = ffmpeg;
    print_memory_note(trials_.bytes_held(true), options.render.quiet);
    const encoder::Codec codec = film.coding.codec;
    const FfmpegWay usual = usual_ffmpeg(codec), strongest = strongest_ffmpeg(codec),
                    free = strongest_free_ffmpeg(codec);
    const std::string gop = std::to_string(film.coding.gop), longer = std::to_string(free_gop);
    const auto ours = [](const std::string& name, const std::string& tolerance, const std::string& pictures) {
        return Way{name,
                   "--tolerance " + tolerance + " --gop " + pictures,
                   {{"--tolerance", tolerance}, {"--gop", pictures}},
                   std::nullopt,
                   {},
                   {}};
    };
    const auto by_ffmpeg = [](const FfmpegWay& way, const std::string& pictures) {
        return Way{way.name,
                   "fixed 2 %, ffmpeg -c:v " + way.encoder + " " + way.options,
                   {{"--tolerance", "fixed=2%"}, {"--gop", pictures}},
                   way,
                   {},
                   {}};
    };
    found_.ways = {ours("coupled", "coupled", gop),
                   ours("fixed 2 %, ours", "fixed=2%", gop),
                   ours("fixed 2 %, ours, free", "fixed=2%", longer),
                   by_ffmpeg(usual, gop),
                   by_ffmpeg(strongest, gop),
                   by_ffmpeg(free, longer)};
}

bool Comparing::light_references() {
    if (!app::light_references(trials_, options_.render.quiet)) return false;
    const renderer::Statistics& statistics = trials_.statistics();
    found_.light_points = statistics.direct_points + statistics.indirect_points;
    found_.references = trials_.references();
    found_.reference_seconds = trials_.reference_seconds();
    log(compare_heading(film(), found_));
    return true;
}

bool Comparing::light_fixed() {
    LitWindows again;
    LitWindows& keep = runs_ == 0 ? fixed_ : again;
    const auto trial =
        run_trial(trials_, {}, film().coding.quantiser, in_run("fixed 2 %"), options_.render.quiet, &keep);
    if (trial) fixed_.light = *trial;  // its pictures are the same, its time is this run's
    return trial.has_value();
}

void Comparing::add(std::size_t index, const Trial& trial) {
    Way& way = found_.ways[index];
    if (runs_ == 0) {
        way.rows.push_back(trial);
        way.times.emplace_back();
        log(way_row(way.name, trial));
    }
    for (std::size_t i = 0; i < way.rows.size(); ++i)
        if (way.rows[i].quantiser == trial.quantiser) {
            way.times[i].light.push_back(trial.seconds);
            way.times[i].code.push_back(trial.code_seconds);
        }
}

bool Comparing::run_all() {
    if (!light_fixed()) return false;
    if (runs_ == 0) log(way_heading());
    for (const int quantiser : quantisers_) {
        const auto coupled = run_trial(trials_, {false, 0, true, {}}, quantiser,
                                       in_run(fmt::format("coupled, quantiser {}", quantiser)), options_.render.quiet);
        if (!coupled) return false;
        add(coupled_way, *coupled);
        const bool quiet = options_.render.quiet;
        add(fixed_way, told("coding", quiet, [&] { return trials_.coded_again(fixed_, quantiser); }));
        Coarseness free(quantiser);
        free.gop = free_gop;
        add(free_way, told("coding", quiet, [&] { return trials_.coded_again(fixed_, free); }));
        const auto by_ffmpeg = [&](std::size_t way, const FfmpegWay& ffmpeg, int gop) {
            add(way, told(in_run("ffmpeg"), quiet, [&] {
                    return trials_.coded_by(ffmpeg_codec(ffmpeg, quantiser, gop, film().rate), fixed_, quantiser);
                }));
            return !InterruptGuard::requested();
        };
        if (!by_ffmpeg(usual_way, usual_ffmpeg(film().coding.codec), film().coding.gop) ||
            !by_ffmpeg(strongest_way, strongest_ffmpeg(film().coding.codec), film().coding.gop) ||
            !by_ffmpeg(strongest_free_way, strongest_free_ffmpeg(film().coding.codec), free_gop))
            return false;
    }
    found_.runs = ++runs_;
    found_.complete = runs_ == options_.runs;
    return true;
}

void Comparing::conclude() {
    for (Way& way : found_.ways)
        for (std::size_t i = 0; i < way.rows.size(); ++i) {
            way.rows[i].seconds = median(way.times[i].light);
            way.rows[i].code_seconds = median(way.times[i].code);
        }
    if (!found_.complete) return;
    log(time_table(found_));
    if (found_.foreign) log(foreign_lines(found_));
}

void Comparing::settle(const std::vector<std::string>& words, const std::filesystem::path& input) {
    if (!found_.complete || found_.ways[coupled_way].rows.empty()) return;
    const std::size_t row = row_of(found_, film().coding.quantiser);
    const std::vector<WayCost> costs = way_costs(found_, film().frame_count(), row);
    const std::optional<std::size_t> taken = recommended(costs);
    if (!taken) return;
    const Way& way = found_.ways[costs[*taken].way];
    const int quantiser = way.rows[row].quantiser;
    auto options = way.options;
    if (!way.ffmpeg) {
        options.emplace_back("--quantiser", std::to_string(quantiser));
        found_.render = render_command(words, input, film().coding.codec, options);
        return;
    }
    const std::string pictures = options.back().second;
    options.back() = {"-o", "-"};
    options.emplace_back("--as", "y4m");
    found_.render = render_command(words, input, film().coding.codec, options) + " | ffmpeg -i - -c:v " +
                    way.ffmpeg->encoder + " " + options_of(*way.ffmpeg, quantiser, std::stoi(pictures)) + " " +
                    input.stem().string() + usual_ending(film().coding.codec);
}

void Comparing::look_at_foreign_film() {
    if (!options_.film) return;
    found_.foreign = told("the other film", options_.render.quiet, [&] {
        return look_at_foreign(*options_.film, *options_.reference, film().exposure.value_or(0), film().view);
    });
}

}  // namespace

int compare(const CompareOptions& options, const std::vector<std::string>& words) {
    const std::string command = line_of(words);
    const parallel::ThreadLimit threads(options.render.threads);
    const InterruptGuard guard(options.render.quiet);
    const bool quiet = options.render.quiet;
    if (quantisers_from(options.quantisers).size() < 2)
        throw core::Error("quantisers " + options.quantisers + ": curves need two or more");
    const std::string ffmpeg = ffmpeg_version();
    const auto interrupted = [&] {
        if (!quiet) print_line("interrupted before the first row: nothing was found out");
        return InterruptGuard::status();
    };
    require_trial_consent(options);
    RenderOptions render = options.render;
    if (!render.coding.gop) render.coding.gop = short_gop;
    const RenderJob film = prepare_trials(render);
    if (InterruptGuard::requested()) return interrupted();
    check_trial_outputs(film, options);

    Comparing comparing(options, film, ffmpeg);
    comparing.look_at_foreign_film();
    if (comparing.light_references())
        for (int i = 0; i < options.runs && comparing.run_all(); ++i) {
        }
    comparing.conclude();
    comparing.settle(words, options.render.input);
    const Comparison& found = comparing.found();
    if (found.ways[coupled_way].rows.empty()) return interrupted();

    ErrorCollector errors;
    if (options.json)
        errors.attempt([&] { write_json(*options.json, compare_json(comparing.film(), found, command)); });
    if (options.report)
        errors.attempt([&] { write_compare_report(*options.report, comparing.film(), found, command); });
    if (!quiet && found.complete)
        errors.attempt([&] {
            print(difference_table(found));
            print_sentence(sentence_of(found));
            print_sentence(answer_of(found, comparing.film().frame_count(), comparing.film().coding.quantiser));
            if (!found.render.empty()) print("\n" + found.render + "\n");
        });
    if (!found.complete && !quiet) print_line("interrupted: this is a part of the table");
    errors.rethrow();
    return found.complete ? 0 : InterruptGuard::status();
}

}  // namespace render2mpeg::app
