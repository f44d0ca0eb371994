#include "app/experiments/experiments.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "app/experiments/comparison.h"
#include "app/experiments/trial_command.h"
#include "app/files/file_io.h"
#include "app/options/option_text.h"
#include "app/system/interrupt.h"
#include "app/system/terminal.h"
#include "core/error.h"
#include "parallel/loops.h"

namespace render2mpeg::app {
namespace {

/// Runs the command; rows are printed as they come.
class Comparing {
  public:
    Comparing(const TrialOptions& options, const RenderJob& film, const Sample& sample, const std::string& ffmpeg);

    void run();
    /// Sets the command of the recommended way.
    void settle(const std::vector<std::string>& words);
    void write(const std::vector<std::string>& words) const;
    const Comparison& found() const { return found_; }

  private:
    const RenderJob& film() const { return trials_.film(); }
    bool is_quiet() const { return options_.render.quiet; }
    void log(const std::string& text) const {
        if (!is_quiet()) print(text);
    }
    void add(std::size_t way, const Trial& trial) {
        found_.ways[way].rows.push_back(trial);
        log(row_text(compare_columns, row_name(found_.ways[way], trial), compare_name_width, trial));
    }
    /// Returns whether nobody interrupted.
    bool try_quantiser(int quantiser, const LitWindows& fixed);

    const TrialOptions& options_;
    std::vector<int> quantisers_;
    Trials trials_;
    Comparison found_;
};

Comparing::Comparing(const TrialOptions& options, const RenderJob& film, const Sample& sample,
                     const std::string& ffmpeg)
    : options_(options),
      quantisers_(in_scale_of(film.coding.codec, quantisers_from(options.quantisers))),
      trials_(film, middle_windows(film, sample.windows, sample.frames), options.references.value_or(4)) {
    trials_.mask_all();
    found_.ffmpeg = ffmpeg;
    check_memory(trials_.bytes_held(true));
    const auto by_ffmpeg = [](const FfmpegWay& way) {
        return Way{way.name, "fixed 2 %, ffmpeg -c:v " + way.encoder + " " + way.options, "fixed=2%", way, {}};
    };
    found_.ways = {{"coupled", "--tolerance coupled", "coupled", {}, {}},
                   {"fixed 2 %, ours", "--tolerance fixed=2%", "fixed=2%", {}, {}},
                   by_ffmpeg(usual_ffmpeg(film.coding.codec)),
                   by_ffmpeg(strongest_ffmpeg(film.coding.codec))};
}

bool Comparing::try_quantiser(int quantiser, const LitWindows& fixed) {
    const RenderJob coded = at_quantiser(film(), quantiser);
    const auto coupled = run_trial(trials_, with_tolerance(coded, {false, 0, true, {}}),
                                   fmt::format("coupled, quantiser {}", quantiser), is_quiet());
    if (!coupled) return false;
    add(coupled_way, *coupled);
    add(fixed_way, told("coding", is_quiet(), [&] { return trials_.coded_again(fixed, coded); }));
    for (const std::size_t way : {usual_way, strongest_way}) {
        const Trials::Codec codec = ffmpeg_codec(*found_.ways[way].ffmpeg, quantiser, film().coding.gop, film().rate);
        add(way, told("ffmpeg", is_quiet(), [&] { return trials_.coded_by(codec, fixed, coded); }));
        if (InterruptGuard::requested()) return false;
    }
    return true;
}

void Comparing::run() {
    if (!light_references(trials_, is_quiet())) return;
    find_truth(trials_, is_quiet());
    log(trial_heading(trials_));
    LitWindows fixed;
    if (!run_trial(trials_, with_tolerance(film(), {}), "fixed 2 %", is_quiet(), &fixed)) return;
    log("\nCPU seconds and size per frame; decoded against that light" +
        std::string(trials_.truth() ? ", PSNR-Y the truth" : "") + ".\n" +
        heads_text(compare_columns, "                    q", compare_name_width));
    for (const int quantiser : quantisers_)
        if (!try_quantiser(quantiser, fixed)) return;
    found_.complete = true;
}

void Comparing::settle(const std::vector<std::string>& words) {
    if (!found_.complete) return;
    const std::size_t row = row_of(found_, film().coding.quantiser);
    const std::vector<WayCost> costs = way_costs(found_, film().frame_count(), row);
    const std::optional<std::size_t> taken = recommended(costs);
    if (!taken) return;
    const Way& way = found_.ways[costs[*taken].way];
    const int quantiser = way.rows[row].quantiser;
    const encoder::Codec codec = film().coding.codec;
    std::vector<std::pair<std::string, std::string>> options{{"--tolerance", way.tolerance}};
    if (!way.ffmpeg) {
        options.emplace_back("--quantiser", std::to_string(quantiser));
        found_.render = render_command(words, options_.render.input, codec, options);
        return;
    }
    options.insert(options.end(), {{"-o", "-"}, {"--as", "y4m"}});
    found_.render = render_command(words, options_.render.input, codec, options) + " | ffmpeg -i - -c:v " +
                    way.ffmpeg->encoder + " " + options_of(*way.ffmpeg, quantiser, film().coding.gop) + " " +
                    options_.render.input.stem().string() + usual_ending(codec);
}

void Comparing::write(const std::vector<std::string>& words) const {
    const std::string answer = answer_of(found_, film().frame_count(), film().coding.quantiser);
    if (found_.complete && !is_quiet()) {
        print(difference_table(found_));
        print_sentence(sentence_of(found_));
        print_sentence(answer);
        if (!found_.render.empty()) print("\n" + found_.render + "\n");
    }
    if (!found_.complete && !is_quiet()) print_line("interrupted: this is a part of the table");
    write_results(options_, trials_, with_head(compare_json(film(), found_), trials_, line_of(words)), [&] {
        return TrialPage{"compare", "coupled, or rendered first",
                         found_.complete ? answer + " " + sentence_of(found_) : "Interrupted: this is a part of it.",
                         compare_page(film(), found_)};
    });
}

}  // namespace

int compare(const TrialOptions& options, const std::vector<std::string>& words) {
    const parallel::ThreadLimit threads(options.render.threads);
    const InterruptGuard guard(options.render.quiet);
    if (quantisers_from(options.quantisers).size() < 2)
        throw core::Error("quantisers " + options.quantisers + ": curves need two or more");
    const std::string ffmpeg = ffmpeg_version();
    const RenderJob film = prepare_trials(options.render, options);
    std::optional<Comparing> comparing;
    if (!InterruptGuard::requested()) {
        comparing.emplace(options, film, sample_from(options.sample.value_or("1x15")), ffmpeg);
        comparing->run();
    }
    if (!comparing || comparing->found().ways[coupled_way].rows.empty())
        return interrupted_before_rows(options.render.quiet);
    comparing->settle(words);
    comparing->write(words);
    return comparing->found().complete ? 0 : InterruptGuard::status();
}

}  // namespace render2mpeg::app
