#pragma once
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "core/motion_field.h"
#include "encoder/look_ahead.h"
#include "image/image.h"
#include "image/motion_file.h"

namespace render2mpeg::app {

using image::MotionConvention;

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

/// Motion between any two frames from steps between neighbours; a path ends (class `none`) outside the picture or at
/// another class. Over several frames only every second pixel and row has one, and the last: the encoder reads no
/// others.
class MotionSource {
  public:
    virtual ~MotionSource() = default;

    /// The frames differ. Throws core::Error.
    core::MotionField between(std::int64_t picture, std::int64_t reference);

    /// Whether frames that were asked for may not be asked for again.
    virtual bool is_read_once() const { return false; }

    /// Longest motion onward, over frames that are read anyway.
    static constexpr std::int64_t reach_onward = encoder::LookAhead::depth;

  private:
    /// Valid until the next call.
    virtual const image::FrameMotion& frame(std::int64_t number) = 0;
};

/// Motion of numbered files, read ahead: OpenEXR, or motion streams.
class VectorLayers : public MotionSource {
  public:
    /// `shared`: channels left by the reader of the frames; null: none.
    VectorLayers(std::filesystem::path pattern, MotionConvention convention, int width, int height,
                 std::shared_ptr<SharedChannels> shared = nullptr);

    /// Throws core::Error where a file of these frames is missing, or the first has no motion.
    void check(std::int64_t first, std::int64_t last);

    /// Frames over which a trajectory is put together without reading a file twice. chosen: reach_onward and the
    /// references behind; each frame takes 18 MB of memory at 1280x720.
    static constexpr std::int64_t reach = 16;

  private:
    const image::FrameMotion& frame(std::int64_t number) override;
    image::FrameMotion read(std::int64_t number) const;

    std::filesystem::path pattern_;
    MotionConvention convention_;
    int width_, height_;
    std::shared_ptr<SharedChannels> shared_;
    std::map<std::int64_t, image::FrameMotion> read_;  ///< the frames asked for last
    std::int64_t last_ = -1;                           ///< frame that may be read before it is asked for
    std::map<std::int64_t, std::future<image::FrameMotion>> reading_;  ///< in threads of their own
};

/// Motion from a descriptor ("fd:3") or a pipe ("x.motion"), read ahead as far as pictures are, since the writer of
/// both may wait for either.
class MotionPipe : public MotionSource {
  public:
    static bool is_one(const std::filesystem::path& name);

    explicit MotionPipe(const std::filesystem::path& name);
    /// Waits for the header, first of all calls. Throws core::Error.
    void start(int width, int height);
    bool is_read_once() const override { return true; }
    ~MotionPipe() override;

  private:
    const image::FrameMotion& frame(std::int64_t number) override;
    void read_ahead();

    std::string name_;
    int descriptor_;
    bool own_;  ///< the descriptor was opened here
    image::MotionBytes bytes_;
    image::MotionHeader header_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::map<std::int64_t, image::FrameMotion> read_;
    std::int64_t next_ = 0, asked_ = 0;  ///< frame to be read next; the latest that was asked for
    bool ended_ = false, stopped_ = false;
    std::string failure_;
    std::thread reader_;
};

}  // namespace render2mpeg::app
