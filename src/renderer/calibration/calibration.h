#pragma once
// Calibrates the cut's error for a film, on pixels gathered without clustering.
#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>

#include "core/plane.h"
#include "core/radiance.h"
#include "core/tolerance_map.h"
#include "renderer/calibration/error_calibration.h"
#include "renderer/cut/shade.h"
#include "scene/pose/snapshot.h"

namespace render2mpeg::renderer {

// How a film's own light decides the error scale of its cuts (docs/model/lightcut.md). All of it is a function of what
// a chunk shows and of its tolerances, for any number of threads.

/// Geometric mean of the tolerances of pixels that gather light, as shares of their luminance, < 1, as told before they
/// are lit; without pixels that may be off by all of it. 0: there are none.
float typical_share(const Frame& seen, const core::ToleranceMap& tolerance);

/// Calibrates before a frame is lit. Where nothing is known (a first frame, or one after a cut): lights some hundreds
/// of its pixels, with those they are gathered together with, and compares them with light by all light points; then
/// once more with the error scale that this asks for. Where something is known already (a frame with other tolerances):
/// only the second round, whose pixels are added. Small frames, whose sample would cost too much of them, leave it as
/// it is. Returns how many pixels were gathered again.
std::size_t calibrate(ErrorCalibration& calibration, const LightingContext& context, CutLimits limits);

/// Goes on with some pixels of a frame that was lit with this error scale and traced `rays` for it: as many as cost
/// about a fiftieth of it; none where nothing was learnt to begin with, so that no film changes its error scale in its
/// midst. Pixels that records served tell nothing. Returns how many.
std::size_t recalibrate(ErrorCalibration& calibration, const LightingContext& context, float error_scale,
                        const FrameLight& light, const core::Radiance& radiance, std::uint64_t rays);

/// All that decides which pixels a frame shows, how they are lit and how well. `lit_frame` stands for its light.
struct FrameKey {
    glm::mat4 camera{1.0f};
    float fov = 0, magnification = 0;
    std::int64_t lit_frame = 0;
    core::Plane<core::Tolerance> tolerance;

    bool operator==(const FrameKey&) const = default;
};

template <class A>
void archive(A& a, FrameKey& key) {
    auto& [camera, fov, magnification, lit_frame, tolerance] = key;
    a(camera, fov, magnification, lit_frame, tolerance);
}

/// The calibration of a chunk.
class FilmCalibration {
  public:
    void forget() { *this = {}; }
    /// ErrorCalibration::value.
    float value() const { return calibration_.value(); }

    /// Before a frame after a cut, or whose tolerance is much larger than any so far. Returns how many pixels were
    /// gathered again.
    std::size_t before(const scene::Snapshot& snapshot, std::int64_t lit_frame, const LightingContext& context,
                       const CutLimits& limits);
    /// Goes on with a frame that was lit: `recalibrate`. One that repeats the frame before teaches nothing, so that
    /// still films stay as they are to the last bit.
    std::size_t after(const scene::Snapshot& snapshot, std::int64_t lit_frame, const LightingContext& context,
                      float error_scale, const FrameLight& light, const core::Radiance& radiance, std::uint64_t rays);

    template <class A>
    friend void archive(A& a, FilmCalibration& c) {
        auto& [calibration, last, share] = c;
        a(calibration, last, share);
    }

  private:
    ErrorCalibration calibration_;
    std::array<std::optional<FrameKey>, 2> last_;  ///< frames of either eye that taught
    float share_ = 0;                              ///< typical_share of the coarsest
};

}  // namespace render2mpeg::renderer
