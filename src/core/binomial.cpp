#include "core/binomial.h"

#include <cmath>

namespace render2mpeg::core {
namespace {

/// Chance of at most `marked` of `drawn`, at a `share` not below marked / drawn: terms fall from the last one down.
double chance_of_at_most(std::uint64_t marked, std::uint64_t drawn, double share) {
    const auto n = static_cast<double>(drawn), k = static_cast<double>(marked);
    double term = std::exp(std::lgamma(n + 1) - std::lgamma(k + 1) - std::lgamma(n - k + 1) + k * std::log(share) +
                           (n - k) * std::log1p(-share));
    double sum = term;
    for (double i = k; i > 0 && term > 1e-17 * sum; --i) {
        term *= i / (n - i + 1) * (1 - share) / share;
        sum += term;
    }
    return sum;
}

}  // namespace

double most_share(std::uint64_t marked, std::uint64_t drawn, double confidence) {
    if (drawn == 0 || marked >= drawn) return 1;
    double low = static_cast<double>(marked) / static_cast<double>(drawn), high = 1;
    // 60 halvings are a double's precision.
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        (chance_of_at_most(marked, drawn, middle) > 1 - confidence ? low : high) = middle;
    }
    return high;
}

}  // namespace render2mpeg::core
