#pragma once

#include "renderer/record_fit.h"

namespace render2mpeg::renderer {

/// The record in the point's own pixel that lies nearest to it, of those that the pixel's samples would share a gather
/// point with and up to which light changes by no more than some tolerances. Where there is one, the light at its place
/// is the point's (docs/model.md, "Records"); notes its use.
void take_own(const RecordQuery& query, const RecordMap& map, Records& records, const RecordTrust& trust,
              std::int64_t frame, RecordEstimate& result);

}  // namespace render2mpeg::renderer
