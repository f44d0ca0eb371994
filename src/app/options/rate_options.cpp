#include "app/options/rate_options.h"

#include <cctype>
#include <cmath>
#include <cstdlib>

#include "app/options/coding_options.h"
#include "app/options/usage_error.h"

namespace render2mpeg::app {
namespace {

void refuse_conflicts(const CodingOptions& o) {
    const auto refuse = [](const char* text) { throw UsageError(text); };
    if (o.crf && o.quantiser) refuse("--crf and --quantiser: each decides the quantisers; give one");
    if (o.crf && o.quality) refuse("--crf and --quality: each decides the quantisers; give one");
    if (o.crf && o.bitrate) refuse("--crf and --bitrate: each decides the quantisers; give one");
    if (o.quantiser && o.quality) refuse("--quantiser and --quality: each decides the quantisers; give one");
    if (o.quantiser && o.bitrate) refuse("--quantiser and --bitrate: each decides the quantisers; give one");
    if (o.quality && o.bitrate) refuse("--quality and --bitrate: each decides the quantisers; give one");
    if (o.constant_rate && !o.bitrate) refuse("--cbr: which rate? Give --bitrate too, e.g. --bitrate 6M");
    if (o.passes && !o.bitrate)
        refuse(
            "--passes: without --bitrate there is nothing to find out first; give --bitrate too, or leave --passes "
            "out");
}

}  // namespace

void add_rate_options(CLI::App& command, CodingOptions& options) {
    const std::string coding = "Coding";
    const auto bits = [](const char* what) { return [what](const std::string& text) { bits_from(text, what); }; };
    add_option(command, coding, "--quality", options.quality,
               "Instead: quality from 0 to 100, coarser where motion hides it; 100 is quantiser 1, 20 less "
               "doubles it",
               range(0.0, 100.0));
    add_option(command, coding, "-b,--bitrate", options.bitrate,
               "Instead: bits per second of pictures, on average, e.g. 6M or 900k", "RATE", bits("bitrate"));
    add_flag(command, coding, "--cbr", options.constant_rate,
             "With --bitrate: at every time, by stuffing where need be");
    add_option(command, coding, "--maxrate", options.maxrate,
               "Bits per second that pictures reach a decoder with at most (default: the level's)", "RATE",
               bits("maxrate"));
    add_option(command, coding, "--vbv", options.vbv,
               "Bits that a decoder's buffer holds (default: the most the level allows)", "BITS", bits("vbv"));
    add_option(command, coding, "--passes", options.passes,
               "With --bitrate: 2 looks at the whole film first, cheaply, and spends bits where they are needed; "
               "1 does not (default: 2)",
               range(1, 2));
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
        rate.bit_rate = bits_from(*options.bitrate, "bitrate");
    }
    if (options.maxrate) rate.max_rate = bits_from(*options.maxrate, "maxrate");
    if (options.vbv) rate.buffer_bits = bits_from(*options.vbv, "vbv");
    return rate;
}

std::int64_t bits_from(const std::string& text, const std::string& what) {
    char* end = nullptr;
    double value = std::strtod(text.c_str(), &end);
    const bool number = end != text.c_str() && std::isdigit(static_cast<unsigned char>(text[0])) != 0;
    if (number && (*end == 'k' || *end == 'K'))
        value *= 1e3, ++end;
    else if (number && *end == 'M')
        value *= 1e6, ++end;
    // chosen: no level has more than 80 Mb/s; the limit keeps the number whole.
    if (!number || *end != '\0' || !(value >= 1) || value > 1e12)
        throw UsageError(what + " " + text + ": expected bits as a number, or with k or M, e.g. 6000k or 1.5M");
    return std::llround(value);
}

bool two_passes(const CodingOptions& options) {
    return options.bitrate.has_value() && options.passes.value_or(2) == 2;
}

}  // namespace render2mpeg::app
