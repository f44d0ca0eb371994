#include "app/options/option_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <utility>

#include "app/options/usage_error.h"
#include "core/film_grain.h"
#include "core/fog.h"
#include "encoder/codec.h"

namespace render2mpeg::app {
namespace {

/// A whole non-negative number that fills `text`; nothing otherwise.
std::optional<std::int64_t> whole_number(std::string_view text) {
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || error != std::errc{} || end != text.data() + text.size() || value < 0) return {};
    return value;
}

/// A number from `low` to `high` that fills `text`; nothing otherwise.
std::optional<double> number_in(const std::string& text, double low, double high) {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    const bool fills = !text.empty() && *end == '\0';
    return fills && value >= low && value <= high ? std::optional(value) : std::nullopt;
}

/// A number of at least 1, and one of `units` behind it, of "kKMG"; nothing otherwise.
std::optional<double> number_with_unit(const std::string& text, std::string_view units) {
    char* end = nullptr;
    double value = std::strtod(text.c_str(), &end);
    if (text.empty() || std::isdigit(static_cast<unsigned char>(text[0])) == 0) return {};
    const std::size_t unit = *end == '\0' ? std::string_view::npos : units.find(*end);
    if (*end != '\0' && (unit == std::string_view::npos || end[1] != '\0')) return {};
    constexpr double powers[] = {1e3, 1e3, 1e6, 1e9};
    if (unit != std::string_view::npos) value *= powers[unit];
    return value >= 1 ? std::optional(value) : std::nullopt;
}

/// A share of 1 from a number of per cent with its sign.
std::optional<float> share_in(const std::string& text, double low, double high) {
    if (!text.ends_with('%')) return {};
    const auto percent = number_in(text.substr(0, text.size() - 1), low, high);
    return percent ? std::optional(static_cast<float>(*percent / 100)) : std::nullopt;
}

/// The words between separators.
std::vector<std::string> parts_of(const std::string& text, char separator) {
    std::vector<std::string> parts{""};
    for (const char c : text) {
        if (c == separator)
            parts.emplace_back();
        else
            parts.back() += c;
    }
    return parts;
}

/// Two whole numbers from 1 to `most`, parted by one of `between`; nothing otherwise.
std::optional<std::pair<int, int>> pair_in(std::string_view text, const char* between, int most) {
    const std::size_t at = text.find_first_of(between);
    if (at == std::string_view::npos) return {};
    const auto a = whole_number(text.substr(0, at)), b = whole_number(text.substr(at + 1));
    if (!a || !b || *a < 1 || *b < 1 || *a > most || *b > most) return {};
    return std::pair(static_cast<int>(*a), static_cast<int>(*b));
}

/// Seconds of minutes:seconds or hours:minutes:seconds, above 0 and below 100 hours.
std::optional<double> clock_time(const std::string& text) {
    const std::vector<std::string> parts = parts_of(text, ':');
    std::int64_t seconds = 0;
    for (const std::string& part : parts) {
        const auto value = whole_number(part);
        if (!value || *value > (&part == &parts.front() ? 99 : 59)) return {};
        seconds = 60 * seconds + *value;
    }
    if (parts.size() < 2 || parts.size() > 3 || seconds == 0) return {};
    return static_cast<double>(seconds);
}

template <class Value, class Order>
std::vector<Value> in_order(std::vector<Value> values, Order order) {
    std::ranges::sort(values, order);
    values.erase(std::unique(values.begin(), values.end()), values.end());
    return values;
}

}  // namespace

Size size_from(const std::string& text) {
    const auto sides = pair_in(text, "xX", 16383);
    if (!sides)
        throw UsageError("size " + text + ": expected WIDTHxHEIGHT in pixels, each from 1 to 16383, e.g. 720x576");
    return {sides->first, sides->second};
}

FrameRange frames_from(const std::string& text) {
    const std::size_t colon = text.find(':');
    const auto first = whole_number(std::string_view(text).substr(0, colon));
    const auto last = colon == std::string::npos ? first : whole_number(std::string_view(text).substr(colon + 1));
    // chosen: 2^31 frames are 2.7 years at 25 Hz; the limit keeps frame numbers exact in every later product.
    constexpr std::int64_t limit = std::int64_t{1} << 31;
    if (!first || !last || *last < *first || *last >= limit)
        throw UsageError("frames " + text + ": expected FIRST:LAST with FIRST <= LAST, counted from 0, e.g. 0:47");
    return {*first, *last};
}

int level_from(const std::string& text) {
    const bool is_level =
        text.size() == 3 && text[1] == '.' && text[0] >= '1' && text[0] <= '9' && text[2] >= '0' && text[2] <= '9';
    if (!is_level) throw UsageError("level " + text + ": expected one such as 4.1");
    return 10 * (text[0] - '0') + (text[2] - '0');
}

