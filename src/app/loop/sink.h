#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "app/loop/render_job.h"
#include "app/loop/run_statistics.h"
#include "core/picture.h"
#include "core/radiance.h"

namespace render2mpeg::app {

/// Where finished frames go when no film is coded: a Y4M file or numbered images. Nothing appears under its final name
/// before it is whole.
class Sink {
  public:
    virtual ~Sink() = default;
    /// Frames come in order.
    virtual void write(const core::Radiance& radiance, const core::Picture& picture) = 0;
    /// After the last frame.
    virtual void finish() {}
};

/// The sink for an output that is not a film.
std::unique_ptr<Sink> make_sink(const RenderJob& film, const std::filesystem::path& output);

/// Joins Y4M files that a sink wrote one after the other.
void join_y4m(const RenderJob& film, const std::vector<std::filesystem::path>& parts,
              const std::filesystem::path& file);

}  // namespace render2mpeg::app
