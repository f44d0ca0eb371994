#include "app/loop/shots.h"

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

std::vector<Chunk> windows_of_shots(const RenderJob& film, int length) {
    std::vector<std::int64_t> begins = cuts_of(film);
    begins.insert(begins.begin(), film.frames.first);
    std::vector<Chunk> windows;
    for (std::size_t k = 0; k < begins.size(); ++k) {
        RenderJob shot = film;
        shot.frames = {begins[k], k + 1 < begins.size() ? begins[k + 1] - 1 : film.frames.last};
        windows.push_back(middle_windows(shot, 1, length).front());
        windows.back().index = static_cast<int>(k);
    }
    return windows;
}

SampleWindows sample_windows(const RenderJob& film, int most, int length) {
    std::vector<std::int64_t> begins = cuts_of(film);
    if (static_cast<int>(begins.size()) >= most) {
        SampleWindows even{middle_windows(film, most, length), {}};
        for (Chunk& window : even.all) {
            // The longer part counts.
            for (const std::int64_t cut : begins) {
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
    begins.insert(begins.begin(), film.frames.first);
    begins.push_back(film.frames.last + 1);
    for (std::size_t k = 0; k + 1 < begins.size(); ++k)
        found.weights.push_back(static_cast<double>(begins[k + 1] - begins[k]));
    return found;
}

}  // namespace render2mpeg::app
