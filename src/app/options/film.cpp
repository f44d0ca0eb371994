#include "app/options/film.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <utility>

#include "app/options/option_text.h"
#include "app/options/output_kind.h"
#include "app/options/usage_error.h"
#include "core/error.h"
#include "core/plain_file.h"
#include "core/text.h"
#include "encoder/av/av.h"
#include "encoder/av/coders.h"
#include "encoder/av/levels.h"
#include "encoder/cadence.h"
#include "encoder/capabilities.h"
#include "encoder/codec.h"
#include "encoder/timecode.h"
#include "perceptual/display.h"

namespace render2mpeg::app {
namespace {

[[noreturn]] void refuse_preview(const RenderOptions& options, const std::string& option, const std::string& why) {
    throw UsageError(option + ": with " + (options.effort == "draft" ? "--effort draft " : "--preview ") + why);
}

/// The eye's, where a codec has quantisers by block: people compare films with its encoders' usual ones.
encoder::Tune tune_of(const CodingOptions& options, encoder::Codec codec) {
    const encoder::CodecFacts& facts = encoder::facts_of(codec);
    if (!options.tune)
        return facts.takes_blocks && codec != encoder::Codec::mpeg2 ? encoder::Tune::perceptual : encoder::Tune::psnr;
    if (*options.tune == "perceptual" && !facts.takes_blocks && !facts.master)
        throw UsageError(fmt::format("--tune perceptual: {} takes no quantisers of blocks; choose --codec h264 or hevc",
                                     facts.name));
    return *options.tune == "perceptual" ? encoder::Tune::perceptual : encoder::Tune::psnr;
}

}  // namespace

const Effort& effort_from(const std::string& name) {
    const auto found = std::ranges::find(efforts, name, &Effort::name);
    if (found == efforts.end()) throw UsageError("--effort " + name + ": expected draft, low, default or high");
    return *found;
}

RenderOptions with_effort(const RenderOptions& options) {
    if (!options.effort || *options.effort == "default") return options;
    RenderOptions changed = options;
    if (*options.effort == "draft") {
        changed.preview = true;
        return changed;
    }
    const Effort& effort = effort_from(*options.effort);
    const bool coded = options.output.empty() || kind_of(options.output) == OutputKind::film;
    const bool master = coded && encoder::facts_of(codec_of(options.coding, options.output)).master;
    if (!options.tolerance && (!coded || master))
        changed.tolerance = fixed_tolerance((master ? 0.5f : 1.0f) * effort.fixed);
    if (!options.loss) changed.loss = effort.loss;
    if (options.is_given("--samples") || options.edge_samples) return changed;
    changed.samples = effort.samples;
    changed.edge_samples = effort.edge_samples;
    return changed;
}

RenderOptions preview_options(const RenderOptions& options) {
    RenderOptions draft = options;
    if (options.tolerance && (options.tolerance->coupled || options.tolerance->reference))
        refuse_preview(options, options.as_said("--tolerance"), "light is rough; choose fixed=P%, or a whole film");
    if (options.audit > 0) refuse_preview(options, "--audit", "no tolerance is kept that could be audited");
    if (options.layers) refuse_preview(options, "--aov", "there are no layers");
    if (options.cache == "on")
        refuse_preview(options, "--cache on", "light is carried by pixels, not kept on surfaces");
    for (const auto& [subject, file, view] : options.side_films)
        if (subject != "quantiser" && !view)
            refuse_preview(options, "--heatmap " + subject, "only `quantiser` is known");

    // fit: docs/measurements.md#drafts, by PSNR for CPU time.
    if (!options.tolerance) draft.tolerance = fixed_tolerance(0.3f);
    if (!options.is_given("--samples")) draft.samples = 1;
    if (!options.is_given("--edge-samples")) draft.edge_samples = options.is_given("--samples") ? options.samples : 4;
    if (!options.is_given("--vpls")) draft.vpls = 16384;
    draft.indirect = "lightcuts";
    draft.cache = "off";

    // A draft only must be there soon.
    if (!options.is_given("--encoder")) draft.coding.encoder = "fast";
    if (!options.coding.b_pictures) draft.coding.b_pictures = 0;
    const bool has_rate =
        options.coding.quantiser || options.coding.crf || options.coding.quality || options.coding.bitrate;
    const bool master = encoder::facts_of(codec_of(options.coding, options.output)).master;
    if (!has_rate && !master) draft.coding.quantiser = 6;
    if (options.coding.bitrate && !options.coding.passes) draft.coding.passes = 1;
    return draft;
}

namespace {

// chosen: as for --frames, 2^31 frames are 2.7 years at 25 Hz.
constexpr std::int64_t frame_limit = std::int64_t{1} << 31;

constexpr const char* separators = ", \t\r\n";

bool is_list(const std::string& text) {
    return !text.empty() && text.find_first_not_of("0123456789,") == std::string::npos;
}

/// The file's text without comments.
std::string read_file(const std::string& name) {
    if (const std::string why = core::why_no_plain_file(name); !why.empty())
        throw UsageError("keyframes " + name + ": expected frame numbers such as 0,48,96, or a file with them; " + why);
    std::ifstream stream(name);
    std::string text, line;
    while (std::getline(stream, line)) text += line.substr(0, line.find('#')) + "\n";
    if (!stream.eof()) throw UsageError("keyframes " + name + ": cannot be read");
    return text;
}

/// Rates and buffer; a level may allow less than the preset.
void apply_rates(const Preset& preset, const CodingOptions& options, encoder::Settings& coding) {
    const encoder::LevelLimits level = encoder::level_of(coding);
    encoder::RateControl& rate = coding.rate_control;
    const std::int64_t most = std::max(rate.bit_rate, rate.max_rate);
    if (most > std::min(preset.bit_rate, level.bit_rate))
        throw UsageError(fmt::format("{}: {} takes at most {} bits per second",
                                     options.maxrate ? fmt::format("--maxrate {}", *options.maxrate)
                                                     : fmt::format("--bitrate {}", *options.bitrate),
                                     preset.option(), std::min(preset.bit_rate, level.bit_rate)));
    if (rate.max_rate == 0 && rate.mode != encoder::RateMode::constant)
        rate.max_rate = std::max(rate.bit_rate, std::min(preset.usual_rate, level.bit_rate));

    std::int64_t buffer = std::min(preset.buffer_bits, level.buffer_bits);
    const auto fastest = static_cast<double>(rate.max_rate > 0 ? rate.max_rate : rate.bit_rate);
    if (preset.longest_delay > 0) {
        const auto held = static_cast<std::int64_t>(std::llround(preset.longest_delay * fastest));
        buffer = std::min(buffer, held);
    }
    if (rate.buffer_bits > buffer)
        throw UsageError(
            fmt::format("--vbv {}: {} takes at most {} bits at these rates", *options.vbv, preset.option(), buffer));
    if (rate.buffer_bits == 0) rate.buffer_bits = buffer;
}

/// Checks settings against the preset and fills the gaps.
void apply(const Preset& preset, const CodingOptions& options, encoder::Settings& coding) {
    if (preset.fields) coding.cadence = coding.rate.code == 1 ? encoder::Cadence::pulldown : encoder::Cadence::fields;
    if (!options.gop) coding.gop = preset.usual_gop(coding.rate);
    coding.closed_gops = preset.disc;
    const int longest = preset.longest_gop(coding.rate);
    if (longest > 0 && coding.gop > longest)
        throw UsageError(fmt::format("--gop {}: {} has at most {} pictures in a GOP at {} Hz", coding.gop,
                                     preset.option(), longest, coding.rate.name));
    if (!options.b_pictures) coding.b_pictures = std::min(coding.b_pictures, preset.b_pictures);
    if (coding.b_pictures > preset.b_pictures)
        throw UsageError(fmt::format("--b-pictures {}: {} has at most {} in a row", coding.b_pictures, preset.option(),
                                     preset.b_pictures));
    apply_rates(preset, options, coding);
}

void refuse_conflicts(const CodingOptions& o) {
    const std::pair<const char*, bool> given[] = {{"--crf", o.crf.has_value()},
                                                  {"--quantiser", o.quantiser.has_value()},
                                                  {"--quality", o.quality.has_value()},
                                                  {"--bitrate", o.bitrate.has_value()}};
    const char* first = nullptr;
    for (const auto& [name, is_given] : given) {
        if (is_given && first != nullptr)
            throw UsageError(fmt::format("{} and {}: each decides the quantisers; give one", first, name));
        if (is_given) first = name;
    }
    if (o.constant_rate && !o.bitrate) throw UsageError("--cbr: which rate? Give --bitrate too, e.g. --bitrate 6M");
    if (o.passes && !o.bitrate)
        throw UsageError(
            "--passes: without --bitrate there is nothing to find out first; give --bitrate too, or leave --passes "
            "out");
}

encoder::RateControl rate_control(const CodingOptions& options) {
    refuse_conflicts(options);
    encoder::RateControl rate;
    if (options.quality) {
        rate.mode = encoder::RateMode::constant_quality;
        rate.quality = *options.quality;
    }
    if (options.bitrate) {
        rate.mode = options.constant_rate ? encoder::RateMode::constant : encoder::RateMode::variable;
        rate.bit_rate = *options.bitrate;
    }
    if (options.maxrate) rate.max_rate = *options.maxrate;
    if (options.vbv) rate.buffer_bits = *options.vbv;
    return rate;
}

/// Masters have rates of their own.
void refuse_rates(const CodingOptions& o, const encoder::CodecFacts& facts) {
    const std::pair<const char*, bool> given[] = {{"--crf", o.crf.has_value()},
                                                  {"--quantiser", o.quantiser.has_value()},
                                                  {"--quality", o.quality.has_value()},
                                                  {"--bitrate", o.bitrate.has_value()},
                                                  {"--level", o.level.has_value()}};
    for (const auto& [name, is_given] : given)
        if (is_given) throw UsageError(fmt::format("{}: {} has its own rate; leave it out", name, facts.name));
}

int quantiser_of(const CodingOptions& options, encoder::Codec codec, const core::View& view) {
    const encoder::CodecFacts facts = encoder::facts_of(codec);
    if (facts.master) refuse_rates(options, facts);
    if (options.crf) {
        const std::string asked = fmt::format("--crf {}", *options.crf);
        if (codec == encoder::Codec::mpeg2)
            throw UsageError(asked + ": MPEG-2's scale is that of --quantiser; say that, or choose --codec h264");
        if (*options.crf < facts.finest || *options.crf > facts.coarsest)
            throw UsageError(fmt::format("{}: {} has {} to {}", asked, facts.name, facts.finest, facts.coarsest));
        return *options.crf;
    }
    const double quantiser = options.quantiser ? *options.quantiser : 4 / view.coarseness();
    return static_cast<int>(std::lround(encoder::quantiser_like(codec, quantiser)));
}

/// Declares how a view's signals are to be shown.
void declare_colors(encoder::Settings& coding, const core::View& view) {
    coding.transfer_characteristics = encoder::transfer_number(coding.codec);
    if (!view.is_hdr()) return;
    const encoder::CodecFacts& facts = encoder::facts_of(coding.codec);
    if (!facts.has_more_than_8_bits() || coding.codec == encoder::Codec::dnxhr)
        throw UsageError(
            fmt::format("view {}: {} films are not of high dynamic range; choose --codec hevc, av1, "
                        "prores or ffv1",
                        core::text_of(view), facts.name));
    // [BT2100, table 2] in the numbers of ISO/IEC 23091-2
    coding.color_primaries = 9;
    coding.matrix_coefficients = static_cast<int>(perceptual::ColorMatrix::bt2020);
    coding.transfer_characteristics = view.name == core::ViewName::pq ? 16 : 18;
    coding.peak = view.name == core::ViewName::pq ? view.peak : 0;
}

}  // namespace

bool two_passes(const CodingOptions& options) {
    return options.bitrate.has_value() && options.passes.value_or(2) == 2;
}

void check_settings(const encoder::Settings& coding) {
    if (coding.codec != encoder::Codec::mpeg2) av::open_libraries();
    refuse_as_usage([&] { av::check(coding); });
}

std::vector<Chunk> chunks_of(FrameRange frames, int gop) {
    EXPECTS(frames.first <= frames.last && gop >= 1);
    // chosen: about 60 frames, two seconds: short enough to lose little, long enough that starting anew costs little
    // (30..240).
    constexpr std::int64_t aim = 60;
    const std::int64_t length = std::max<std::int64_t>(1, (aim + gop / 2) / gop) * gop;

    std::vector<Chunk> chunks;
    for (std::int64_t first = frames.first; first <= frames.last; first += length)
        chunks.push_back({static_cast<int>(chunks.size()), first, std::min(first + length - 1, frames.last)});
    return chunks;
}

bool Keyframes::begins_at(std::int64_t frame) const {
    return std::ranges::binary_search(frames, frame);
}

std::int64_t Keyframes::frames_left(std::int64_t frame, std::int64_t left) const {
    const auto next = std::ranges::upper_bound(frames, frame);
    return next == frames.end() ? left : std::min(left, *next - frame - 1);
}

Keyframes keyframes_from(const std::string& text) {
    const std::string list = is_list(text) ? text : read_file(text);
    Keyframes keyframes;
    for (std::size_t at = list.find_first_not_of(separators); at != std::string::npos;) {
        const std::size_t end = std::min(list.find_first_of(separators, at), list.size());
        std::int64_t frame = 0;
        const auto [last, error] = std::from_chars(list.data() + at, list.data() + end, frame);
        if (error != std::errc{} || last != list.data() + end || frame < 0 || frame >= frame_limit)
            throw UsageError("keyframes " + text + ": \"" + list.substr(at, end - at) + "\" is no frame number");
        keyframes.frames.push_back(frame);
        at = list.find_first_not_of(separators, end);
    }
    if (keyframes.frames.empty()) throw UsageError("keyframes " + text + ": no frame numbers");
    std::ranges::sort(keyframes.frames);
    keyframes.frames.erase(std::unique(keyframes.frames.begin(), keyframes.frames.end()), keyframes.frames.end());
    return keyframes;
}

Keyframes keyframes_of(const CodingOptions& options) {
    return options.keyframes ? keyframes_from(*options.keyframes) : Keyframes{};
}

encoder::Codec codec_of(const CodingOptions& options, const std::filesystem::path& output) {
    const std::string ending = core::ending_of(output);
    if (options.preset != nullptr) {
        if (options.codec.value_or(encoder::Codec::mpeg2) != encoder::Codec::mpeg2)
            throw UsageError(fmt::format("--codec {}: {} is MPEG-2's world", encoder::facts_of(*options.codec).word,
                                         options.preset->option()));
        return encoder::Codec::mpeg2;
    }
    if (options.codec) return *options.codec;
    if (ending == ".mp4" || ending == ".mov" || ending == ".mkv") return encoder::Codec::h264;
    if (ending == ".webm") return encoder::Codec::vp9;
    return ending == ".gif" ? encoder::Codec::gif : encoder::Codec::mpeg2;
}

std::vector<int> in_scale_of(encoder::Codec codec, std::vector<int> quantisers) {
    for (int& q : quantisers) q = static_cast<int>(std::lround(encoder::quantiser_like(codec, q)));
    return quantisers;
}

core::View view_of(const FilmOptions& options, const core::View& own) {
    core::View view = options.view ? core::View{*options.view} : own;
    view.peak = static_cast<float>(options.peak.value_or(static_cast<int>(view.peak)));
    return view;
}

void check_peak(const FilmOptions& options, const core::View& view) {
    if (options.peak && view.name != core::ViewName::pq) throw UsageError("--peak: goes with --view pq");
}

ViewAndCodec view_and_codec_from(const std::string& word) {
    const std::size_t colon = word.find(':');
    ViewAndCodec result;
    try {
        result.view.name = core::view_from(word.substr(0, colon));
    } catch (const core::Error& error) {
        throw UsageError("--also: " + std::string(error.what()));
    }
    if (colon == std::string::npos) return result;
    try {
        result.codec = codec_from(word.substr(colon + 1));
    } catch (const core::Error& error) {
        throw UsageError("--also " + word + ": " + error.what());
    }
    return result;
}

encoder::Codec ViewAndCodec::codec_in(const std::filesystem::path& output) const {
    if (codec) return *codec;
    const encoder::Codec usual = codec_of({}, output);
    const bool can = output.empty() || encoder::facts_of(encoder::Codec::hevc).has_ending(core::ending_of(output));
    return view.is_hdr() && can && !encoder::facts_of(usual).has_more_than_8_bits() ? encoder::Codec::hevc : usual;
}

namespace {

encoder::Labels labels_of(const CodingOptions& options, const encoder::Settings& coding,
                          const std::filesystem::path& output) {
    encoder::Labels labels;
    labels.title = options.title.value_or("");
    if (core::printable(labels.title) != labels.title)
        throw UsageError("--title: expected a line of UTF-8 without control codes");
    if (!labels.title.empty() && !av::can_have_title(output))
        throw UsageError("--title: " + output.string() + " has none; .mp4, .mov, .mkv, .webm and .ts have");
    // A transport stream's service name has 255 bytes at most, one of which tells its alphabet.
    if (core::ending_of(output) == ".ts" && labels.title.size() > 254)
        throw UsageError("--title: " + output.string() + " has one of at most 254 bytes");
    if (!options.timecode) return labels;
    if (!av::can_have_timecode(output, coding.codec))
        throw UsageError("--timecode: " + output.string() + " has none; .mp4, .mov, .mkv, .webm and MPEG-2 have");
    const core::FrameRate rate = encoder::declared_rate(coding);
    const auto per_second = static_cast<int>(std::lround(rate.hertz.value()));
    const bool is_fast = rate.hertz.num == 60000 && coding.codec != encoder::Codec::mpeg2;  // [H262, 6.3.8]
    const bool can_drop = rate.hertz.den == 1001 && (rate.hertz.num == 30000 || is_fast);
    labels.start = encoder::timecode_from(*options.timecode, per_second, can_drop);
    if (!labels.start)
        throw UsageError(
            fmt::format("--timecode {}: expected HH:MM:SS:FF before 24:00:00:00, with FF below {}, the "
                        "pictures per second{}",
                        *options.timecode, per_second,
                        can_drop ? "; with `;` before FF, no number that drop-frame leaves out"
                                 : "; `;` before FF is for 29.97 and, but in MPEG-2, 59.94"));
    return labels;
}

}  // namespace

encoder::Settings coding_settings(const CodingOptions& options, const Shape& shape, std::int64_t first,
                                  const std::filesystem::path& output, const core::View& view) {
    encoder::Settings coding;
    coding.codec = codec_of(options, output);
    if (!options.codec && options.preset == nullptr) coding.codec = ViewAndCodec{view, {}}.codec_in(output);
    coding.width = shape.size.width;
    coding.height = shape.size.height;
    coding.rate = shape.rate;
    coding.first_number = first;
    if (av::is_film(output)) refuse_as_usage([&] { av::check_container(output, coding.codec); });
    coding.quantiser = quantiser_of(options, coding.codec, view);
    coding.rate_control = rate_control(options);
    if (coding.codec != encoder::Codec::mpeg2 && options.bitrate && !two_passes(options))
        throw UsageError(
            fmt::format("--passes 1: a rate of {} needs two passes", encoder::facts_of(coding.codec).name));
    coding.gop = options.gop.value_or(usual_gop);
    coding.b_pictures =
        std::min(options.b_pictures.value_or(coding.b_pictures), encoder::facts_of(coding.codec).most_b_pictures);
    coding.tune = tune_of(options, coding.codec);
    coding.effort = options.encoder == "fast" ? encoder::Effort::fast : encoder::Effort::quality;
    if (options.level) {
        coding.level = *options.level;
        if (!av::has_levels(coding.codec))
            throw UsageError(fmt::format("--level {:.1f}: {}'s follows from size and rate; choose --codec h264",
                                         0.1 * *options.level, encoder::facts_of(coding.codec).name));
    }
    coding.pixel_aspect = shape.pixel_aspect;
    coding.aspect_ratio_code = shape.aspect_ratio_code;
    coding.matrix_coefficients = static_cast<int>(perceptual::matrix_for(shape.size.height));
    if (output.empty() || av::is_film(output)) declare_colors(coding, view);
    if (options.preset != nullptr) apply(*options.preset, options, coding);
    if (av::is_film(output)) coding.labels = labels_of(options, coding, output);
    return coding;
}

}  // namespace render2mpeg::app
