#pragma once
// Rough light for every pixel of every frame: a lattice of points, and what earlier frames found.
#include <cstdint>
#include <vector>

#include "core/motion_field.h"
#include "core/plane.h"
#include "core/visible.h"
#include "renderer/cache/request_groups.h"
#include "renderer/cut/cut.h"
#include "renderer/cut/lighting_context.h"
#include "renderer/cut/point_light.h"
#include "renderer/cut/shade.h"
#include "renderer/draft/upsample.h"

namespace render2mpeg::renderer {

/// One frame to be lit roughly.
struct DraftFrame : LightingContext {
    LightTrees& parted;  ///< the same light trees: some of their lights are taken out while others are gathered
    const core::MotionField* motion = nullptr;  ///< to the frame lit last; null: nothing of it is kept
};

/// A tile while it is lit.
struct DraftTile {
    std::vector<PointLight> light;
    std::vector<PointRef> alone;  ///< points that no lit point about them is like
    ShadeCounts counts;
};

/// Draft light [Herzog2010, chapter 8]: in each frame one pixel in 4x4 is lit, of every second window where a frame
/// goes before, another one in the next; between them light is interpolated along surfaces, and averaged with what
/// earlier frames found, carried along by exact motion, the less the more the light changes. The strongest lights
/// without size, and small suns, are gathered for every pixel: their shadows are sharp. Depends on the frames since
/// forget() alone, not on the number of threads.
class DraftLight {
  public:
    void forget();

    /// The light of all gather points of the next frame. Adds what it took to `counts`.
    FrameLight light(const DraftFrame& frame, const CutLimits& limits, ShadeCounts& counts);

  private:
    /// Known light of a pixel's main surface.
    struct Kept {
        SmoothLight light;
        float weight = 0;  ///< lit points that it stands for; 0: nothing is known
    };

    /// Light of a pixel as known from the frame before [Herzog2010, eq. 8.4].
    Kept carried(const DraftFrame& frame, int x, int y) const;
    /// By how much light has changed at a window's lit pixel, as a share of it, -1..1.
    float change_at(const DraftFrame& frame, const Lattice& lattice, glm::ivec2 window,
                    const core::Plane<Kept>& before) const;
    /// How far what was known is to be trusted, 0..1, by windows [Herzog2010, eq. 8.8].
    core::Plane<float> trust(const DraftFrame& frame, const Lattice& lattice, const core::Plane<Kept>& before) const;
    /// Lights a tile's points by lit points and by what was known [Herzog2010, eq. 8.7].
    void interpolate(const DraftFrame& frame, const Lattices& lattices, const core::Plane<Kept>& before,
                     const core::Plane<float>& trust, std::size_t t, DraftTile& tile, core::Plane<Kept>& kept) const;

    std::int64_t count_ = 0;  ///< frames since forget()
    core::Visible visible_;   ///< of the frame lit last
    core::Plane<Kept> kept_;
};

}  // namespace render2mpeg::renderer
