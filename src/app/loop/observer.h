#pragma once

#include <vector>

#include "app/loop/motion.h"
#include "app/options/film.h"
#include "core/mattes.h"
#include "core/picture.h"
#include "core/radiance.h"
#include "core/tolerance_map.h"
#include "encoder/types.h"
#include "renderer/renderer.h"
#include "scene/pose/snapshot.h"

namespace render2mpeg::app {

struct LitFrame {
    const scene::Snapshot& world;
    const renderer::Lit& lit;             ///< of both eyes: what the picture shows, `visible` and `radiance`, alone
    const core::ToleranceMap& tolerance;  ///< that it was lit by
    const core::Radiance& shown;          ///< its light as an eye gets it (glare_filter.h)
    const core::Picture& picture;
    RenderedMotion& motion;              ///< from it to others
    const renderer::Statistics& before;  ///< the renderer's counts before it was shaded
    const renderer::Statistics& after;   ///< and after it
    const core::Mattes& mattes;          ///< empty: the renderer did not look for them
};

/// Observes a chunk in the making. Frames come in order, pictures in coding order.
class LoopObserver {
  public:
    virtual ~LoopObserver() = default;
    virtual void lit(const LitFrame&) {}
    /// A frame that an earlier run of the chunk lit: world, picture and motion alone.
    virtual void lit_before(const LitFrame&) {}
    /// A frame from a file in place of a lit one. `motion` leads to the frame before; null: not known.
    virtual void read(const core::Picture& picture, const core::MotionField* motion) {
        static_cast<void>(picture), static_cast<void>(motion);
    }
    virtual void coded(const encoder::CodedPicture&) {}
    void all(const std::vector<encoder::CodedPicture>& pictures) {
        for (const encoder::CodedPicture& picture : pictures) coded(picture);
    }
    virtual void begins(const Chunk&) {}
    virtual void ends(const Chunk&) {}
};

/// Several observers in order of addition. They must outlive it.
class LoopObservers : public LoopObserver {
  public:
    void add(LoopObserver& observer) { all_.push_back(&observer); }
    void lit(const LitFrame& frame) override { tell(&LoopObserver::lit, frame); }
    void lit_before(const LitFrame& frame) override { tell(&LoopObserver::lit_before, frame); }
    void read(const core::Picture& picture, const core::MotionField* motion) override {
        tell(&LoopObserver::read, picture, motion);
    }
    void coded(const encoder::CodedPicture& picture) override { tell(&LoopObserver::coded, picture); }
    void begins(const Chunk& chunk) override { tell(&LoopObserver::begins, chunk); }
    void ends(const Chunk& chunk) override { tell(&LoopObserver::ends, chunk); }

  private:
    template <class Event, class... Facts>
    void tell(Event event, const Facts&... facts) {
        for (LoopObserver* observer : all_) (observer->*event)(facts...);
    }

    std::vector<LoopObserver*> all_;
};

}  // namespace render2mpeg::app
