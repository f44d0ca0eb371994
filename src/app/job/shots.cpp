#include "app/job/shots.h"

#include <algorithm>

namespace render2mpeg::app {

std::vector<std::int64_t> cuts_of(const RenderJob& film) {
    std::vector<std::int64_t> cuts;
    int camera = -1;
    for (const scene::Shot& shot : film.animation->shots) {
        if (shot.frame > film.frames.first && shot.frame <= film.frames.last && shot.camera != camera)
            cuts.push_back(shot.frame);
        camera = shot.camera;
    }
    return cuts;
}

int camera_at(const RenderJob& film, std::int64_t frame) {
    int camera = 0;
    for (const scene::Shot& shot : film.animation->shots)
        if (shot.frame <= frame) camera = shot.camera;
    return camera;
}

std::vector<Chunk> middle_windows(const RenderJob& film, int count, int length) {
    const std::int64_t all = film.frame_count();
    if (all <= static_cast<std::int64_t>(count) * length) return {{0, film.frames.first, film.frames.last}};
    std::vector<Chunk> windows;
    for (int i = 0; i < count; ++i) {
        const std::int64_t first = film.frames.first + (2 * i + 1) * all / (2 * count) - length / 2;
        windows.push_back({i, first, first + length - 1});
    }
    return windows;
}

std::vector<Chunk> stretches_of(const RenderJob& film, const std::vector<Chunk>& chunks) {
    const std::vector<std::int64_t> cuts = cuts_of(film);
    std::vector<Chunk> stretches;
    for (const Chunk& chunk : chunks) {
        stretches.push_back(chunk);
        for (const std::int64_t cut : cuts) {
            if (cut <= chunk.first || cut > chunk.last) continue;
            stretches.back().last = cut - 1;
            stretches.push_back({chunk.index, cut, chunk.last});
        }
    }
    return stretches;
}

std::vector<Chunk> middles_of(const std::vector<Chunk>& stretches, int length) {
    std::vector<Chunk> middles;
    for (const Chunk& stretch : stretches) {
        const std::int64_t first = stretch.first + std::max<std::int64_t>(0, stretch.frames() / 2 - length / 2),
                           last = std::min(first + length - 1, stretch.last);
        middles.push_back({static_cast<int>(middles.size()), first, last});
    }
    return middles;
}

std::vector<Chunk> windows_of_shots(const RenderJob& film, int length) {
    return middles_of(stretches_of(film, {{0, film.frames.first, film.frames.last}}), length);
}

std::int64_t SampleWindows::frames() const {
    std::int64_t sum = 0;
    for (const Chunk& window : all) sum += window.frames();
    return sum;
}

SampleWindows sample_windows(const RenderJob& film, int most, int length) {
    const std::vector<std::int64_t> cuts = cuts_of(film);
    if (static_cast<int>(cuts.size()) >= most) {
        SampleWindows even{middle_windows(film, most, length), {}};
        for (Chunk& window : even.all) {
            // The longer part counts.
            for (const std::int64_t cut : cuts) {
                if (cut <= window.first || cut > window.last) continue;
                if (cut - window.first > window.last - cut)
                    window.last = cut - 1;
                else
                    window.first = cut;
            }
            even.weights.push_back(1);
        }
        return even;
    }
    SampleWindows found{windows_of_shots(film, length), {}};
    for (const Chunk& shot : stretches_of(film, {{0, film.frames.first, film.frames.last}}))
        found.weights.push_back(static_cast<double>(shot.frames()));
    return found;
}

}  // namespace render2mpeg::app
