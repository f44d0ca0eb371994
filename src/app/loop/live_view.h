#pragma once
// A view of a film that is drawn while somebody looks on: soon first, then better and better.
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <optional>

#include "app/job/render_job.h"
#include "app/options/options.h"
#include "core/plane.h"
#include "renderer/renderer.h"
#include "scene/pose/snapshot.h"
#include "scene/pose/viewpoint.h"

namespace render2mpeg::app {

/// What is to be seen.
struct LiveWish {
    Size size;                             ///< pixels
    std::int64_t frame = 0;                ///< of the film; its nearest one counts
    std::optional<scene::Viewpoint> from;  ///< none: the film's own camera
};

enum class LiveLevel {
    quick,  ///< a draft, smaller where it would take too long
    draft,  ///< in full size; the more of them, the better
    lit     ///< by rays, within a tolerance
};

struct LivePicture {
    core::Plane<glm::vec3> radiance;  ///< as core::Radiance::combined
    LiveLevel level = LiveLevel::quick;
    int pass = 1;  ///< of its level, from 1
};

/// Draws one film as it is wished to be seen. Keeps scene, light and what drafts carry along.
class LiveView {
  public:
    /// `film`: settled for images; its exposure does not matter. Throws core::Error for images that cannot be read.
    explicit LiveView(RenderJob film);

    const RenderJob& film() const { return film_; }
    /// Begins with another wish.
    void show(const LiveWish& wish);
    /// Whether there is a better picture than the last one.
    bool can_improve() const { return step_ < last_step; }
    /// The next picture, better than the one before. None where `stops` ended it, after which the same one is next; the
    /// first one of a wish is never ended, since somebody waits for it.
    std::optional<LivePicture> next(const std::function<bool()>& stops);

  private:
    /// Drafts in full size. chosen: 8 of 4 to 32, of which later ones differ less than one sees.
    static constexpr int drafts = 8;
    static constexpr int last_step = 1 + drafts + 1;

    std::shared_ptr<const scene::Snapshot> posed(Size size);
    Size quick_size() const;
    core::Plane<glm::vec3> draft(Size size);
    core::Plane<glm::vec3> lit();
    void forget_stopped();

    RenderJob film_, draft_film_;
    renderer::Renderer draft_;
    std::optional<renderer::Renderer> fine_;  ///< once it was needed
    bool fine_is_sound_ = false;              ///< nothing was stopped in it
    LiveWish wish_;
    int step_ = last_step;      ///< 0: the quick picture is next
    std::int64_t number_ = 0;   ///< of snapshots, each its own, as random numbers are to be
    double pixel_seconds_ = 0;  ///< of the last draft, on the clock; 0: not known
    /// Those that the renderers hold, and that the light they carry along is of; null: none.
    std::shared_ptr<const scene::Snapshot> drafted_, posed_, fine_posed_;
};

}  // namespace render2mpeg::app
