#include "app/options/option_text.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <utility>

#include "app/options/usage_error.h"
#include "core/fog.h"

namespace render2mpeg::app {
namespace {

/// A whole non-negative number that fills `text`; nothing otherwise.
std::optional<std::int64_t> whole_number(std::string_view text) {
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || error != std::errc{} || end != text.data() + text.size() || value < 0) return {};
    return value;
}

/// The words between commas.
std::vector<std::string> parts_of(const std::string& text) {
    std::vector<std::string> parts{""};
    for (const char c : text) {
        if (c == ',')
            parts.emplace_back();
        else
            parts.back() += c;
    }
    return parts;
}

/// Seconds of minutes:seconds or hours:minutes:seconds, above 0 and below 100 hours.
std::optional<double> clock_time(const std::string& text) {
    std::int64_t seconds = 0;
    int parts = 0;
    for (std::size_t at = 0; at <= text.size(); ++parts) {
        const std::size_t colon = std::min(text.find(':', at), text.size());
        const auto value = whole_number(std::string_view(text).substr(at, colon - at));
        if (!value || *value > 99 || (parts > 0 && *value > 59) || parts > 2) return {};
        seconds = 60 * seconds + *value;
        at = colon + 1;
    }
    return parts < 2 || seconds == 0 ? std::nullopt : std::optional(static_cast<double>(seconds));
}

template <class Value, class Order>
std::vector<Value> in_order(std::vector<Value> values, Order order) {
    std::sort(values.begin(), values.end(), order);
    values.erase(std::unique(values.begin(), values.end()), values.end());
    return values;
}

}  // namespace

