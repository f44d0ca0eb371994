#include "app/loop/frames_ahead.h"

#include <utility>

#include "app/loop/statistics_recorder.h"

namespace render2mpeg::app {

FramesAhead::FramesAhead(FrameSource& frames, const Chunk& chunk, const encoder::Settings& coding)
    : frames_(frames),
      next_(chunk.first),
      last_(chunk.last),
      look_(frames.size().width, frames.size().height, coding.b_pictures) {
    start_reading();
}

FramesAhead::~FramesAhead() {
    if (reading_.valid()) reading_.wait();
}

void FramesAhead::start_reading() {
    if (next_ > last_) return;
    reading_ = std::async(std::launch::async, [this, n = next_] { return frames_.read(n); });
}

core::Picture FramesAhead::next(RunStatistics& statistics) {
    while (reading_.valid() && static_cast<std::int64_t>(read_.size()) <= encoder::LookAhead::depth) {
        read_.push_back(timed(statistics, Stage::develop, [&] { return reading_.get(); }));
        ++next_;
        start_reading();
        timed(statistics, Stage::encode, [&] { look_.add(read_.back()); });
    }
    if (!reading_.valid()) look_.end();
    core::Picture picture = std::move(read_.front());
    read_.pop_front();
    look_.forget_before(picture.number - 4);
    return picture;
}

}  // namespace render2mpeg::app
