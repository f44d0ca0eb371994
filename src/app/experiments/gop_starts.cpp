#include "app/experiments/gop_starts.h"

#include <algorithm>
#include <cstdint>

namespace render2mpeg::app {

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
