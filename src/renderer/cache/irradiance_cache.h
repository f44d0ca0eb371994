#pragma once
// The irradiance cache over a film's frames.
#include <array>

#include "renderer/cache/cache_counts.h"
#include "renderer/cache/frame_state.h"
#include "renderer/cache/record_library.h"
#include "renderer/cache/temporal_reuse.h"
#include "renderer/cut/lighting_context.h"
#include "renderer/cut/shade.h"

namespace render2mpeg::renderer {

/// Gathers light once, at places on surfaces, and keeps it there for as long as it stays what it is: irradiance
/// caching with records at gather points and local regression among them (docs/model/irradiance-cache.md). A function
/// of what it was shown since `forget`, for any number of threads.
class IrradianceCache {
  public:
    /// A chunk begins.
    void forget();

    /// Light is another than at the frame before, or things lie elsewhere.
    void light_changes();

    /// Light of all points of a frame within their tolerances (not for the reference), gathered or from records.
    FrameLight light(const LightingContext& context, const scene::Snapshot& snapshot, const CutLimits& limits,
                     FinalGather* rays, ShadeCounts& shade_counts, CacheCounts& counts);

    /// How many records lie in each pixel of a picture, seen or hidden.
    core::Plane<float> density(const scene::Camera& camera, const scene::PictureFormat& format) const;

    /// Records of earlier runs under the same light, and those for later ones. Of light that never changes.
    RecordLibrary& library() { return library_; }
    /// Records of the chunk so far that earlier runs did not know.
    std::vector<StoredRecord> found() const;

    /// Whether all records lie on surfaces that there are, and were lit by representatives that there are.
    bool is_sound(const scene::Animation& scene) const;

    /// All that it knows of the chunk, between instants.
    template <class A>
    friend void archive(A& a, IrradianceCache& c) {
        auto& [records, library, left, near_field, histories, is_other_light, other_eye] = c;
        a(records, library, left, near_field, histories, is_other_light);
    }

  private:
    /// Another shot: forgets the last frame, and records of surfaces that are so far now that they crowd its pixels.
    void cut_to(const Frame& seen, const scene::Snapshot& snapshot);
    void forget_records();
    /// Takes records of earlier runs that lie where points of the frame do. Their number.
    std::uint64_t take_known(const Frame& seen, std::int64_t frame);

    RecordStore records_;
    RecordLibrary library_;
    std::vector<StoredRecord> left_;         ///< found by records that are no more
    std::uint32_t near_field_ = 0;           ///< NearField::key of the last frame
    std::array<FrameHistory, 2> histories_;  ///< of the left or single eye, and of the right one
    bool is_other_light_ = false;
    OtherEye other_eye_;  ///< the left one, until the right one is lit
};

}  // namespace render2mpeg::renderer
