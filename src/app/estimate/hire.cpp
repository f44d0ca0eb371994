#include "app/estimate/hire.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <limits>
#include <numeric>
#include <queue>
#include <utility>

#include "app/estimate/chunk_shares.h"
#include "app/system/progress.h"
#include "core/text.h"
#include "parallel/loops.h"

namespace render2mpeg::app {
namespace {

/// Share of a frame's work that no second thread takes. fit: docs/measurements.md#many-cores, 0.022 (Sponza) to 0.068
/// (cornell) by 16 threads.
constexpr double serial_share = 0.04;

/// Seconds for each frame while the film is put together and decoded. chosen: as docs/farm/scaling.json says.
constexpr double join_of_frame = 0.005;

/// Of `cores` cores on some chunks: several are made at once, as many as there are.
double speed_up_of(int cores, std::size_t chunks) {
    const auto at_once = static_cast<int>(std::clamp<std::size_t>(static_cast<std::size_t>(cores) / threads_of_chunk, 1,
                                                                  std::max<std::size_t>(1, chunks)));
    return at_once * speed_up(std::max(1, cores / at_once));
}

/// Seconds of each part, and of all on a farm.
struct Spreading {
    std::vector<double> parts;
    double seconds = 0;
};

/// Parts of as many chunks as are done soonest: several fill a machine's cores better, and few cannot be spread. Of
/// those within a tenth of the soonest the longest, which cost least.
Spreading best_spreading(const std::vector<double>& chunks, double once, int cores, int machines) {
    Spreading best;
    double soonest = std::numeric_limits<double>::max();
    for (std::size_t each = 1; each <= chunks.size(); each *= 2) {
        Spreading spreading;
        for (const ChunkRange& part : balanced(chunks, (chunks.size() + each - 1) / each)) {
            const auto first = chunks.begin() + static_cast<std::ptrdiff_t>(part.first);
            const double work = std::reduce(first, first + static_cast<std::ptrdiff_t>(part.count()));
            spreading.parts.push_back(once + work / speed_up_of(cores, part.count()));
        }
        spreading.seconds = farm_seconds(spreading.parts, machines);
        soonest = std::min(soonest, spreading.seconds);
        if (best.parts.empty() || spreading.seconds <= 1.1 * soonest) best = std::move(spreading);
    }
    return best;
}

}  // namespace

std::string cost_text(const std::optional<Price>& price, int cores, double core_hours) {
    const std::string hours = fmt::format("{:.3g} core-hours", core_hours);
    if (!price) return hours;
    const double cost = core_hours * price->of_core_hour(cores);
    return hours + (cost < 1 ? fmt::format(", {:.2g}", cost) : fmt::format(", {:.2f}", cost));
}

double speed_up(int threads) {
    // Amdahl's law.
    return threads / (1 + serial_share * (threads - 1));
}

double farm_seconds(std::vector<double> parts, int machines) {
    std::ranges::sort(parts, std::greater());
    std::priority_queue<double, std::vector<double>, std::greater<>> free;
    double end = 0;
    for (const double part : parts) {
        double start = 0;
        if (std::ssize(free) == machines) start = free.top(), free.pop();
        free.push(start + part);
        end = std::max(end, start + part);
    }
    return end;
}

std::string hire_text(const RenderJob& film, const Forecast& f, const Hire& hire, bool quiet) {
    if (!hire.price && !hire.machines && !hire.cores) return {};
    const int cores = hire.cores.value_or(parallel::thread_count());
    const double work = f.cpu - f.once, once = f.once, join = join_of_frame * static_cast<double>(film.frame_count()),
                 one = once + join + work / speed_up_of(cores, film.chunks().size());
    std::string text =
        fmt::format("One machine of {}: about {}, {}.\n", core::counted(static_cast<std::size_t>(cores), "core"),
                    clock_text(one), cost_text(hire.price, cores, one * cores / 3600));
    const std::string trust = fmt::format(
        "These are within {:.0f} % in nine of ten films, but for what cores gain, a mean of two scenes "
        "(docs/machines.md).\n",
        100 * f.spread);
    if (!hire.machines) return text + trust;

    std::vector<double> chunks = chunk_shares(film, quiet);
    for (double& chunk : chunks) chunk *= work;
    const Spreading best = best_spreading(chunks, once, cores, *hire.machines);
    const double busy = once + join + std::reduce(best.parts.begin(), best.parts.end());
    text += fmt::format("A farm of {} such machines, --parts {}: about {}, the longest part {}; {} while they work.\n",
                        *hire.machines, best.parts.size(), clock_text(once + join + best.seconds),
                        clock_text(*std::ranges::max_element(best.parts)),
                        cost_text(hire.price, cores, busy * cores / 3600));
    return text + trust;
}

}  // namespace render2mpeg::app
