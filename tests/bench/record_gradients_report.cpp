#include "record_gradients_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>

namespace render2mpeg::bench {
namespace {

constexpr float most_beyond = 0.01f;

/// Whose hundredth may be beyond.
enum class Share { of_served, of_all };

/// The most that is served with 1 % beyond.
struct Served {
    double share = 0;
    int trust = most_trust;
    float instead = 1;  ///< see most_served
};

/// `error(sample, trust)`: over tolerance, NaN where the sample is not served.
template <class Error>
void serve_most(const std::vector<Sample>& samples, Share share, float instead, const Error& error, Served& best) {
    for (int k = least_trust; k <= most_trust; ++k) {
        double served = 0, beyond = 0;
        for (const Sample& s : samples) {
            const float e = error(s, k);
            served += std::isnan(e) ? 0 : 1;
            beyond += std::abs(e) > 1.0f ? 1 : 0;
        }
        const double of = share == Share::of_served ? served : static_cast<double>(samples.size());
        if (beyond > most_beyond * of || served <= best.share * static_cast<double>(samples.size())) continue;
        best = {served / static_cast<double>(samples.size()), k, instead};
    }
}

/// Of a method; where it says something else instead, that is doubted for more by what serves most.
Served most_served(const std::vector<Sample>& samples, Share share, Method method, int t) {
    Served best;
    const auto m = static_cast<std::size_t>(method);
    for (const float instead : {0.5f, 1.0f, 2.0f, 4.0f, 8.0f}) {
        if (!says_else(method) && instead != 1.0f) continue;
        serve_most(
            samples, share, instead,
            [&](const Sample& s, int k) {
                for (const Judged& j : s.judged[m])
                    if (j.found && trust_of(k) * (j.instead ? instead : 1.0f) * j.over[t] <= 1.0f)
                        return j.error / s.allowed(t);
                return std::numeric_limits<float>::quiet_NaN();
            },
            best);
    }
    return best;
}

std::string said(const Served& s) {
    const std::string instead = s.instead != 1.0f ? fmt::format(", {}", s.instead) : "";
    return fmt::format("{:.1f} % ({:.2f}{})", 100 * s.share, trust_of(s.trust), instead);
}

double root_mean_square(const std::vector<float>& v) {
    double sum = 0;
    for (const float x : v) sum += static_cast<double>(x) * x;
    return v.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(v.size()));
}

double percentile(std::vector<float> v, double part) {
    if (v.empty()) return 0;
    std::sort(v.begin(), v.end());
    return v[std::min(v.size() - 1, static_cast<std::size_t>(part * static_cast<double>(v.size())))];
}

std::vector<double> ranks(const std::vector<float>& v) {
    std::vector<std::size_t> order(v.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return v[a] < v[b]; });
    std::vector<double> rank(v.size());
    for (std::size_t i = 0; i < order.size(); ++i) rank[order[i]] = static_cast<double>(i);
    return rank;
}

double rank_correlation(const std::vector<float>& a, const std::vector<float>& b) {
    const std::vector<double> x = ranks(a), y = ranks(b);
    const double mean = 0.5 * (static_cast<double>(a.size()) - 1);
    double xy = 0, xx = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        xy += (x[i] - mean) * (y[i] - mean);
        xx += (x[i] - mean) * (x[i] - mean);
    }
    return xx > 0 ? xy / xx : 0;
}

}  // namespace

void report(const std::string& title, const std::vector<Sample>& samples) {
    std::vector<const Sample*> planes;
    const auto plane = static_cast<std::size_t>(Method::plane);
    for (const Sample& s : samples) {
        bool all = s.judged[plane][1].found;
        for (const auto& of_method : s.judged) all = all && of_method[1].found;
        if (all) planes.push_back(&s);
    }
    std::vector<float> change, left;
    for (const Sample& s : samples) {
        if (!s.has_nearest) continue;
        change.push_back(s.share(s.change));
        left.push_back(s.share(s.left));
    }
    fmt::print(
        "{}: light differs from the nearest record's by {:.2f}, {:.2f} and {:.2f} % (median, 75th and 90th "
        "percentile), "
        "with its gradients by {:.2f}, {:.2f} and {:.2f} %\n\n",
        title, 100 * percentile(change, 0.5), 100 * percentile(change, 0.75), 100 * percentile(change, 0.9),
        100 * percentile(left, 0.5), 100 * percentile(left, 0.75), 100 * percentile(left, 0.9));
    const auto smooth = std::count_if(planes.begin(), planes.end(), [](const Sample* s) { return s->smooth; });
    fmt::print(
        "| {}: {} pixels, {} in planes, {} of these smooth | rms, 95th, 99th | beyond 2, 8 % | smooth, edges | knows "
        "| served at 2 % | at 8 % | at 2 %, 1 % of all | at 8 % |\n|---|---|---|---|---|---|---|---|---|\n",
        title, samples.size(), planes.size(), smooth);
    for (int m = 0; m < method_count; ++m) {
        std::vector<float> error, off, parts[2];
        int beyond[tolerance_count]{};
        for (const Sample* s : planes) {
            const Judged& j = s->judged[m][1];
            error.push_back(s->share(j.error));
            off.push_back(s->share(j.off));
            parts[s->smooth ? 0 : 1].push_back(error.back());
            for (int t = 0; t < tolerance_count; ++t) beyond[t] += std::abs(j.error) > s->allowed(t) ? 1 : 0;
        }
        const double n = std::max<double>(static_cast<double>(planes.size()), 1);
        std::string served;
        for (const Share share : {Share::of_served, Share::of_all})
            for (int t = 0; t < tolerance_count; ++t)
                served += fmt::format(" {} |", said(most_served(samples, share, static_cast<Method>(m), t)));
        fmt::print("| {} | {:.2f}, {:.2f}, {:.2f} % | {:.2f}, {:.2f} % | {:.2f}, {:.2f} % | {:.3f} |{}\n",
                   method_names[static_cast<std::size_t>(m)], 100 * root_mean_square(error),
                   100 * percentile(error, 0.95), 100 * percentile(error, 0.99), 100 * beyond[0] / n,
                   100 * beyond[1] / n, 100 * root_mean_square(parts[0]), 100 * root_mean_square(parts[1]),
                   rank_correlation(off, error), served);
    }
    if (samples.empty() || samples[0].served[0].empty()) return;
    fmt::print("| the product's own estimate, all its radii | | | | |");
    for (const Share share : {Share::of_served, Share::of_all})
        for (int t = 0; t < tolerance_count; ++t) {
            const auto error = [t](const Sample& s, int k) {
                return s.served[t][static_cast<std::size_t>(k - least_trust)];
            };
            Served served;
            serve_most(samples, share, 1, error, served);
            fmt::print(" {} |", said(served));
        }
    fmt::print("\n");
}

}  // namespace render2mpeg::bench
