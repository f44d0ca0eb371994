#include "core/rational.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <string_view>

#include "core/error.h"

namespace render2mpeg::core {
namespace {

/// A positive number with at most three decimals, in thousandths; 0 for anything else.
std::int64_t thousandths(std::string_view text) {
    std::int64_t value = 0;
    int decimals = -1;  // digits behind the point, or -1 before it
    std::size_t digits = 0;
    for (const char c : text) {
        if (c == '.' && decimals < 0) {
            decimals = 0;
            continue;
        }
        if (c < '0' || c > '9' || ++digits > 8 || decimals == 3) return 0;
        value = 10 * value + (c - '0');
        if (decimals >= 0) ++decimals;
    }
    for (int i = std::max(decimals, 0); i < 3; ++i) value *= 10;
    return value <= 10'000'000 ? value : 0;
}

Rational lowest_terms(std::int64_t num, std::int64_t den) {
    EXPECTS(den != 0);
    const std::int64_t g = std::gcd(num, den) * (den < 0 ? -1 : 1);
    return {num / g, den / g};
}

/// A positive number that is the whole text; 0 for anything else.
double number(std::string_view text) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc{} && end == text.data() + text.size() && std::isfinite(value) ? std::max(value, 0.0) : 0;
}

/// The fraction itself where both numbers are whole, else the nearest thousandth.
Rational fraction(double num, double den) {
    constexpr double most = 1e6;
    if (num == std::floor(num) && den == std::floor(den) && num <= most && den <= most)
        return lowest_terms(static_cast<std::int64_t>(num), static_cast<std::int64_t>(den));
    return lowest_terms(std::llround(1000 * num / den), 1000);
}

/// chosen: from time lapse to what players show; levels of codecs end at 300.
constexpr double least_hertz = 0.1, most_hertz = 240;

/// The nearest thousandth without zeros at its end: "12", "119.88".
std::string decimals_of(Rational value) {
    const std::int64_t thousands = (1000 * value.num + value.den / 2) / value.den;
    std::string text = std::to_string(thousands / 1000) + "." + std::to_string(1000 + thousands % 1000).substr(1);
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
    return text;
}

}  // namespace

Rational ratio_from(const std::string& text) {
    const std::size_t colon = text.find(':');
    const std::int64_t a = colon == std::string::npos ? 0 : thousandths(std::string_view(text).substr(0, colon));
    const std::int64_t b = colon == std::string::npos ? 0 : thousandths(std::string_view(text).substr(colon + 1));
    if (a == 0 || b == 0) throw Error("ratio " + text + ": expected WIDTH:HEIGHT, e.g. 16:9 or 2.21:1");
    return lowest_terms(a, b);
}

std::string text_of(Rational ratio) {
    if (std::min(ratio.num, ratio.den) < 100) return std::to_string(ratio.num) + ":" + std::to_string(ratio.den);
    return decimals_of(ratio) + ":1";
}

Rational product(Rational a, Rational b) {
    return lowest_terms(a.num * b.num, a.den * b.den);
}

const std::vector<FrameRate>& mpeg2_frame_rates() {
    static const std::vector<FrameRate> rates = {
        {{24000, 1001}, 1, "23.976"}, {{24, 1}, 2, "24"}, {{25, 1}, 3, "25"},          {{30000, 1001}, 4, "29.97"},
        {{30, 1}, 5, "30"},           {{50, 1}, 6, "50"}, {{60000, 1001}, 7, "59.94"}, {{60, 1}, 8, "60"},
    };
    return rates;
}

FrameRate frame_rate_from(const std::string& text) {
    // Read a fraction or a decimal number.
    const std::size_t slash = std::min(text.find('/'), text.size());
    const std::string_view all = text;
    const double num = number(all.substr(0, slash)), den = slash < text.size() ? number(all.substr(slash + 1)) : 1;
    const double hertz = den > 0 ? num / den : 0;
    if (!(hertz >= least_hertz && hertz <= most_hertz))
        throw Error("frame rate " + text +
                    ": expected 0.1 to 240 pictures a second, e.g. 25, 29.97, 12.5 or 30000/1001");

    // Take television's rates within 0.005 Hz: users write 23.98, 29.97 and 119.88 for rates that are no such decimals.
    // chosen: 0.005 tells 23.98 from 24 and 29.97 from 30, whose distances are 0.02 and 0.03.
    for (const FrameRate& rate : mpeg2_frame_rates())
        if (std::abs(rate.hertz.value() - hertz) < 0.005) return rate;
    for (const std::int64_t near : {48, 72, 90, 96, 120, 144, 240})
        if (std::abs(static_cast<double>(near) / 1.001 - hertz) < 0.005)
            return {{near * 1000, 1001}, 0, decimals_of({near * 1000, 1001})};
    const Rational rate = fraction(num, den);
    const bool is_decimal = 1000 % rate.den == 0;
    return {rate, 0, is_decimal ? decimals_of(rate) : std::to_string(rate.num) + "/" + std::to_string(rate.den)};
}

Rational time_of(std::int64_t frame, const FrameRate& rate) {
    const Rational t{frame * rate.hertz.den, rate.hertz.num};
    const std::int64_t g = std::gcd(t.num, t.den);
    return g > 1 ? Rational{t.num / g, t.den / g} : t;
}

}  // namespace render2mpeg::core
