#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>

#include "app/job/render_job.h"
#include "core/motion_field.h"

namespace render2mpeg::bench {

/// Exact motion of a film between any two of its pictures, kept in a folder once it was asked for: 3.7 MB a field at
/// 1280x720. Kept to 1/64 pixel across and 1/32 down; what leads further than 512 pixels across or 256 down, where no
/// vector of MPEG-2 can go, becomes class `none`.
class ExactMotion {
  public:
    ExactMotion(app::RenderJob film, std::filesystem::path folder);
    ~ExactMotion();

    /// Lives until another picture is asked for.
    const core::MotionField& between(std::int64_t picture, std::int64_t reference);

  private:
    core::MotionField look(std::int64_t picture, std::int64_t reference);

    app::RenderJob film_;
    std::filesystem::path folder_;
    std::unique_ptr<renderer::Renderer> renderer_;  ///< none until a field is not there
    std::int64_t picture_ = -1, seen_ = -1;
    core::Visible visible_;                             ///< of picture seen_
    std::map<std::int64_t, core::MotionField> fields_;  ///< of picture_, by reference
};

}  // namespace render2mpeg::bench
