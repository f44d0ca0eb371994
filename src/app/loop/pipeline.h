#pragma once
// The loop of a chunk: each frame from the scene to the stream.
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "app/files/chunk_file.h"
#include "app/loop/render_job.h"
#include "app/loop/run_statistics.h"
#include "app/loop/sink.h"
#include "app/options/chunk.h"

namespace render2mpeg::app {

/// One frame when its light is gathered.
struct LitFrame {
    const scene::Snapshot& world;
    const core::Visible& visible;
    const core::ToleranceMap& tolerance;  ///< that it was lit by
    const core::Radiance& radiance;
    const core::Picture& picture;
};

/// Looks on while a chunk is made, and changes nothing. Frames come in order, pictures in coding order.
class LoopObserver {
  public:
    virtual ~LoopObserver() = default;
    virtual void lit(const LitFrame&) {}
    virtual void coded(const encoder::CodedPicture&) {}
    /// Before a chunk's first frame, and after its last.
    virtual void begins(const Chunk&) {}
    virtual void ends(const Chunk&) {}
};

/// Where the products of a chunk go; what is null is not wanted. Pictures are coded where the job is a film.
struct Destination {
    ChunkFile* film = nullptr;
    Sink* sink = nullptr;
    const std::filesystem::path* layers = nullptr;  ///< folder of the multilayer files
    LoopObserver* observer = nullptr;
};

/// What the encoder is told of a frame before it is lit.
encoder::PictureFacts facts_of(const RenderJob& film, const scene::Snapshot& world, const Chunk& chunk);

/// Adds what motion against the picture before decides of types and quantisers; nothing where a chunk or a shot begins,
/// and where nothing moves.
void tell_motion(const RenderJob& film, const Chunk& chunk, const core::Visible& visible, const scene::Snapshot& world,
                 encoder::PictureFacts& facts);

/// Motion from a picture to each of its references: exact at any distance, since a snapshot of any frame can be had.
/// None where nothing moves: then the encoder's zero vector is exact.
std::vector<core::MotionField> motion_of(const RenderJob& film, const encoder::PicturePlan& coding,
                                         const core::Visible& visible, const scene::Snapshot& world);

/// Motion to the last picture that depends on this one; none where the encoder asks for none.
std::optional<core::MotionField> onward_motion(const RenderJob& film, const encoder::PicturePlan& coding,
                                               const core::Visible& visible, const scene::Snapshot& world);

/// Renders and codes one chunk: the only place that knows scene, renderer, eye and encoder.
/// Calls `frame_done` after every frame and stops early, leaving complete pictures, when it returns false. The
/// statistics grow by the chunk's frames; it is returned whether the chunk is whole.
bool render_chunk(const RenderJob& film, renderer::Renderer& renderer, const Chunk& chunk,
                  const Destination& destination, RunStatistics& statistics, const std::function<bool()>& frame_done);

}  // namespace render2mpeg::app
