#include "core/rational.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
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

}  // namespace

Rational ratio_from(const std::string& text) {
    const std::size_t colon = text.find(':');
    const std::int64_t a = colon == std::string::npos ? 0 : thousandths(std::string_view(text).substr(0, colon));
    const std::int64_t b = colon == std::string::npos ? 0 : thousandths(std::string_view(text).substr(colon + 1));
    if (a == 0 || b == 0) throw Error("ratio " + text + ": expected WIDTH:HEIGHT, e.g. 16:9 or 2.21:1");
    return lowest_terms(a, b);
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
    char* end = nullptr;
    double hertz = std::strtod(text.c_str(), &end);
    if (end != text.c_str() && *end == '/') {
        const char* denominator = end + 1;
        const double d = std::strtod(denominator, &end);
        hertz = end != denominator && d > 0 ? hertz / d : -1;
    }
    const bool whole = !text.empty() && *end == '\0' && std::isfinite(hertz);

    // Take the nearest rate within 0.005 Hz: users write 23.98, 29.97 and 59.94 for rates that are no such decimals.
    // chosen: 0.005 tells 23.98 from 24 and 29.97 from 30, whose distances are 0.02 and 0.03.
    if (whole)
        for (const FrameRate& rate : mpeg2_frame_rates())
            if (std::abs(rate.hertz.value() - hertz) < 0.005) return rate;
    std::string list;
    for (const FrameRate& rate : mpeg2_frame_rates()) list += (list.empty() ? "" : ", ") + std::string(rate.name);
    throw Error("frame rate " + text + ": films have one of " + list + " pictures a second");
}

Rational time_of(std::int64_t frame, const FrameRate& rate) {
    const Rational t{frame * rate.hertz.den, rate.hertz.num};
    const std::int64_t g = std::gcd(t.num, t.den);
    return g > 1 ? Rational{t.num / g, t.den / g} : t;
}

}  // namespace render2mpeg::core
