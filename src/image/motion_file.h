#pragma once
// Motion of frames as other programs write it: channels of OpenEXR files, and motion streams (docs/coding.md).
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <utility>

#include "core/motion_field.h"
#include "core/plane.h"
#include "image/image.h"

namespace render2mpeg::image {

/// How compositing files write motion (docs/coding.md).
enum class MotionConvention { blender, nuke };

struct FrameMotion {
    core::MotionField to_previous, to_next;  ///< to the frames `frame - 1` and `frame + 1`
};

/// Reads motion from an OpenEXR file. Throws core::Error without such channels, or for another size.
FrameMotion read_motion(const std::filesystem::path& file, std::int64_t frame, int width, int height,
                        MotionConvention convention);

/// The same from channels that were read. `file`: for messages.
FrameMotion motion_of(const std::filesystem::path& file, ExrChannels channels, std::int64_t frame, int width,
                      int height, MotionConvention convention);

/// Whether a channel holds motion or pixel classes.
bool is_motion(const std::string& channel);

/// One frame's motion as a stream of version 2. `kinds`: pixel classes.
std::string motion_file(const core::MotionField& to_previous, const core::MotionField& to_next,
                        const core::Plane<core::PixelClass>& kinds);

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

}  // namespace render2mpeg::image
