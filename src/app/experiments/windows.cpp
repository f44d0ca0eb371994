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

std::set<std::int64_t> reference_frames(const Chunk& window, int count) {
    std::set<std::int64_t> frames;
    if (count == 1) frames.insert(window.last);
    const int spots = count / 2;
    for (int i = 1; i <= spots; ++i) {
        const std::int64_t last = window.first + window.frames() * i / spots - 1;
        frames.insert({last, std::max(last - 1, window.first)});
    }
    // An odd frame, and those of overlapping pairs, go to the remaining places.
    std::int64_t next = window.first + window.frames() / 2;
    for (std::int64_t i = 0; static_cast<std::int64_t>(frames.size()) < count && i < window.frames(); ++i) {
        frames.insert(next);
        next = next == window.last ? window.first : next + 1;
    }
    return frames;
}

void GopStarts::add(const encoder::CodedPicture& picture) {
    if (!picture.plan.starts_gop) return;
    bytes_ += static_cast<double>(picture.bytes.size());
    ++count_;
}

void GopStarts::add(const GopStarts& others) {
    bytes_ += others.bytes_;
    count_ += others.count_;
}

double GopStarts::surplus(const RenderJob& film, const std::vector<Chunk>& windows, double bytes) const {
    const std::int64_t gop = std::min<std::int64_t>(film.coding.gop, film.frame_count());
    std::int64_t begun = 0, frames = 0;
    for (const Chunk& window : windows) {
        begun += (window.frames() + gop - 1) / gop;
        frames += window.frames();
    }
    if (count_ == 0 || count_ >= frames) return 0;
    const auto all = static_cast<double>(frames);
    const double others = (bytes * all - bytes_) / (all - count_);
    const double share = static_cast<double>(begun) / all - 1.0 / static_cast<double>(gop);
    return std::max(0.0, share) * std::max(0.0, bytes_ / count_ - others);
}

}  // namespace render2mpeg::app
