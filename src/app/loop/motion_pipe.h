#pragma once
// Motion that another program writes beside its pictures, as it makes them.
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <utility>

#include "app/loop/vector_layers.h"

namespace render2mpeg::app {

/// Writes one frame's motion as a stream of one frame, version 2. `kinds` tells what its pixels are. Throws
/// core::Error.
void write_motion_file(const std::filesystem::path& file, const core::MotionField& to_previous,
                       const core::MotionField& to_next, const core::Plane<core::PixelClass>& kinds);

/// Reads such a file of frame `number`, or any stream of one frame. Throws core::Error.
FrameMotion read_motion_file(const std::filesystem::path& file, std::int64_t number, int width, int height);

/// What the first 32 bytes of a motion stream say (docs/coding.md).
struct MotionHeader {
    int width = 0, height = 0;
    int fields = 1;        ///< of each frame: 1, to the frame before; 2, and to the frame after
    bool compact = false;  ///< vectors are 16-bit steps, else floats
};

/// Reads from a descriptor; the bytes it has read are counted for messages.
class MotionBytes {
  public:
    /// `name` is what messages call it.
    MotionBytes(int descriptor, std::string name) : descriptor_(descriptor), name_(std::move(name)) {}

    /// Throws core::Error for what is no header, or of another size.
    MotionHeader header(int width, int height);
    /// The next frame's; false where the stream ends behind a whole one. Throws core::Error.
    bool frame(const MotionHeader& header, std::int64_t number, FrameMotion& motion);
    /// Whoever waits in another thread gives up.
    void stop() { stopped_ = true; }

  private:
    /// Fills all of it; false where the stream had ended before. Throws core::Error where it ends within.
    bool read(void* into, std::size_t size);
    bool vectors(const MotionHeader& header, core::Plane<glm::vec2>& vectors);
    [[noreturn]] void refuse(const std::string& cause) const;

    int descriptor_;
    std::string name_;
    std::uint64_t at_ = 0;
    std::atomic<bool> stopped_{false};
};

/// Motion from a descriptor ("fd:3") or a pipe ("x.motion"). It is read ahead of the pictures, since who writes both
/// may wait for either; as far as pictures are looked at ahead, and no further.
class MotionPipe : public MotionSource {
  public:
    /// Whether --motion names such a stream.
    static bool is_one(const std::filesystem::path& name);

    /// Opens it. Throws core::Error.
    explicit MotionPipe(const std::filesystem::path& name);
    /// Waits for the header. Throws core::Error. To be called before anything is asked.
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
