#include "app/experiments/windows.h"

#include <algorithm>

#include "app/loop/forecast.h"

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

std::vector<Chunk> windows_by_shot(const RenderJob& film, const Sample& sample) {
    std::vector<std::int64_t> begins = cuts_of(film);
    // chosen: eight shots are sampled one by one (4 to 16); of more the parts tell enough.
    if (begins.empty() || begins.size() >= 8) return windows_of(film.frames, sample);
    begins.insert(begins.begin(), film.frames.first);
    std::vector<Chunk> windows;
    for (std::size_t k = 0; k < begins.size(); ++k) {
        const std::int64_t end = k + 1 < begins.size() ? begins[k + 1] : film.frames.last + 1;
        windows.push_back(windows_of({begins[k], end - 1}, {1, sample.frames}).front());
        windows.back().index = static_cast<int>(k);
    }
    return windows;
}

}  // namespace render2mpeg::app
