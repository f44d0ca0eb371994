#pragma once
// The irradiance cache over a film's frames.
#include "renderer/cache/light_parts.h"
#include "renderer/cache/lobe_trials.h"
#include "renderer/cache/record_fit.h"
#include "renderer/cache/record_watch.h"
#include "renderer/cut/shade.h"

namespace render2mpeg::renderer {

/// What the records did for a frame.
struct RecordCounts {
    std::uint64_t served = 0;   ///< gather points whose light came from records, or from the very same point before
    std::uint64_t moved = 0;    ///< of these, at the place of a record elsewhere in their pixel
    std::uint64_t between = 0;  ///< likewise, by what other points around were served
    std::uint64_t created = 0;  ///< records
    std::uint64_t live = 0;     ///< records held after the frame
    std::uint64_t watched = 0;  ///< points that records served and that were gathered all the same
    std::uint64_t missed = 0;   ///< of these, those that records were off by more than they may
};

/// Gathers light once, at places on surfaces, and keeps it there for as long as it stays what it is
/// (docs/model/irradiance-cache.md). A function of what it was shown since `forget`, for any number of threads.
class RecordCache {
  public:
    /// A chunk begins.
    void forget() {
        records_.forget();
        trials_.forget();
        watch_.forget();
        last_ = {};
        last_moved_points_ = {};
        moved_ = false;
    }

    /// Which points were lit elsewhere in their pixels: none but in the last frame, nor by the reference, which asks no
    /// records.
    MovedPoints moved_points(std::int64_t frame, const core::ToleranceMap& tolerance) const {
        return frame != last_frame_ || tolerance.is_reference() ? MovedPoints{} : last_moved_points_;
    }

    /// How many records lie in each pixel of a picture, seen or hidden.
    core::Plane<float> density(const scene::Camera& camera, const scene::PictureFormat& format) const {
        RecordMap map(format.width, format.height);
        map.build(records_.all(), camera);
        return map.density();
    }

    /// Light is another than at the frame before: nothing that is known holds.
    void change() {
        records_.forget();
        last_ = {};
    }

    /// Things lie elsewhere than in the frame before, where light is parted (light_parts.h): whether the part that
    /// records hold is another now, too.
    void move(bool still_changed) {
        moved_ = true;
        if (still_changed) change();
    }

    /// Light of all points of a frame within their tolerances (not for the reference), gathered or from records; these
    /// hold what stays of it where it is given in parts, in all frames of a chunk or in none.
    FrameLight light(const LightTrees& light_trees, const RayTracer& tracer, const Seen& seen,
                     const scene::Snapshot& snapshot, const core::ToleranceMap& tolerance, const CutLimits& limits,
                     ShadeCounts& shade_counts, RecordCounts& counts, const LightParts* parts = nullptr);

    /// Bytes held between frames.
    std::size_t bytes() const {
        std::size_t sum = records_.bytes() + trials_.bytes() + watch_.bytes();
        for (const auto& tile : last_) sum += tile.capacity() * sizeof(LitPoint);
        for (const auto& tile : last_moved_points_) sum += tile.capacity() * sizeof(MovedPoint);
        return sum;
    }

    /// What a frame's point was lit with; kept for a frame that shows the very same.
    struct LitPoint {
        core::SurfaceAddress address;
        glm::vec3 outgoing{0}, weight{0};
        PointTolerance tolerance;  ///< that it was within
        PointLight exact, trees;
    };
    using LitTiles = std::vector<std::vector<LitPoint>>;

  private:
    /// Another shot: forgets the last frame, and records of surfaces that are so far now that they crowd its pixels.
    void cut_to(const Seen& seen, const scene::Snapshot& snapshot);

    Records records_;
    LitTiles last_;
    MovedPoints last_moved_points_;
    std::int64_t last_frame_ = 0;  ///< that they are of
    float last_error_scale_ = 1;   ///< that they were lit with
    bool moved_ = false;           ///< things lie elsewhere than in the last frame; light is parted
    RecordTrust trust_;
    LobeTrials trials_;
    RecordWatch watch_;
};

}  // namespace render2mpeg::renderer
