#include "app/loop/chunks_at_once.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <utility>

#include "app/loop/forecast.h"
#include "app/loop/resume.h"
#include "app/system/memory_limit.h"
#include "parallel/loops.h"

namespace render2mpeg::app {
namespace {

/// Threads for each chunk. chosen: 4 of 4 and 16: a frame of 320x180 is lit 3.3 to 3.8 times as fast by 4 threads, by
/// 16 7.5 to 12 times (docs/measurements.md#many-cores), and a further chunk takes little memory.
constexpr int threads_of_chunk = 4;

/// Why chunks follow each other, or nothing.
std::string why_in_order(const RenderJob& film, const RenderOptions& options) {
    if (film.chunks().size() < 2) return "the film has no other";
    if (options.as) return "standard output takes pictures in order";
    if (!options.heatmaps.empty()) return "--heatmap is made in order";
    if (light_file_of(film, options)) return "--light-cache grows from chunk to chunk";
    return {};
}

/// The first chunk needs all; others share what never moves.
int allowed_by_memory(const RenderJob& film, std::uint64_t limit) {
    const MemoryNeed need = memory_need(film);
    if (need.total() >= limit) return 1;
    return 1 + static_cast<int>(std::min<std::uint64_t>((limit - need.total()) / need.of_chunk(), 1023));
}

}  // namespace

ChunksAtOnce chunks_at_once(const RenderJob& film, const RenderOptions& options) {
    if (std::string why = why_in_order(film, options); !why.empty()) return {1, std::move(why)};
    const int threads = parallel::thread_count();
    ChunksAtOnce chosen;
    if (options.chunks_at_once)
        chosen = {*options.chunks_at_once, fmt::format("--chunks-at-once {}", *options.chunks_at_once)};
    else
        chosen = {std::max(1, (threads + threads_of_chunk / 2) / threads_of_chunk),
                  fmt::format("{} thread{}, {} to a chunk", threads, threads == 1 ? "" : "s", threads_of_chunk)};
    if (const std::size_t chunks = film.chunks().size(); static_cast<std::size_t>(chosen.count) > chunks) {
        chosen.count = static_cast<int>(chunks);
        chosen.reason += fmt::format("; the film has {}", chunks);
    }
    if (chosen.count > 1 && (options.memory || !options.chunks_at_once)) {
        const int allowed =
            allowed_by_memory(film, options.memory ? memory_from(*options.memory) : machine_memory() / 2);
        chosen.count = std::min(chosen.count, allowed);
        chosen.reason += fmt::format("; memory allows {}", allowed);
    }
    return chosen;
}

std::string text_of(const ChunksAtOnce& chosen) {
    return fmt::format("{} chunk{} at once: {}", chosen.count, chosen.count == 1 ? "" : "s", chosen.reason);
}

}  // namespace render2mpeg::app
