#include "app/experiments/windows.h"

#include <algorithm>

namespace render2mpeg::app {

std::vector<Chunk> windows_of(FrameRange film, const Sample& sample) {
    const std::int64_t all = film.last - film.first + 1, length = std::min<std::int64_t>(sample.frames, all);
    const std::int64_t count = std::min<std::int64_t>(sample.windows, all / length);
    std::vector<Chunk> windows;
    for (std::int64_t i = 0; i < count; ++i) {
        const std::int64_t begin = i * all / count, end = (i + 1) * all / count;
        const std::int64_t first = film.first + begin + (end - begin - length) / 2;
        windows.push_back({static_cast<int>(i), first, first + length - 1});
    }
    return windows;
}

std::set<std::int64_t> reference_frames(const Chunk& window, int count) {
    std::set<std::int64_t> frames;
    if (count == 1) frames.insert(window.last);
    const int spots = count / 2;
    for (int i = 1; i <= spots; ++i) {
        const std::int64_t last = window.first + window.frames() * i / spots - 1;
        frames.insert({last, std::max(last - 1, window.first)});
    }
    // An odd one, and pairs that would overlap in a short window, have their frames where there are some left.
    std::int64_t next = window.first + window.frames() / 2;
    for (std::int64_t i = 0; static_cast<std::int64_t>(frames.size()) < count && i < window.frames(); ++i) {
        frames.insert(next);
        next = next == window.last ? window.first : next + 1;
    }
    return frames;
}

}  // namespace render2mpeg::app
