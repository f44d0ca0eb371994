#pragma once
#include <atomic>
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

/// Writes one frame's motion as a stream of version 2. `kinds`: pixel classes. Throws core::Error.
void write_motion_file(const std::filesystem::path& file, const core::MotionField& to_previous,
                       const core::MotionField& to_next, const core::Plane<core::PixelClass>& kinds);

/// Reads a stream of one frame. Throws core::Error.
FrameMotion read_motion_file(const std::filesystem::path& file, std::int64_t number, int width, int height);

/// Header of a motion stream, 32 bytes (docs/coding.md).
struct MotionHeader {
    int width = 0, height = 0;
    int fields = 1;        ///< of each frame: 1, to the frame before; 2, and to the frame after
    bool compact = false;  ///< vectors are 16-bit steps, else floats
};

/// Reads a stream from a descriptor and counts bytes for messages.
class MotionBytes {
  public:
    MotionBytes(int descriptor, std::string name) : descriptor_(descriptor), name_(std::move(name)) {}

    /// Throws core::Error for no header, or another size.
    MotionHeader header(int width, int height);
    /// The next frame; false at the stream's end. Throws core::Error.
    bool frame(const MotionHeader& header, std::int64_t number, FrameMotion& motion);
    void stop() { stopped_ = true; }

  private:
    /// Fills all of it; false at the stream's end. Throws core::Error within.
    bool read(void* into, std::size_t size);
    bool vectors(const MotionHeader& header, core::Plane<glm::vec2>& vectors);
    [[noreturn]] void refuse(const std::string& cause) const;

    int descriptor_;
    std::string name_;
    std::uint64_t at_ = 0;
    std::atomic<bool> stopped_{false};
};

/// Motion from a descriptor ("fd:3") or a pipe ("x.motion"), read ahead as far as pictures are, since the writer of
/// both may wait for either.
class MotionPipe : public MotionSource {
  public:
    static bool is_one(const std::filesystem::path& name);

    explicit MotionPipe(const std::filesystem::path& name);
    /// Waits for the header, first of all calls. Throws core::Error.
    void start(int width, int height);
    ~MotionPipe() override;

  private:
    const FrameMotion& frame(std::int64_t number) override;
    void read_ahead();

    std::string name_;
    int descriptor_;
    bool own_;  ///< the descriptor was opened here
    MotionBytes bytes_;
    MotionHeader header_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::map<std::int64_t, FrameMotion> read_;
    std::int64_t next_ = 0, asked_ = 0;  ///< frame to be read next; the latest that was asked for
    bool ended_ = false, stopped_ = false;
    std::string failure_;
    std::thread reader_;
};

}  // namespace render2mpeg::app
