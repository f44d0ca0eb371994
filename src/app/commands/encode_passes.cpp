#include "app/commands/encode_passes.h"

#include <algorithm>
#include <cmath>

#include "app/estimate/first_pass.h"
#include "app/system/interrupt.h"
#include "encoder/rate_search.h"

namespace render2mpeg::app {
namespace {

/// Codes chunks with one quantiser to learn their sizes. Empty after an interruption.
std::vector<encoder::FirstPassPicture> code_roughly(EncodeJob& job, std::span<const Chunk> chunks, double quantiser,
                                                    bool quiet) {
    Film fast = job.film;
    fast.coding = rough(fast.coding, quantiser);
    Progress progress(chunks.back().last - chunks.front().first + 1, quiet, "first pass", Counted::frames_of_step);
    FirstPassCollector collector(fast.coding);
    RunStatistics statistics;
    for (const Chunk& chunk : chunks)
        if (!encode_chunk(job, fast, chunk, {}, collector, statistics, progress) || InterruptGuard::requested())
            return {};
    return collector.film();
}

/// Geometric mean of the planned quantisers over those of the first pass.
double change_of(std::span<const encoder::BitAllocation> allocations, std::span<const encoder::FirstPassPicture> film) {
    double logarithms = 0;
    for (const encoder::BitAllocation& allocation : allocations) logarithms += std::log(allocation.quantiser);
    for (const encoder::FirstPassPicture& picture : film) logarithms -= std::log(picture.quantiser);
    return std::exp(logarithms / static_cast<double>(std::max<std::size_t>(1, film.size())));
}

/// Bits of the whole film, coded fast with one quantiser (MPEG-2's like). None after an interruption.
std::optional<double> fast_bits(EncodeJob& job, double quantiser, bool quiet) {
    Film film = job.film;
    film.coding.effort = encoder::Effort::fast;
    const std::vector<encoder::BitAllocation> allocations(static_cast<std::size_t>(film.frame_count()),
                                                          {.quantiser = quantiser});
    Progress progress(film.frame_count(), quiet, "first pass", Counted::frames_of_step);
    FirstPassCollector counter(film.coding);
    RunStatistics statistics;
    for (const Chunk& chunk : chunks_of(film.frames, film.coding.gop))
        if (!encode_chunk(job, film, chunk, allocations, counter, statistics, progress) || InterruptGuard::requested())
            return {};
    double bits = 0;
    for (const encoder::FirstPassPicture& picture : counter.film()) bits += picture.bits;
    return bits;
}

}  // namespace

std::vector<encoder::BitAllocation> first_pass(EncodeJob& job, std::span<const Chunk> chunks, bool quiet) {
    // chosen: again beyond a factor of 1.5, and no more than twice (1.2..3): noise for which 2 was guessed and 18 is
    // right was 28 % over its rate.
    constexpr double far = 1.5;
    double quantiser = usual_quantiser(job.film.coding);
    for (int again = 2;; --again) {
        const std::vector<encoder::FirstPassPicture> film = code_roughly(job, chunks, quantiser, quiet);
        if (film.empty()) return {};
        std::vector<encoder::BitAllocation> allocations =
            encoder::allocate_bits(job.film.coding, film, 1.0, chunks.back().last == job.film.frames.last);
        const double change = change_of(allocations, film);
        if (again == 0 || (change < far && change > 1 / far)) return allocations;
        const double nearer = std::clamp(std::round(quantiser * change), 1.0, 31.0);
        if (nearer == quantiser) return allocations;
        quantiser = nearer;
    }
}

bool code_at_rate(EncodeJob& job, const std::function<std::optional<double>()>& code, bool quiet,
                  RunStatistics& statistics) {
    const encoder::Settings& coding = job.film.coding;
    const auto frames = static_cast<std::size_t>(job.film.frame_count());
    const double wanted =
        static_cast<double>(coding.rate_control.bit_rate) * static_cast<double>(frames) / coding.rate.hertz.value();
    const double usual = usual_quantiser(coding);
    // chosen: within 10 %, five at most: efforts differ by as much. Then within 1 %: most films by the second try.
    encoder::RateSearch roughly(0.1, 5);
    while (roughly.goes_on()) {
        const StageTimer timer(statistics, Stage::first_pass);
        const std::optional<double> bits = fast_bits(job, usual * roughly.factor(), quiet);
        if (!bits) return false;
        roughly.try_ratio(*bits / wanted);
    }
    double best = 0, last = 0;
    const auto coded = [&](double quantiser) {
        job.allocations.assign(frames, {.quantiser = last = quantiser});
        return code();
    };
    for (encoder::RateSearch search = roughly.onwards(0.01, 8); search.goes_on();) {
        const std::optional<double> bits = coded(usual * search.factor());
        if (!bits) return false;
        if (search.try_ratio(*bits / wanted)) best = last;
    }
    // Films of a few kB may end farther off than they were.
    return best == last || coded(best).has_value();
}

bool look_through(EncodeJob& job, const Chunk& first, bool quiet, RunStatistics& statistics) {
    // chosen: four, some 240 pictures: cuts come more often than that. By single chunks, half of the loss beside two
    // passes is left.
    constexpr std::int64_t together = 4;
    if (first.index % together != 0) return true;
    std::vector<Chunk> chunks{first};
    while (std::ssize(chunks) < together && chunks.back().last < job.film.frames.last)
        chunks.push_back(*chunk_after(job.film, chunks.back()));
    const std::vector<encoder::BitAllocation> allocated =
        timed(statistics, Stage::first_pass, [&] { return first_pass(job, chunks, quiet); });
    if (allocated.empty()) return false;
    job.allocations.resize(static_cast<std::size_t>(job.film.frame_count()));
    std::copy(allocated.begin(), allocated.end(), job.allocations.begin() + (first.first - job.film.frames.first));
    return true;
}

}  // namespace render2mpeg::app
