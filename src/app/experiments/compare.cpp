#include "app/experiments/experiments.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "app/experiments/beside_cycles.h"
#include "app/experiments/comparison.h"
#include "app/experiments/trial.h"
#include "app/experiments/trial_command.h"
#include "app/files/file_io.h"
#include "app/files/temporary_folder.h"
#include "app/system/interrupt.h"
#include "app/system/program.h"
#include "app/system/terminal.h"
#include "core/error.h"
#include "core/text.h"
#include "encoder/av/av.h"
#include "encoder/av/inspect.h"
#include "encoder/av/y4m.h"
#include "encoder/codec.h"
#include "encoder/types.h"
#include "parallel/loops.h"

namespace render2mpeg::app {
namespace {

std::string first_line(const std::string& text) {
    return text.substr(0, text.find('\n'));
}

double seconds_of(const std::vector<std::string>& words) {
    const Finished finished = run_program(words, Output::caught);
    if (finished.status != 0)
        throw core::Error("running", "ffmpeg",
                          finished.text.empty() ? "it failed without a word" : first_line(finished.text));
    return finished.seconds;
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
    for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
        text.replace(at, what.size(), by);
    return text;
}

constexpr const char* strongest =
    "-b:v 400M -lmin {L} -lmax {L} -qmin 1 -qmax 31 -qcomp 0.6 -i_qfactor 0.8 -i_qoffset 0 -b_qfactor 1.5 "
    "-b_qoffset 0 -mbd rd -trellis 2 -mpv_flags +skip_rd+mv0 -mbcmp rd -subcmp satd -dia_size 770 -pre_dia_size 4 "
    "-mepre 2 -last_pred 3 -g {g} -bf 3 -b_strategy 2";

std::string by_crf(encoder::Codec codec, bool slow) {
    if (codec == encoder::Codec::av1) return std::string("-preset ") + (slow ? "3" : "8") + " -crf {q}";
    if (codec == encoder::Codec::vp9)
        return std::string("-deadline good -cpu-used ") + (slow ? "0" : "2") + " -b:v 0 -crf {q}";
    return std::string("-preset ") + (slow ? "slower -tune psnr" : "medium") +
           " -crf {q} -bsf:v filter_units=remove_types=" + (codec == encoder::Codec::h264 ? "6" : "39");
}

/// ffmpeg's number of about the same quality.
int number_for(const FfmpegWay& way, int quantiser) {
    // Theirs are means, ours of P pictures that nothing follows from: 3 coarser, about (docs/measurements.md#codecs).
    const bool by_crf = way.encoder == "libx264" || way.encoder == "libx265";
    return by_crf ? std::max(1, quantiser - 3) : quantiser;
}

/// First line of `ffmpeg -version`. Throws core::Error where there is none.
std::string ffmpeg_version() {
    const Finished finished = run_program({"ffmpeg", "-version"}, Output::caught);
    if (finished.status != 0)
        throw core::Error("running", "ffmpeg", "there is no such program; its package is called ffmpeg");
    return first_line(finished.text);
}

/// Usual settings: a fixed quantiser (or crf), two B pictures, default motion search.
FfmpegWay usual_ffmpeg(encoder::Codec codec) {
    if (codec != encoder::Codec::mpeg2)
        return {"ffmpeg", by_crf(codec, false) + " -g {g}", std::string(encoder::facts_of(codec).ffmpeg.encoder)};
    return {"ffmpeg", "-qscale:v {q} -g {g} -bf 2"};
}

/// Strongest known command for long GOPs: RD decisions, trellis, UMH motion search (docs/measurements.md); for other
/// codecs the slowest preset but one.
FfmpegWay strongest_ffmpeg(encoder::Codec codec) {
    if (codec != encoder::Codec::mpeg2)
        return {"ffmpeg, strongest", by_crf(codec, true) + " -g {g}",
                std::string(encoder::facts_of(codec).ffmpeg.encoder)};
    return {"ffmpeg, strongest", strongest};
}

std::string options_of(const FfmpegWay& way, int quantiser, int gop) {
    return replaced(replaced(replaced(way.options, "{q}", std::to_string(number_for(way, quantiser))), "{L}",
                             std::to_string(118 * quantiser)),
                    "{g}", std::to_string(gop));
}

/// Runs it on one thread for one window; its seconds exclude reading.
Trials::Codec ffmpeg_codec(const FfmpegWay& way, int quantiser, int gop, const core::FrameRate& rate) {
    const std::string options = options_of(way, quantiser, gop);
    const std::string encoder = way.encoder;
    return [options, encoder, rate](const Chunk& window, const std::vector<const core::Picture*>& pictures,
                                    const std::function<void(const core::Picture&)>& decoded) {
        const TemporaryFolder folder;
        const std::string frames = folder.file("frames.y4m"),
                          stream = folder.file(encoder == "mpeg2video" ? "coded.m2v" : "coded.mkv");
        av::Y4mWriter writer(frames, pictures.front()->width(), pictures.front()->height(), rate);
        for (const core::Picture* picture : pictures) writer.write(*picture);
        writer.finish();

        // Code, and time reading alone.
        std::vector<std::string> reading{"ffmpeg",          "-v", "error", "-nostdin", "-y", "-threads", "1",
                                         "-filter_threads", "1",  "-i",    frames};
        std::vector<std::string> coding = reading, nothing = reading;
        const std::string how = "-c:v " + encoder + " -threads 1 " + options;
        for (const std::string_view word : core::words_in(how)) coding.emplace_back(word);
        coding.push_back(stream);
        for (const char* word : {"-f", "null", "-"}) nothing.emplace_back(word);
        Trials::Coded coded;
        coded.seconds = std::max(0.0, seconds_of(coding) - seconds_of(nothing));
        for (const av::PictureFacts& picture : av::inspect(stream).pictures)
            coded.bytes += static_cast<double>(picture.bytes);

        std::int64_t count = 0;
        av::decode(stream, [&](const core::Picture& picture) {
            ++count;
            if (picture.number < window.frames()) decoded(picture);
        });
        if (count != window.frames())
            throw core::Error("decoding", "what ffmpeg coded",
                              std::to_string(count) + " pictures of " + std::to_string(window.frames()));
        return coded;
    };
}

/// Runs the command; rows are printed as they come.
class Comparing {
  public:
    Comparing(const TrialOptions& options, const RenderJob& film, const SampleExtent& sample,
              const std::string& ffmpeg);

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

Comparing::Comparing(const TrialOptions& options, const RenderJob& film, const SampleExtent& sample,
                     const std::string& ffmpeg)
    : options_(options),
      quantisers_(in_scale_of(film.coding.codec, options.quantisers.value_or(std::vector{2, 4, 8, 16}))),
      trials_(film, middle_windows(film, sample.windows, sample.frames), options.references.value_or(4)) {
    trials_.mask_all();
    trials_.weigh_by_solid_angle();
    trials_.ask_installed_metrics();
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
    const auto coupled = run_trial(
        trials_, {fmt::format("coupled, quantiser {}", quantiser), {}, with_tolerance(coded, {false, 0, true, {}})},
        is_quiet());
    if (!coupled) return false;
    add(coupled_way, coupled->trial);
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
    if (!run_trial(trials_, {"fixed 2 %", {}, with_tolerance(film(), {})}, is_quiet(), &fixed)) return;
    log("\nCPU seconds and size per frame; decoded against that light" +
        std::string(trials_.truth() ? ", PSNR-Y the truth" : "") + "." +
        (trials_.are_weighted() ? "\nPSNR-Y is weighted by solid angle (WS-PSNR)." : "") + "\n" +
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
    found_.render = line_of(render_command(words, options_.render.input, codec, choices_of(way, codec, quantiser)));
    if (!way.ffmpeg) return;
    found_.render += " | ffmpeg -i - -c:v " + way.ffmpeg->encoder + " " +
                     options_of(*way.ffmpeg, quantiser, film().coding.gop) + " " +
                     options_.render.input.stem().string() + std::string(encoder::facts_of(codec).usual_ending());
}

void Comparing::write(const std::vector<std::string>& words) const {
    const std::string answer = answer_of(found_, film().frame_count(), film().coding.quantiser);
    if (found_.complete && !is_quiet()) {
        print(difference_table(found_));
        std::vector<NamedTrial> rows;
        for (const Way& way : found_.ways)
            for (const Trial& trial : way.rows) rows.emplace_back(row_name(way, trial), &trial);
        print(installed_table(trials_, compare_name_width, rows));
        print_sentence(sentence_of(found_));
        print_sentence(answer);
        if (!found_.render.empty()) print("\n" + found_.render + "\n");
    }
    if (!found_.complete && !is_quiet()) print_line("interrupted: this is a part of the table");
    nlohmann::json results = compare_json(film(), found_);
    results["psnr_y_by"] = trials_.are_weighted() ? "solid angle" : "pixels";
    write_results(options_, trials_, words, results, [&] {
        return TrialPage{"compare", "coupled, or rendered first",
                         found_.complete ? answer + " " + sentence_of(found_) : "Interrupted: this is a part of it.",
                         compare_page(film(), found_)};
    });
}

}  // namespace

int compare(const TrialOptions& options, const std::vector<std::string>& words) {
    if (options.beside) return compare_beside_cycles(options, words);
    const parallel::ThreadLimit threads(options.render.threads);
    const InterruptGuard guard(options.render.quiet);
    if (options.quantisers && options.quantisers->size() < 2)
        throw core::Error(options.render.as_said("--quantisers") + ": curves need two or more");
    const std::string ffmpeg = ffmpeg_version();
    const RenderJob film = prepare_trials(options.render, options);
    std::optional<Comparing> comparing;
    if (!InterruptGuard::requested()) {
        comparing.emplace(options, film, options.sample.value_or(SampleExtent{1, 15}), ffmpeg);
        comparing->run();
    }
    if (!comparing || comparing->found().ways[coupled_way].rows.empty())
        return interrupted_before_rows(options.render.quiet);
    comparing->settle(words);
    comparing->write(words);
    return comparing->found().complete ? 0 : InterruptGuard::status();
}

}  // namespace render2mpeg::app
