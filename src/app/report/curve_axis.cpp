#include "app/report/curve_axis.h"

#include <algorithm>
#include <cmath>

namespace render2mpeg::app {
namespace {

std::vector<double> even_values(double low, double high, int wanted) {
    const double step = round_up((high - low) / (wanted + 1));
    std::vector<double> values;
    for (double k = std::ceil(low / step); k * step <= high * (1 + 1e-12) && values.size() < 100; ++k)
        values.push_back(k * step + 0.0);  // not "-0"
    return values;
}

/// Those of `digits` times a power of ten, of every so manieth power.
std::vector<double> decade_values(double low, double high, const std::vector<double>& digits, int every) {
    std::vector<double> values;
    const int first = static_cast<int>(std::floor(std::log10(low)));
    for (int power = first - (first % every + every) % every; std::pow(10.0, power) <= high; power += every)
        for (const double digit : digits) {
            const double value = digit * std::pow(10.0, power);
            if (value >= low && value <= high) values.push_back(value);
        }
    return values;
}

}  // namespace

double round_up(double value) {
    if (!(value > 0) || !std::isfinite(value)) return 1;
    const double power = std::pow(10.0, std::floor(std::log10(value)));
    for (const double step : {1.0, 2.0, 5.0})
        if (step * power >= value * (1 - 1e-9)) return step * power;
    return 10 * power;
}

std::vector<double> round_values(double low, double high, bool logarithmic, int wanted) {
    if (!logarithmic) return even_values(low, high, wanted);
    // Take the fewest digits that give enough values; where all of them are too many, leave out powers of ten.
    std::vector<double> values;
    for (const std::vector<double>& digits : {std::vector<double>{1}, {1, 3}, {1, 2, 5}, {1, 2, 3, 4, 5, 6, 7, 8, 9}}) {
        std::vector<double> more = decade_values(low, high, digits, 1);
        if (!values.empty() && more.size() > static_cast<std::size_t>(2 * wanted)) break;
        values = std::move(more);
        if (values.size() * 3 >= static_cast<std::size_t>(2 * wanted)) break;
    }
    for (int every = 2; values.size() > static_cast<std::size_t>(2 * wanted); ++every)
        values = decade_values(low, high, {1}, every);
    return values.size() >= 2 ? values : even_values(low, high, wanted);
}

}  // namespace render2mpeg::app
