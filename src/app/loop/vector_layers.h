#pragma once
#include <cstdint>
#include <filesystem>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "core/motion_field.h"
#include "encoder/look_ahead.h"
#include "image/image.h"

namespace render2mpeg::app {

/// Channels of numbered files, read together with their frames by another thread. Each is taken once.
class SharedChannels {
  public:
    void put(std::int64_t frame, image::ExrChannels channels) {
        const std::lock_guard lock(mutex_);
        waiting_.insert_or_assign(frame, std::move(channels));
    }
    /// None where they were not read, or taken before. Forgets frames more than `behind` before this one.
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

/// How compositing files write motion (docs/coding.md).
enum class MotionConvention { blender, nuke };

/// Motion of one frame to its neighbours.
struct FrameMotion {
    core::MotionField to_previous, to_next;  ///< to the frames `frame - 1` and `frame + 1`
};

/// Reads motion from an OpenEXR file. Throws core::Error without such channels, or for another size.
FrameMotion read_motion(const std::filesystem::path& file, std::int64_t frame, int width, int height,
                        MotionConvention convention);

/// Whether a channel holds motion or pixel classes.
bool is_motion(const std::string& channel);

/// Motion between any two frames from steps between neighbours; a path ends (class `none`) outside the picture or at
/// another class. Over several frames only every second pixel and row has one, and the last: the encoder reads no
/// others.
class MotionSource {
  public:
    virtual ~MotionSource() = default;

    /// The frames differ. Throws core::Error.
    core::MotionField between(std::int64_t picture, std::int64_t reference);

    /// Longest motion onward, over frames that are read anyway.
    static constexpr std::int64_t reach_onward = encoder::LookAhead::depth;

  private:
    /// Valid until the next call.
    virtual const FrameMotion& frame(std::int64_t number) = 0;
};

/// Motion of numbered files, read ahead: OpenEXR, or motion streams (motion_pipe.h).
class VectorLayers : public MotionSource {
  public:
    /// `shared`: channels left by the reader of the frames; null: none.
    VectorLayers(std::filesystem::path pattern, MotionConvention convention, int width, int height,
                 std::shared_ptr<SharedChannels> shared = nullptr);

    /// Throws core::Error where a file of these frames is missing, or the first has no motion.
    void check(std::int64_t first, std::int64_t last);

    /// Frames over which a way is put together without reading a file twice. chosen: reach_onward and the references
    /// behind; each frame takes 18 MB of memory at 1280x720.
    static constexpr std::int64_t reach = 16;

  private:
    const FrameMotion& frame(std::int64_t number) override;
    FrameMotion read(std::int64_t number) const;

    std::filesystem::path pattern_;
    MotionConvention convention_;
    int width_, height_;
    std::shared_ptr<SharedChannels> shared_;
    std::map<std::int64_t, FrameMotion> read_;                  ///< the frames asked for last
    std::int64_t last_ = -1;                                    ///< frame that may be read before it is asked for
    std::map<std::int64_t, std::future<FrameMotion>> reading_;  ///< in threads of their own
};

}  // namespace render2mpeg::app
