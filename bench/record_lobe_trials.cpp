#include "bench/record_lobe_trials.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

namespace render2mpeg::bench {
namespace {

constexpr float tolerances[] = {0.02f, 0.08f, 0.26f};

std::string name_of(int means, Basis basis) {
    if (means == lobe_alone) return "lobe, 40 bytes";
    if (means == slopes) return "lobe and slopes, 88 bytes";
    const int orders = orders_of(basis, (means - harmonics) % tried_orders);
    const int bytes = 12 * functions_of(basis, orders);
    return means < differences ? fmt::format("{} orders, {} bytes", orders, bytes)
                               : fmt::format("lobe and {} orders, {} bytes", orders, bytes + 40);
}

std::string served(std::vector<Trial> trials) {
    std::sort(trials.begin(), trials.end(), [](const Trial& a, const Trial& b) { return a.lobe_part < b.lobe_part; });
    std::string cell;
    for (const float tolerance : tolerances) {
        std::size_t beyond = 0, most = 0;
        for (std::size_t i = 0; i < trials.size(); ++i) {
            beyond += trials[i].error > tolerance ? 1 : 0;
            if (100 * beyond <= i + 1) most = i + 1;
        }
        cell += fmt::format("{:.0f} ", 100.0 * static_cast<double>(most) /
                                           static_cast<double>(std::max<std::size_t>(trials.size(), 1)));
    }
    return cell;
}

std::string median_error(std::vector<Trial> trials) {
    if (trials.empty()) return "-";
    std::nth_element(trials.begin(), trials.begin() + static_cast<std::ptrdiff_t>(trials.size() / 2), trials.end(),
                     [](const Trial& a, const Trial& b) { return a.error < b.error; });
    return fmt::format("{:.1f}", 100 * trials[trials.size() / 2].error);
}

void print_table(const Trials& trials, int roughness, const std::string& head, int first, int columns) {
    fmt::print("| roughness {:.1f}: kept | {}\n", 0.01 * roughness, head);
    fmt::print("|---|");
    for (int c = 0; c < columns; ++c) fmt::print("---|");
    fmt::print("\n");
    for (int m = 0; m < means_count; ++m) {
        if (trials.of[m][first].empty()) continue;
        fmt::print("| {} |", name_of(m, trials.basis));
        for (int c = first; c < first + columns; ++c)
            fmt::print(" {}({} %) |", served(trials.of[m][c]), median_error(trials.of[m][c]));
        fmt::print("\n");
    }
}

}  // namespace

void print_tables(const Trials& trials, int roughness) {
    print_table(trials, roughness, "turned by 0 | 2 | 5 | 10 | 20 degrees |", 0, turn_count);
    print_table(trials, roughness, "1 pixel off | 2 | 4 | mean of four, 1 | 2 | 4 |", turn_count, 2 * distance_count);
}

}  // namespace render2mpeg::bench
