#pragma once
// Motion streamed by another program beside its pictures.
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
