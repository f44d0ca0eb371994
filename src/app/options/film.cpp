#include "app/options/film.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/options/rate_options.h"
#include "app/options/usage_error.h"
#include "core/text.h"
#include "encoder/av/av.h"
#include "encoder/av/coders.h"
#include "encoder/capabilities.h"
#include "encoder/codec.h"
#include "perceptual/display.h"

namespace render2mpeg::app {
namespace {

/// Rates and buffer. A level may allow less than the world does: 704x480 at 24 Hz is of Main level.
void apply_rates(const Preset& preset, const CodingOptions& options, encoder::Settings& coding) {
    const encoder::LevelLimits level = encoder::level_of(coding);
    encoder::RateControl& rate = coding.rate_control;
    const std::int64_t most = std::max(rate.bit_rate, rate.max_rate);
    if (most > std::min(preset.bit_rate, level.bit_rate))
        throw UsageError(
            fmt::format("{}: {} takes at most {} bits per second",
                        options.maxrate ? "--maxrate " + *options.maxrate : "--bitrate " + *options.bitrate,
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

/// Refuses what the preset's world does not take, and fills in what nobody said.
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

/// What is refused here was asked for on the command line.
template <class Check>
void refuse_as_usage(const Check& check) {
    try {
        check();
    } catch (const core::Error& error) {
        throw UsageError(error.what());
    }
}

/// The quantiser in the codec's scale.
int quantiser_of(const CodingOptions& options, encoder::Codec codec) {
    const encoder::CodecFacts facts = encoder::facts_of(codec);
    if (options.crf) {
        const std::string asked = fmt::format("--crf {}", *options.crf);
        if (codec == encoder::Codec::mpeg2)
            throw UsageError(asked + ": MPEG-2's scale is that of --quantiser; say that, or choose --codec h264");
        if (*options.crf < facts.finest || *options.crf > facts.coarsest)
            throw UsageError(fmt::format("{}: {} has {} to {}", asked, facts.name, facts.finest, facts.coarsest));
        return *options.crf;
    }
    return static_cast<int>(std::lround(encoder::quantiser_like(codec, options.quantiser.value_or(4))));
}

}  // namespace

void check_settings(const encoder::Settings& coding) {
    refuse_as_usage([&] { av::check(coding); });
}

const Preset* preset_of(const CodingOptions& options) {
    return options.preset ? &preset_from(*options.preset) : nullptr;
}

Keyframes keyframes_of(const CodingOptions& options) {
    return options.keyframes ? keyframes_from(*options.keyframes) : Keyframes{};
}

encoder::Codec codec_of(const CodingOptions& options, const std::filesystem::path& output) {
    const std::string ending = core::ending_of(output);
    encoder::Codec codec = encoder::Codec::mpeg2;
    if (options.codec) {
        for (const encoder::CodecFacts& facts : encoder::all_codecs())
            if (*options.codec == facts.word) codec = facts.codec;
    } else if (!options.preset && (ending == ".mp4" || ending == ".mov" || ending == ".mkv")) {
        codec = encoder::Codec::h264;
    }
    if (options.preset && codec != encoder::Codec::mpeg2)
        throw UsageError("--codec " + *options.codec + ": --for " + *options.preset + " is MPEG-2's world");
    return codec;
}

std::vector<int> in_scale_of(encoder::Codec codec, std::vector<int> quantisers) {
    for (int& q : quantisers) q = static_cast<int>(std::lround(encoder::quantiser_like(codec, q)));
    return quantisers;
}

encoder::Settings coding_settings(const CodingOptions& options, const Shape& shape, std::int64_t first,
                                  const std::filesystem::path& output) {
    encoder::Settings coding;
    coding.codec = codec_of(options, output);
    coding.width = shape.size.width;
    coding.height = shape.size.height;
    coding.rate = shape.rate;
    coding.first_number = first;
    if (av::is_film(output)) refuse_as_usage([&] { av::check_container(output, coding.codec); });
    coding.quantiser = quantiser_of(options, coding.codec);
    coding.rate_control = rate_control(options);
    if (coding.codec != encoder::Codec::mpeg2 && options.bitrate && !two_passes(options))
        throw UsageError(
            fmt::format("--passes 1: a rate of {} needs two passes", encoder::facts_of(coding.codec).name));
    coding.gop = options.gop.value_or(usual_gop);
    coding.b_pictures =
        std::min(options.b_pictures.value_or(coding.b_pictures), encoder::facts_of(coding.codec).most_b_pictures);
    coding.tune = options.tune == "perceptual" ? encoder::Tune::perceptual : encoder::Tune::psnr;
    coding.effort = options.encoder == "fast" ? encoder::Effort::fast : encoder::Effort::quality;
    coding.aspect_ratio_code = shape.aspect_ratio_code;
    coding.matrix_coefficients = static_cast<int>(perceptual::matrix_for(shape.size.height));
    if (const Preset* preset = preset_of(options)) apply(*preset, options, coding);
    return coding;
}

}  // namespace render2mpeg::app