Price price_from(const std::string& text) {
    const std::size_t slash = text.find('/');
    const std::string unit = slash == std::string::npos ? "" : text.substr(slash + 1);
    const std::optional<double> amount = number_in(text.substr(0, slash), 0, 1e9);
    if (!amount || (unit != "core-hour" && unit != "machine-hour"))
        throw UsageError("price " + text + ": expected an amount and what it is for, as 0.04/core-hour or " +
                         "0.60/machine-hour");
    return {*amount, unit == "core-hour"};
}

std::vector<std::string> command_from(const std::string& text) {
    std::vector<std::string> words;
    bool within = false;  // a word
    char quote = '\0';
    for (const char c : text) {
        const bool blank = quote == '\0' && (c == ' ' || c == '\t' || c == '\n');
        if (!blank && !std::exchange(within, true)) words.emplace_back();
        if (blank)
            within = false;
        else if (c == quote)
            quote = '\0';
        else if (quote == '\0' && (c == '\'' || c == '"'))
            quote = c;
        else
            words.back() += c;
    }
    if (quote != '\0') throw UsageError(text + ": a quotation that begins with " + quote + " does not end");
    if (words.empty() || words[0].empty()) throw UsageError("there is no command in '" + text + "'");
    return words;
}

ToleranceRequest tolerance_from(const std::string& text) {
    const std::size_t equals = text.find('=');
    const std::string kind = text.substr(0, equals), value = equals == std::string::npos ? "" : text.substr(equals + 1);
    if (text == "reference") return {true, 0, false, {}, {}};
    if (text == "coupled") return coupled_tolerance();
    if (text == "truth") return {true, 0, false, {}, 0.01f};
    // chosen: a tenth of the default takes a hundred times as many paths, which nobody waits for.
    if (kind == "truth")
        if (const auto share = share_in(value, 0.1, 100)) return {true, 0, false, {}, share};
    // chosen: more than 100 times what is hidden is a slip of the pen.
    if (kind == "coupled")
        if (const auto share = number_in(value, 0, 100); share && static_cast<float>(*share) > 0)
            return {false, 0, true, static_cast<float>(*share), {}};
    // Without its sign, 1 could mean all of the light.
    if (const auto share = share_in(kind == "fixed" ? value : text, 0, 100)) return {false, *share, false, {}, {}};
    throw UsageError(
        "tolerance " + text +
        ": expected `coupled`, coupled=K with K above 0 and up to 100, fixed=P% with P from 0 to 100, e.g. "
        "fixed=2%, or 2% for short, `reference`, `truth`, or truth=P% with P from 0.1 to 100");
}

ShutterRequest shutter_from(const std::string& text) {
    const std::vector<std::string> parts = parts_of(text, ':');
    const auto number = [&](std::size_t k, double low, double high, const char* expected) {
        const auto value = k < parts.size() ? number_in(parts[k], low, high) : std::optional(0.0);
        if (!value || (k == 2 && parts.size() > 3)) throw UsageError("shutter " + text + ": expected " + expected);
        return static_cast<float>(*value);
    };
    return {number(0, 0, 360, "degrees from 0 (closed) to 360, e.g. 180"),
            number(1, -0.5, 0.5, "a phase from -0.5 to 0.5 frames, e.g. 180:0.25"),
            number(2, 0, 1, "to roll by 0 to 1 frames, e.g. 180:0:0.5")};
}

float fog_from(const std::string& text) {
    if (text == "off") return 0;
    const auto visibility = number_in(text, core::least_visibility, core::most_visibility);
    if (!visibility)
        throw UsageError("fog " + text + ": expected off, or how far one sees in it, scene units above 0, e.g. 40");
    return static_cast<float>(*visibility);
}

int grain_from(const std::string& text) {
    const auto iso = number_in(text, 0, core::most_iso);
    if (!iso || *iso != std::floor(*iso) || (*iso > 0 && *iso < core::least_iso))
        throw UsageError(fmt::format("grain {}: expected 0, or the ISO of a film from {} to {}, e.g. 400", text,
                                     core::least_iso, core::most_iso));
    return static_cast<int>(*iso);
}

GlareRequest glare_from(const std::string& text) {
    const auto colon = text.find(':');
    const auto name = std::ranges::find(core::glare_names, text.substr(0, colon));
    if (name == core::glare_names.end())
        throw UsageError("glare " + text + ": expected off, static or temporal, and a strength, e.g. static:0.2");
    GlareRequest glare{static_cast<core::GlareKind>(name - core::glare_names.begin()), {}};
    if (colon == std::string::npos) return glare;
    const auto strength = number_in(text.substr(colon + 1), 0, core::most_glare);
    if (!strength)
        throw UsageError("glare " + text + ": expected a strength from 0 to 0.5, the share of light that is scattered");
    glare.strength = static_cast<float>(*strength);
    return glare;
}

