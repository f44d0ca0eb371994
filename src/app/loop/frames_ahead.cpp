#include "app/loop/frames_ahead.h"

#include <utility>

#include "app/loop/statistics_recorder.h"

namespace render2mpeg::app {
namespace {

/// chosen: 2: frames of many packed channels take several times as long to read as to code.
constexpr std::size_t readers = 2;

}  // namespace

FramesAhead::FramesAhead(FrameSource& frames, const Chunk& chunk, const encoder::Settings& coding)
    : frames_(frames),
      next_(chunk.first),
      last_(chunk.last),
      look_(frames.size().width, frames.size().height, coding.b_pictures) {
    start_reading();
}

FramesAhead::~FramesAhead() {
    for (const std::future<std::optional<core::Picture>>& frame : reading_) frame.wait();
}

void FramesAhead::start_reading() {
    for (; next_ <= last_ && reading_.size() < readers; ++next_)
        reading_.push_back(std::async(std::launch::async, [this, n = next_] { return frames_.read(n); }));
}

const std::deque<core::Picture>& FramesAhead::waiting(RunStatistics& statistics) {
    while (!reading_.empty() && static_cast<std::int64_t>(read_.size()) <= encoder::LookAhead::depth) {
        std::future<std::optional<core::Picture>> frame = std::move(reading_.front());
        reading_.pop_front();
        std::optional<core::Picture> picture = timed(statistics, Stage::develop, [&] { return frame.get(); });
        if (!picture) {  // the source has ended, and what is being read lies behind its end
            last_ = -1;
            continue;
        }
        read_.push_back(std::move(*picture));
        start_reading();
        timed(statistics, Stage::encode, [&] { look_.add(read_.back()); });
    }
    if (reading_.empty()) look_.end();
    return read_;
}

std::optional<core::Picture> FramesAhead::next(RunStatistics& statistics) {
    if (waiting(statistics).empty()) return {};
    core::Picture picture = std::move(read_.front());
    read_.pop_front();
    look_.forget_before(picture.number - 4);
    return picture;
}

}  // namespace render2mpeg::app