Size size_from(const std::string& text) {
    const std::size_t x = text.find_first_of("xX");
    const auto width = x == std::string::npos ? std::nullopt : whole_number(std::string_view(text).substr(0, x));
    const auto height = x == std::string::npos ? std::nullopt : whole_number(std::string_view(text).substr(x + 1));
    if (!width || !height || *width < 1 || *height < 1 || *width > 16383 || *height > 16383)
        throw UsageError("size " + text + ": expected WIDTHxHEIGHT in pixels, e.g. 720x576");
    return {static_cast<int>(*width), static_cast<int>(*height)};
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

ToleranceRequest tolerance_from(const std::string& text) {
    if (text == "reference") return {true, 0, false, {}, {}};
    if (text == "coupled") return {false, 0, true, {}, {}};
    if (text == "truth") return {true, 0, false, {}, 0.01f};
    if (text.starts_with("truth=")) {
        char* end = nullptr;
        const double percent = std::strtod(text.c_str() + 6, &end);
        // chosen: a tenth of the default takes a hundred times as many paths, which nobody waits for.
        if (std::string_view(end) == "%" && percent >= 0.1 && percent <= 100)
            return {true, 0, false, {}, static_cast<float>(percent / 100)};
    }
    if (text.starts_with("coupled=")) {
        const char* number = text.c_str() + 8;
        char* end = nullptr;
        const double share = std::strtod(number, &end);
        // chosen: more than 100 times what is hidden is a slip of the pen.
        if (end != number && *end == '\0' && static_cast<float>(share) > 0 && share <= 100)
            return {false, 0, true, static_cast<float>(share), {}};
    }
    if (text.starts_with("fixed=") || text.ends_with('%')) {
        const char* number = text.c_str() + (text.starts_with("fixed=") ? 6 : 0);
        char* end = nullptr;
        const double percent = std::strtod(number, &end);
        // Without its sign, 1 could mean all of the light.
        if (end != number && std::string_view(end) == "%" && percent >= 0 && percent <= 100)
            return {false, static_cast<float>(percent / 100), false, {}, {}};
    }
    throw UsageError(
        "tolerance " + text +
        ": expected `coupled`, coupled=K with K above 0 and up to 100, fixed=P% with P from 0 to 100, e.g. "
        "fixed=2%, or 2% for short, `reference`, `truth`, or truth=P% with P from 0.1 to 100");
}

ShutterRequest shutter_from(const std::string& text) {
    double numbers[3] = {0, 0, 0};
    std::size_t begin = 0;
    for (int k = 0; k < 3; ++k) {
        const std::size_t end = std::min(text.find(':', begin), text.size());
        const std::string part = text.substr(begin, end - begin);
        char* rest = nullptr;
        numbers[k] = std::strtod(part.c_str(), &rest);
        if (part.empty() || *rest != '\0') numbers[k] = std::nan("");
        if (end == text.size()) break;
        begin = end + 1;
        if (k == 2) numbers[2] = std::nan("");
    }
    if (!(numbers[0] >= 0 && numbers[0] <= 360))
        throw UsageError("shutter " + text + ": expected degrees from 0 (closed) to 360, e.g. 180");
    if (!(numbers[1] >= -0.5 && numbers[1] <= 0.5))
        throw UsageError("shutter " + text + ": expected a phase from -0.5 to 0.5 frames, e.g. 180:0.25");
    if (!(numbers[2] >= 0 && numbers[2] <= 1))
        throw UsageError("shutter " + text + ": expected to roll by 0 to 1 frames, e.g. 180:0:0.5");
    return {static_cast<float>(numbers[0]), static_cast<float>(numbers[1]), static_cast<float>(numbers[2])};
}

float fog_from(const std::string& text) {
    if (text == "off") return 0;
    char* end = nullptr;
    const float visibility = std::strtof(text.c_str(), &end);
    if (text.empty() || *end != '\0' || !(visibility >= core::least_visibility && visibility <= core::most_visibility))
        throw UsageError("fog " + text + ": expected off, or how far one sees in it, scene units above 0, e.g. 40");
    return visibility;
}

GlareRequest glare_from(const std::string& text) {
    const auto colon = text.find(':');
    const auto name = std::find(core::glare_names.begin(), core::glare_names.end(), text.substr(0, colon));
    if (name == core::glare_names.end())
        throw UsageError("glare " + text + ": expected off, static or temporal, and a strength, e.g. static:0.2");
    GlareRequest glare{static_cast<core::GlareKind>(name - core::glare_names.begin()), {}};
    if (colon == std::string::npos) return glare;
    const std::string part = text.substr(colon + 1);
    char* end = nullptr;
    glare.strength = std::strtof(part.c_str(), &end);
    if (part.empty() || *end != '\0' || !(*glare.strength >= 0 && *glare.strength <= core::most_glare))
        throw UsageError("glare " + text + ": expected a strength from 0 to 0.5, the share of light that is scattered");
    return glare;
}

float f_stop_from(const std::string& text) {
    if (text == "off") return 0;
    char* end = nullptr;
    const double number = std::strtod(text.c_str(), &end);
    if (text.empty() || *end != '\0' || !(number >= 0.01 && number <= 1000))
        throw UsageError("f-stop " + text + ": expected a number from 0.01 to 1000, e.g. 2.8, or `off`");
    return static_cast<float>(number);
}

Sample sample_from(const std::string& text) {
    const std::size_t x = text.find('x');
    const auto windows = x == std::string::npos ? std::nullopt : whole_number(std::string_view(text).substr(0, x));
    const auto frames = x == std::string::npos ? std::nullopt : whole_number(std::string_view(text).substr(x + 1));
    // chosen: more than a thousand windows or frames of each is a film, not a sample of one.
    if (!windows || !frames || *windows < 1 || *frames < 1 || *windows > 1000 || *frames > 1000)
        throw UsageError("sample " + text + ": expected WINDOWSxFRAMES from 1x1 to 1000x1000, e.g. 2x3");
    return {static_cast<int>(*windows), static_cast<int>(*frames)};
}

std::vector<float> percents_from(const std::string& text) {
    std::vector<float> shares;
    for (const std::string& part : parts_of(text)) {
        char* end = nullptr;
        const double percent = std::strtod(part.c_str(), &end);
        // chosen: less than a hundred thousandth of a pixel's light is not to be told from none in floats (1e-4..1e-2).
        if (part.empty() || *end != '\0' || !(percent >= 0.001) || percent > 100)
            throw UsageError("tolerances " + text + ": expected per cent from 0.001 to 100, e.g. 8,4,2,1");
        shares.push_back(static_cast<float>(percent / 100));
    }
    return in_order(std::move(shares), std::greater<>());
}

std::vector<int> quantisers_from(const std::string& text) {
    if (text == "none") return {};
    std::vector<int> quantisers;
    for (const std::string& part : parts_of(text)) {
        const auto value = whole_number(part);
        if (!value || *value < 1 || *value > 31)
            throw UsageError("quantisers " + text + ": expected numbers from 1 to 31, e.g. 2,8,31, or `none`");
        quantisers.push_back(static_cast<int>(*value));
    }
    return in_order(std::move(quantisers), std::less<>());
}

double size_in_bytes(const std::string& text) {
    char* end = nullptr;
    double value = std::strtod(text.c_str(), &end);
    const bool number = end != text.c_str() && std::isdigit(static_cast<unsigned char>(text[0])) != 0;
    std::string unit(end);
    if (unit.ends_with('B')) unit.pop_back();
    if (unit == "k" || unit == "K")
        value *= 1e3;
    else if (unit == "M")
        value *= 1e6;
    else if (unit == "G")
        value *= 1e9;
    else if (!unit.empty())
        value = -1;
    // chosen: no file system holds more than an exabyte in one file.
    if (!number || !(value >= 1) || value > 1e18)
        throw UsageError(text + ": expected bytes as a number, or with k, M or G, e.g. 700M or 4.7G");
    return value;
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

}  // namespace render2mpeg::app
