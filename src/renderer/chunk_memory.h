#pragma once
// What frames of a chunk learn from those before them. Lights, and light within air, follow from instants alone.
#include <array>

#include "renderer/cache/irradiance_cache.h"
#include "renderer/calibration/calibration.h"
#include "renderer/caustics/caustics.h"
#include "renderer/draft/draft_light.h"

namespace render2mpeg::renderer {

struct ChunkMemory {
    IrradianceCache records{};
    FilmCalibration calibration{};
    Caustics caustics{};
    std::array<DraftLight, 2> drafts{};  ///< of either eye
};

/// A chunk begins.
inline void forget(ChunkMemory& memory) {
    auto& [records, calibration, caustics, drafts] = memory;
    records.forget();
    calibration.forget();
    caustics.forget();
    drafts = {};
}

/// For a chunk that goes on; drafts begin anew.
template <class A>
void archive(A& a, ChunkMemory& memory) {
    auto& [records, calibration, caustics, drafts] = memory;
    a(records, calibration, caustics);
}

}  // namespace render2mpeg::renderer
