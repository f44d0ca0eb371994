#pragma once
// Channels that one reader of a frame's file leaves for another.
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <utility>

#include "image/image.h"

namespace render2mpeg::app {

/// Channels of numbered files, read together with their frames by another thread. Each is taken once.
class SharedChannels {
  public:
    void put(std::int64_t frame, image::ExrChannels channels) {
        const std::lock_guard lock(mutex_);
        waiting_.insert_or_assign(frame, std::move(channels));
    }
    /// None where they were not read, or taken before. Those of frames more than `behind` before this one are
    /// forgotten.
    std::optional<image::ExrChannels> take(std::int64_t frame, std::int64_t behind) {
        const std::lock_guard lock(mutex_);
        std::erase_if(waiting_, [&](const auto& entry) { return entry.first < frame - behind; });
        auto found = waiting_.extract(frame);
        return found.empty() ? std::nullopt : std::optional(std::move(found.mapped()));
    }

  private:
    std::mutex mutex_;
    std::map<std::int64_t, image::ExrChannels> waiting_;
};

}  // namespace render2mpeg::app
