#pragma once
// Reads a chunk's finished frames ahead of their coding, and looks at them.
#include <cstdint>
#include <deque>
#include <future>
#include <optional>

#include "app/loop/frame_source.h"
#include "app/loop/run_statistics.h"
#include "app/options/chunk.h"
#include "core/picture.h"
#include "encoder/look_ahead.h"
#include "encoder/types.h"

namespace render2mpeg::app {

/// The frames of one chunk in order, read in threads of their own as far ahead as the look-ahead asks for. What it
/// says depends on the chunk's frames alone.
class FramesAhead {
  public:
    FramesAhead(FrameSource& frames, const Chunk& chunk, const encoder::Settings& coding);
    ~FramesAhead();

    /// The next frame; those that look() needs are there then. None behind the last one, which of an open-ended source
    /// only comes to be known. Waiting counts as reading. Throws core::Error.
    std::optional<core::Picture> next(RunStatistics& statistics);
    /// Those that next() will give, as far as they are read now; so many that look() needs them for the first.
    const std::deque<core::Picture>& waiting(RunStatistics& statistics);
    /// Those that are read and not given.
    const std::deque<core::Picture>& later() const { return read_; }
    encoder::LookAhead& look() { return look_; }

  private:
    void start_reading();

    FrameSource& frames_;
    std::int64_t next_, last_;  ///< frame to be read next, and the chunk's last
    std::deque<std::future<std::optional<core::Picture>>> reading_;
    std::deque<core::Picture> read_;
    encoder::LookAhead look_;
};

}  // namespace render2mpeg::app
