#include "app/compare.h"

#include <fmt/format.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "app/attempts.h"
#include "app/compare_report.h"
#include "app/ffmpeg_program.h"
#include "app/interrupt.h"
#include "app/statistics_json.h"
#include "app/text_file.h"
#include "app/trial_command.h"
#include "core/error.h"
#include "parallel/loops.h"

namespace render2mpeg::app {
namespace {

/// One command in the making: rows are told as they come.
class Comparing {
  public:
    Comparing(const CompareOptions& options, const Production& film, const std::string& ffmpeg);

    /// Returns whether nobody interrupted. In this order.
    bool light_references();
    bool light_fixed();
    bool try_ways();

    const Comparison& found() const { return found_; }
    const Production& film() const { return trials_.film(); }

  private:
    /// Takes a row of a way.
    void add(std::size_t way, const Trial& trial);
    void say(const std::string& text) const {
        if (!options_.render.quiet) print(text);
    }

    const CompareOptions& options_;
    std::vector<int> quantisers_;
    Trials trials_;
    Comparison found_;
    LitWindows fixed_;
};

Comparing::Comparing(const CompareOptions& options, const Production& film, const std::string& ffmpeg)
    : options_(options),
      quantisers_(quantisers_from(options.quantisers)),
      trials_(film, windows_of(film.frames, sample_from(options.sample)), options.references) {
    found_.windows = trials_.windows();
    found_.ffmpeg = ffmpeg;
    tell_memory(trials_.bytes_held(true), options.render.quiet);
    const FfmpegWay usual = usual_ffmpeg(), strongest = strongest_ffmpeg();
    found_.ways = {{"coupled", "--tolerance coupled", {}},
                   {"fixed 2 %, our encoder", "--tolerance fixed=2%", {}},
                   {usual.name, "fixed 2 %, ffmpeg -c:v mpeg2video " + usual.options, {}},
                   {strongest.name, "fixed 2 %, ffmpeg -c:v mpeg2video " + strongest.options, {}}};
}

bool Comparing::light_references() {
    if (!app::light_references(trials_, options_.render.quiet)) return false;
    const renderer::Statistics& statistics = trials_.statistics();
    found_.light_points = statistics.direct_points + statistics.indirect_points;
    found_.references = trials_.references();
    found_.reference_seconds = trials_.reference_seconds();
    say(compare_heading(film(), found_));
    return true;
}

bool Comparing::light_fixed() {
    return run_trial(trials_, {}, film().coding.quantiser, "fixed 2 %", options_.render.quiet, &fixed_).has_value();
}

void Comparing::add(std::size_t way, const Trial& trial) {
    found_.ways[way].rows.push_back(trial);
    say(way_row(found_.ways[way].name, trial));
}

bool Comparing::try_ways() {
    say(way_heading());
    for (const int quantiser : quantisers_) {
        const auto coupled = run_trial(trials_, {false, 0, true, {}}, quantiser,
                                       fmt::format("coupled, quantiser {}", quantiser), options_.render.quiet);
        if (!coupled) return false;
        add(coupled_way, *coupled);
        add(fixed_way, trials_.coded_again(fixed_, quantiser));
        for (const auto& [way, ffmpeg] : {std::pair{usual_way, usual_ffmpeg()}, {strongest_way, strongest_ffmpeg()}}) {
            add(way,
                trials_.coded_by(ffmpeg_codec(ffmpeg, quantiser, film().coding.gop, film().rate), fixed_, quantiser));
            if (InterruptGuard::requested()) return false;
        }
    }
    found_.complete = true;
    return true;
}

}  // namespace

int compare(const CompareOptions& options, const std::string& command) {
    const parallel::ThreadLimit threads(options.render.threads);
    const InterruptGuard guard(options.render.quiet);
    const bool quiet = options.render.quiet;
    if (quantisers_from(options.quantisers).size() < 2)
        throw core::Error("quantisers " + options.quantisers + ": curves need two or more");
    const std::string ffmpeg = ffmpeg_version();
    const Production film = prepare_trials(options.render);
    check_trial_outputs(film, options.render, options.json, options.report);

    Comparing comparing(options, film, ffmpeg);
    if (comparing.light_references() && comparing.light_fixed()) comparing.try_ways();
    const Comparison& found = comparing.found();
    if (found.ways[coupled_way].rows.empty()) {
        if (!quiet) std::fputs("interrupted before the first row: nothing was found out\n", stderr);
        return InterruptGuard::status();
    }

    Attempts attempts;
    if (options.json)
        attempts.attempt([&] { write_json(*options.json, compare_json(comparing.film(), found, command)); });
    if (options.report)
        attempts.attempt([&] { write_compare_report(*options.report, comparing.film(), found, command); });
    if (!quiet && found.complete)
        attempts.attempt([&] {
            print(difference_table(found));
            print_sentence(sentence_of(found));
        });
    if (!found.complete && !quiet) std::fputs("interrupted: this is a part of the table\n", stderr);
    attempts.rethrow();
    return found.complete ? 0 : InterruptGuard::status();
}

}  // namespace render2mpeg::app