float f_stop_from(const std::string& text) {
    if (text == "off") return 0;
    const auto number = number_in(text, 0.01, 1000);
    if (!number) throw UsageError("f-stop " + text + ": expected a number from 0.01 to 1000, e.g. 2.8, or `off`");
    return static_cast<float>(*number);
}

std::optional<float> exposure_from(const std::string& text) {
    if (text == "auto") return {};
    const auto ev = number_in(text, -64, 64);
    if (!ev) throw UsageError("exposure " + text + ": expected `auto` or a number of EV from -64 to 64, e.g. -1.5");
    return static_cast<float>(*ev);
}

SampleExtent sample_from(const std::string& text) {
    // chosen: more than a thousand windows or frames of each is a film, not a sample of one.
    const auto sample = pair_in(text, "x", 1000);
    if (!sample) throw UsageError("sample " + text + ": expected WINDOWSxFRAMES from 1x1 to 1000x1000, e.g. 2x3");
    return {sample->first, sample->second};
}

std::vector<float> percents_from(const std::string& text) {
    std::vector<float> shares;
    for (const std::string& part : parts_of(text, ',')) {
        // chosen: less than a hundred thousandth of a pixel's light is not to be told from none in floats (1e-4..1e-2).
        const auto percent = number_in(part, 0.001, 100);
        if (!percent) throw UsageError("tolerances " + text + ": expected per cent from 0.001 to 100, e.g. 8,4,2,1");
        shares.push_back(static_cast<float>(*percent / 100));
    }
    return in_order(std::move(shares), std::greater<>());
}

std::vector<int> quantisers_from(const std::string& text) {
    if (text == "none") return {};
    std::vector<int> quantisers;
    for (const std::string& part : parts_of(text, ',')) {
        const auto value = whole_number(part);
        if (!value || *value < 1 || *value > 31)
            throw UsageError("quantisers " + text + ": expected numbers from 1 to 31, e.g. 2,8,31, or `none`");
        quantisers.push_back(static_cast<int>(*value));
    }
    return in_order(std::move(quantisers), std::less<>());
}

std::int64_t bits_from(const std::string& text, const std::string& what) {
    const std::optional<double> value = number_with_unit(text, "kKM");
    // chosen: no level has more than 80 Mb/s; the limit keeps the number whole.
    if (!value || *value > 1e12)
        throw UsageError(what + " " + text + ": expected bits as a number, or with k or M, e.g. 6000k or 1.5M");
    // No film has so few, and `-b 6` is what other programs call 6M. No level has more than 80M.
    if (*value < 400)
        throw UsageError(what + " " + text + ": a film has at least 400 bits" +
                         (std::isdigit(static_cast<unsigned char>(text.back())) == 0
                              ? ""
                              : "; did you mean " + text + (*value <= 80 ? "M?" : "k?")));
    return std::llround(*value);
}

double size_in_bytes(const std::string& text) {
    const std::optional<double> value = number_with_unit(text.substr(0, text.size() - text.ends_with('B')), "kKMG");
    // chosen: no file system holds more than an exabyte in one file.
    if (!value || *value > 1e18)
        throw UsageError(text + ": expected bytes as a number, or with k, M or G, e.g. 700M or 4.7G");
    return *value;
}

double time_in_seconds(const std::string& text) {
    double seconds = 0, last = 1e9;
    if (const std::optional<double> clock = clock_time(text)) return *clock;
    const char* rest = text.c_str();
    bool sound = !text.empty();
    while (*rest != '\0' && sound) {
        char* end = nullptr;
        const double value = std::strtod(rest, &end);
        const double unit = *end == 'h' ? 3600 : *end == 'm' ? 60 : *end == 's' || *end == '\0' ? 1 : 0;
        sound = end != rest && std::isdigit(static_cast<unsigned char>(*rest)) != 0 && unit > 0 && unit < last;
        seconds += value * unit;
        last = unit;
        rest = *end == '\0' ? end : end + 1;
    }
    // chosen: a year is longer than anybody waits.
    if (!sound || !(seconds > 0) || seconds > 3.2e7)
        throw UsageError(text + ": expected hours, minutes and seconds, e.g. 2h, 90m, 1h30m, 1:30 or 45s");
    return seconds;
}

double within_from(const std::string& text) {
    return text == "0" ? 0 : time_in_seconds(text);
}

encoder::Codec codec_from(const std::string& text) {
    const std::string word = text == "h265" ? "hevc" : text;
    const auto known = std::ranges::find(encoder::all_codecs, word, &encoder::CodecFacts::word);
    if (known == encoder::all_codecs.end()) throw UsageError(text + " is no codec");
    return known->codec;
}

std::string words_of_codecs() {
    std::vector<std::string_view> words;
    for (const encoder::CodecFacts& facts : encoder::all_codecs) words.emplace_back(facts.word);
    return fmt::format("{}", fmt::join(words, "|"));
}

}  // namespace render2mpeg::app
