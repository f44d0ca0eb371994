#pragma once
// The renderer's façade: look, light, audit.
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/archive.h"
#include "core/motion_field.h"
#include "core/radiance.h"
#include "core/tolerance_map.h"
#include "renderer/base/plan.h"
#include "renderer/calibration/audited_pixel.h"
#include "renderer/geometry/ray_tracer.h"
#include "renderer/settings.h"
#include "renderer/statistics.h"
#include "renderer/surface/frame.h"
#include "renderer/surface/ungathered_light.h"
#include "renderer/truth/error_split.h"
#include "scene/pose/snapshot.h"

namespace render2mpeg::renderer {

class TextureStore;

/// How light is gathered.
enum class LightingMode {
    film,    ///< within the tolerance, with light cached in the chunk so far
    rough,   ///< apart from the film: teaches nothing, counts as time and as an update of light alone
    sparse,  ///< likewise, in one pixel of 4x4, and interpolated between them (rough_light.h)
    draft,   ///< a lattice of points within the tolerance, and light of the frame before (draft_light.h)
    truth,   ///< by paths alone (true_frame.h); of a blurred frame, the middle
    ahead,   ///< roughly, a frame that is lit next: records of its rays stay; `sparse` where there are none
};

/// How the light of a frame is found.
struct LightOrder {
    const core::ToleranceMap& tolerance;  ///< must outlive the order
    LightingMode mode = LightingMode::film;
    std::optional<ExposureSamples> exposure{};     ///< of an open shutter or a lens; none: all is sharp
    const core::MotionField* to_before = nullptr;  ///< drafts: to the frame before; null: none is carried along
    TruthSettings truth{};

    bool is_rough() const {
        return mode == LightingMode::ahead || mode == LightingMode::rough || mode == LightingMode::sparse;
    }
};

/// A frame with the light that needs no gathering.
struct PlacedFrame {
    Frame frame;
    UngatheredLight ungathered;
};

/// A frame with all its light.
struct Lit : PlacedFrame {
    core::Radiance radiance;
    core::Radiance middle{};  ///< of exposed frames: the sharp middle, whose pixels are the sum of their own points
};

/// Looks at frames and lights them. State that lives over frames is a function of the animation, the settings and the
/// chunk's first frame.
class Renderer {
  public:
    /// Light that `found_light` returned in earlier runs of the same film under the same light, which never changes.
    using KnownLight = std::span<const std::byte>;
    /// Whether it may be that: files can be damaged, or made by others.
    static bool is_sound(KnownLight light);

    /// Takes textures from `store` (none: one of its own) and builds static data. Throws core::Error for images that
    /// cannot be read. `known`: none if `found_light` is not to be asked.
    Renderer(const scene::Animation& animation, const Settings& settings, const Plan& plan,
             TextureStore* store = nullptr, std::optional<KnownLight> known = {});
    ~Renderer();
    Renderer(Renderer&&) noexcept;

    /// Another one of the same film, for a chunk that is lit beside one of this: they share what never moves, and what
    /// is the same in all chunks, which is found now where it was not. `instant` of the film gets posed here. Not while
    /// this one lights a frame.
    std::unique_ptr<Renderer> beside(const scene::Snapshot& instant);

    /// Forgets everything that was carried over from earlier frames.
    void start_chunk(const scene::Snapshot& first);

    /// Poses it and finds its lights, as lighting does where that was not done. Where loops may be stopped later, what
    /// was prepared is whole.
    void prepare(const scene::Snapshot& snapshot);

    /// Frames have this format from now on. Forgets the light that drafts carry along.
    void resize(const scene::PictureFormat& format);

    /// Light that the chunk found so far beyond what was known.
    std::vector<std::byte> found_light() const;

    /// Primary visibility with antialiasing; no light. May run ahead by some frames of a chunk that was started.
    Frame look(const scene::Snapshot& snapshot);

    /// What the middles of pixels show, `visible` and `imaged` alone: the same as look() finds, for a part of its time.
    Frame look_at_middles(const scene::Snapshot& snapshot);

    /// All that the chunk's light so far decides of later frames, between two of them. `restore`: in a chunk that was
    /// started, for whose frames so far `prepare` was called in order. Throws core::Error.
    void save(core::ArchiveWriter& archive);
    void restore(core::ArchiveReader& archive);

    /// All light of a frame of this instant: gathers light of the placed frame.
    Lit light(const scene::Snapshot& snapshot, Frame frame, const LightOrder& order);

    /// The frame with finer edges where they could show (refine_edges.h), its exposure (expose.h), and caustics, hair
    /// and air as well lit as the tolerance asks for. Rough orders: effects alone, and roughly.
    PlacedFrame place(const scene::Snapshot& snapshot, Frame frame, const LightOrder& order);

    /// Gathers light for all gather points of a frame until every pixel's error bound is below its tolerance.
    Lit gather(const scene::Snapshot& snapshot, PlacedFrame placed, const LightOrder& order);

    /// Gathers `count` pixels of a lit frame again, from every light point, where they were lit: how well its
    /// tolerances were kept (audit.h). Counts nowhere in the statistics.
    std::vector<AuditedPixel> audit(const scene::Snapshot& snapshot, const Lit& lit,
                                    const core::ToleranceMap& tolerance, int count);

    /// The same of pixels at these places, as far as they gather anything.
    std::vector<AuditedPixel> audit(const scene::Snapshot& snapshot, const Lit& lit,
                                    const core::ToleranceMap& tolerance, std::span<const glm::ivec2> places);

    /// Holds audited pixels of a lit frame against the truth, by paths (pixel_truth.h). Counts nowhere in the
    /// statistics. `finely`: how well the truth is found.
    std::vector<ValidatedPixel> validate(const scene::Snapshot& snapshot, const Lit& lit,
                                         const core::ToleranceMap& tolerance, std::span<const AuditedPixel> audited,
                                         const TruthSettings& finely = {});

    const Statistics& statistics() const;
    /// Begins the statistics and `seconds` anew.
    void count_anew();
    /// The scene as posed for the last frame, for measurements.
    const RayTracer& tracer() const;
    /// CPU seconds by pass since construction, or count_anew().
    double seconds(Pass pass) const;

  private:
    struct Impl;
    explicit Renderer(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

}  // namespace render2mpeg::renderer
